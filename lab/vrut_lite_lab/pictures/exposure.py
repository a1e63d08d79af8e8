"""Automatic exposure as metered and as corrected, on one sheet and in a Markdown table.

    python -m vrut_lite_lab.pictures.exposure SHEET.webp

All bundled scenes, two of them on snow, and a black cat (albedo 0.03) on grey ground; 21 June in
Prague at 13:00, 17:30, 20:15 and 21:35, and a moonlit night. Of each pair on the sheet the upper is
what the meter alone chooses. In the table: means and 99th percentiles of luma (of 255), and the
share of pixels with a channel of 250 or more.
"""

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np
import trimesh
from numpy.typing import NDArray

from vrut_lite.commands.demo import scene_projects
from vrut_lite.geometry.colour import LUMINANCE_WEIGHTS
from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetClock
from vrut_lite.pictures.display import display_picture
from vrut_lite.pictures.exposure import automatic_ev100
from vrut_lite.project import CameraView, Project, daylight_inputs, setting_inputs, view_inputs
from vrut_lite_lab.pictures.drawing import SCENES, sheet

_SUMMER = "2026-06-21T"
HOURS = {
    "noon": f"{_SUMMER}13:00",
    "afternoon": f"{_SUMMER}17:30",
    "low sun": f"{_SUMMER}20:15",
    "dusk": f"{_SUMMER}21:35",
    "full moon": "2026-01-03T23:00",
}
_SHOWN_HOURS = ("noon", "afternoon")
_SIZE = (320, 200)
_CLIPPED = 250
# Centre (m) and semi-axes (m) of the cat's body, head, ears, tail and forelegs.
_CAT = (
    ((0.0, 0.16, 0.0), (0.13, 0.16, 0.2)),
    ((0.0, 0.4, 0.16), (0.1, 0.09, 0.1)),
    ((0.06, 0.5, 0.15), (0.03, 0.05, 0.02)),
    ((-0.06, 0.5, 0.15), (0.03, 0.05, 0.02)),
    ((0.2, 0.05, -0.2), (0.22, 0.03, 0.03)),
    ((0.06, 0.1, 0.17), (0.03, 0.1, 0.03)),
    ((-0.06, 0.1, 0.17), (0.03, 0.1, 0.03)),
)
_BLACK_FUR = 0.03
_CAT_VIEW = CameraView(
    eye_m=(0.25, 0.42, 0.95), target_m=(0.0, 0.26, 0.0), vertical_field_of_view_deg=38
)


class Exposed(NamedTuple):
    """A picture (h, w, 3) of 8 bits and its EV100, as metered and as corrected."""

    scene: str
    hour: str
    ev100: tuple[float, float]
    displays: tuple[NDArray[np.uint8], NDArray[np.uint8]]


def write_cat(path: Path) -> None:
    """Write the black cat as GLB."""
    parts = []
    for centre, axes in _CAT:
        part = trimesh.creation.icosphere(subdivisions=4)
        part.apply_scale(axes)
        part.apply_translation(centre)
        parts.append(part)
    cat = trimesh.util.concatenate(parts)
    assert isinstance(cat, trimesh.Trimesh)
    material = trimesh.visual.material.PBRMaterial(
        baseColorFactor=[_BLACK_FUR, _BLACK_FUR, _BLACK_FUR, 1.0],
        metallicFactor=0.0,
        roughnessFactor=1.0,
    )
    cat.visual = trimesh.visual.TextureVisuals(material=material)
    cat.export(path)


def projects(cat: Path) -> dict[str, Project]:
    """All projects by name; `cat` is the cat's file."""
    scenes = {
        f"{folder.name} {name}" if folder != SCENES else name: project
        for folder in (SCENES, SCENES / "work", SCENES / "large")
        for name, project in scene_projects(folder).items()
    }
    of_cat = Project(scene=str(cat), camera=_CAT_VIEW)
    snowy = {
        f"{name}, snow": msgspec.structs.replace(project, ground="snow")
        for name, project in (("sundial", scenes["sundial"]), ("black cat", of_cat))
    }
    return {**scenes, "black cat": of_cat, **snowy}


def exposed(name: str, project: Project) -> Iterator[Exposed]:
    """A scene's pictures at all hours."""
    sized = msgspec.structs.replace(project, size=_SIZE)
    with Host() as host:
        host.inject(*setting_inputs(sized, host.kernel))
        host.inject(*daylight_inputs(sized), *view_inputs(sized))
        for hour, time in HOURS.items():
            instant = msgspec.structs.replace(sized, at=time).instant()
            host.inject(SetClock(instant=instant))
            host.settle()
            radiance = host.draw().radiance
            metered = automatic_ev100(radiance)
            corrected = automatic_ev100(radiance, host.state.white_card)
            yield Exposed(
                name,
                hour,
                (metered, corrected),
                (_shown(radiance, metered), _shown(radiance, corrected)),
            )


def _shown(radiance: NDArray[np.float32], ev100: float) -> NDArray[np.uint8]:
    return np.asarray(display_picture(radiance, ev100), np.uint8)


def table(pictures: list[Exposed]) -> Iterator[str]:
    """Lines of a Markdown table, before / after, of pictures that the correction changes."""
    yield "| scene | hour | brighter, stops | mean | 99th percentile | clipped, % |"
    yield "|---|---|---:|---:|---:|---:|"
    for one in pictures:
        if one.ev100[0] == one.ev100[1]:
            continue
        lumas = [display @ np.asarray(LUMINANCE_WEIGHTS) for display in one.displays]
        clipped = [100.0 * np.mean((shown >= _CLIPPED).any(axis=-1)) for shown in one.displays]
        cells = (
            one.scene,
            one.hour,
            f"{one.ev100[0] - one.ev100[1]:+.1f}",
            " / ".join(f"{luma.mean():.0f}" for luma in lumas),
            " / ".join(f"{np.quantile(luma, 0.99):.0f}" for luma in lumas),
            " / ".join(f"{share:.1f}" for share in clipped),
        )
        yield f"| {' | '.join(cells)} |"


def main(path: Path) -> None:
    """Draw all, write the sheet, print the table."""
    with tempfile.TemporaryDirectory() as folder:
        cat = Path(folder) / "cat.glb"
        write_cat(cat)
        pictures = [one for item in projects(cat).items() for one in exposed(*item)]
    print("\n".join(table(pictures)))
    captioned = [
        (f"{one.scene}, {one.hour}", np.vstack(one.displays))
        for hour in _SHOWN_HOURS
        for one in pictures
        if one.hour == hour
    ]
    sheet(captioned, len(captioned) // 4 + 1, (_SIZE[0] // 2, _SIZE[1])).save(path, quality=80)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
