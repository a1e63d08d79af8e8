"""Every scene under both skies at the same haze, morning, noon and dusk, on one sheet.

    python -m vrut_lite_lab.pictures.scenes SHEET.jpg [FOLDER]

Prague's sun at sea level, 21 June, the default air and ground of albedo 0.1 for both. Each picture
is what `vrut-lite render SCENE --at HOUR --place 50.0755,14.4378,0 --sky MODULE --albedo 0.1 --size
480x300` writes; with a FOLDER they are kept there at that size. Printed are two Markdown tables:
the light on level ground, and each picture's exposure.
"""

import sys
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.project import Project
from vrut_lite.studio.sky_pictures import SkyPlan
from vrut_lite_lab.pictures.drawing import SKIES, scene_project, sheet, shots

DRAWN = (
    "sundial.toml",
    "street.toml",
    "spheres.glb",
    "pavilion.gltf",
    "work/room.glb",
    "work/indoor.glb",
    "work/ground.glb",
    "work/planet.glb",
)
HOURS = ("07:00", "12:30", "21:10")
# At sea level, where both skies have the same optical depth.
_DAY, _PLACE = "2026-06-21", "50.0755,14.4378,0"
_ALBEDO = 0.1
_SIZE, _THUMBNAIL = (480, 300), (320, 200)
# Rows of the sky that the table's light is summed over.
_SKY_HEIGHT = 256


class CaptionedPicture(NamedTuple):
    """A picture (300, 480, 3) of 8 bits, its exposure, and what is written above it."""

    name: str
    caption: str
    ev100: float
    display: NDArray[np.uint8]


class GroundIlluminance(NamedTuple):
    """Illuminance of level, open ground, and of what faces the sun by the sun alone, in lux.

    The sun's elevation is apparent.
    """

    sun_elevation_deg: float
    sky_lx: float
    sun_lx: float
    facing_sun_lx: float


def project_of(scene: str, sky: str) -> Project:
    """The scene under a sky, at the first hour."""
    project = scene_project(scene)
    return Project(
        scene=project.scene,
        camera=project.camera,
        place=_PLACE,
        at=f"{_DAY}T{HOURS[0]}",
        slots={"sky": sky},
        settings={sky: {"albedo": _ALBEDO}},
        size=_SIZE,
    )


def draw(scene: str, sky: str) -> Iterator[CaptionedPicture]:
    """The scene's pictures at all hours."""
    shot_of_hour = shots(project_of(scene, sky), [f"{_DAY}T{hour}" for hour in HOURS])
    for hour, shot in zip(HOURS, shot_of_hour, strict=True):
        sun, name = shot.metadata["sunElevationDeg"], Path(scene).stem
        ev100 = shot.picture.ev100
        caption = f"{name} {hour}, sun {sun:.1f}°, {SKIES[sky]}, EV {ev100:.1f}"
        file_name = f"{name}_{hour.replace(':', '')}_{sky}"
        yield CaptionedPicture(file_name, caption, ev100, shot.picture.display)


def ground_light(sky: str, hour: str) -> GroundIlluminance:
    """What a sky and its sun give level ground, as `vrut-lite sky --sidecar` tells it."""
    project = project_of(DRAWN[0], sky)
    studio = SkyPlan(project, size=_SKY_HEIGHT).open()
    try:
        told = studio.shoot(_instant(hour)).metadata
    finally:
        studio.close()
    of_sky = _vector(told["skyHorizontalIrradianceRgb"])
    up = _vector(told["sunDirection"])[1]
    facing_lx = float(luminance(_vector(told["sunIrradianceRgb"]))) * LUMENS_PER_WATT
    return GroundIlluminance(
        float(np.degrees(np.arcsin(up))),
        float(luminance(of_sky)) * LUMENS_PER_WATT,
        facing_lx * max(up, 0.0),
        facing_lx,
    )


def _vector(text: str | float) -> NDArray[np.float64]:
    return np.array([float(part) for part in str(text).split()])


def _instant(hour: str) -> datetime:
    return Project(place=_PLACE, at=f"{_DAY}T{hour}").instant()


def light_table() -> list[str]:
    """Lines of a Markdown table: lux on level ground, Hosek-Wilkie's and Bruneton's."""
    names = " / ".join(SKIES.values())
    head = (
        f"| hour | sun | sky, lx: {names} | sun, lx | both, lx | ratio | what faces the sun, lx |"
    )
    lines = [head, "|---" * 7 + "|"]
    for hour in HOURS:
        lights = [ground_light(sky, hour) for sky in SKIES]
        both = [light.sky_lx + light.sun_lx for light in lights]
        cells = [
            hour,
            f"{lights[0].sun_elevation_deg:.1f}°",
            _beside([light.sky_lx for light in lights]),
            _beside([light.sun_lx for light in lights]),
            _beside(both),
            f"{both[1] / both[0]:.2f}",
            _beside([light.facing_sun_lx for light in lights]),
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _beside(lux: list[float]) -> str:
    return " / ".join(f"{one:,.0f}" if one >= 10.0 else f"{one:.1g}" for one in lux)


def exposure_table(rows: list[list[CaptionedPicture]]) -> list[str]:
    """Lines of a Markdown table: EV100 of each scene and hour, Hosek-Wilkie's and Bruneton's."""
    lines = ["| scene | " + " | ".join(HOURS) + " |", "|---" * (len(HOURS) + 1) + "|"]
    for scene, row in zip(DRAWN, rows, strict=True):
        pairs_of_ev = zip(row[::2], row[1::2], strict=True)
        cells = [f"{one.ev100:.1f} / {other.ev100:.1f}" for one, other in pairs_of_ev]
        lines.append(f"| {Path(scene).stem} | " + " | ".join(cells) + " |")
    return lines


def pairs(scene: str) -> list[CaptionedPicture]:
    """One row of the sheet: for each hour the one sky, then the other."""
    by_sky = [list(draw(scene, sky)) for sky in SKIES]
    return [drawn for hour in zip(*by_sky, strict=True) for drawn in hour]


def main(path: Path, folder: Path | None) -> None:
    """Draw all, and write the sheet."""
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for scene in DRAWN:
        rows.append(pairs(scene))
        if folder is not None:
            for drawn in rows[-1]:
                Image.fromarray(drawn.display).save(folder / f"{drawn.name}.png")
    captioned = [(drawn.caption, drawn.display) for row in rows for drawn in row]
    sheet(captioned, len(rows[0]), _THUMBNAIL).save(path, quality=80)
    print("\n".join([*light_table(), "", *exposure_table(rows)]))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]) if len(sys.argv) > 2 else None)
