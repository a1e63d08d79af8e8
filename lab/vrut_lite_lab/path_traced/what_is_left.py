"""What is left between frame and truth: terms switched off one after another.

    python -m vrut_lite_lab.path_traced.what_is_left [--sky NAME] [--hour HH:MM ...] [SCENE ...]

Each column is HDR-FLIP above the floor: as it is; with 16 of the frame's pixels in one, which ends
what antialiasing and filtered maps leave; with a fine light map too; without coats in frame and
truth too; and against a sharp sun's truth too. Truths are traced where they are not on disk,
fifteen seconds of CPU each; a scene takes two minutes of it besides.
"""

import argparse
from collections.abc import Mapping, Sequence
from typing import Any
from unittest.mock import patch

import msgspec
import numpy as np

from vrut_lite.render.passes import mesh_renderer
from vrut_lite_lab.path_traced.cases import HOURS as ALL_HOURS
from vrut_lite_lab.path_traced.cases import SIZE, Case, states
from vrut_lite_lab.path_traced.denoising import GUIDES_NAME, denoised
from vrut_lite_lab.path_traced.regions import flip
from vrut_lite_lab.path_traced.table import truth_of
from vrut_lite_lab.path_traced.truths import Picture, Recipe, known, truth
from vrut_lite_lab.pictures.drawing import SKIES, shots

SCENES = ("street.toml", "work/indoor.glb")
HOURS = ("07:00", "12:30")
HEADER = [
    "| scene, hour, sky | floor | as it is | 16 pixels in one | fine map | no coats | sharp sun |",
    "|---" * 7 + "|",
]
_FINE: Mapping[str, Any] = {"light_transport": {"quality": "fine"}}
_ACROSS = 4
_BARE, _SHARP = Recipe(surfaces="bare"), Recipe(surfaces="bare", sun="sharp")


def frames(case: Case, hours: Sequence[str], settings: Mapping[str, Any]) -> list[Picture]:
    """The frame (h, w, 3) at these hours, each pixel the mean of _ACROSS by _ACROSS."""
    project = msgspec.structs.replace(
        case.project,
        size=(SIZE[0] * _ACROSS, SIZE[1] * _ACROSS),
        settings={**case.project.settings, **settings},
    )
    found = []
    for shot in shots(project, [f"2026-06-21T{hour}" for hour in hours]):
        fine = shot.picture.radiance[..., :3].astype(np.float64)
        pieces = fine.reshape(SIZE[1], _ACROSS, SIZE[0], _ACROSS, 3)
        found.append(pieces.mean(axis=(1, 3)).astype(np.float32))
    return found


def rows(scene: str, sky: str, hours: tuple[str, ...]) -> list[str]:
    """A line of the table for each hour whose truth is on disk."""
    first = Case(scene, sky, hours[0])
    plain = [
        shot.picture.radiance[..., :3]
        for shot in shots(first.project, [f"2026-06-21T{hour}" for hour in hours])
    ]
    ways = [plain, frames(first, hours, {}), frames(first, hours, _FINE)]
    with patch.object(mesh_renderer, "DIELECTRIC_F0", 0.0):
        bare = frames(first, hours, _FINE)
    lines = []
    for number, (case, state) in enumerate(states(scene, sky, hours)):
        found, guide = truth_of(case), known(case, GUIDES_NAME)
        if found is None or guide is None:
            continue
        above = [flip(way[number], found.clean) - found.floor for way in ways]
        for recipe in (_BARE, _SHARP):
            other = denoised(truth(case, state, recipe, case.samples), guide)
            above.append(flip(bare[number], other) - found.floor)
        cells = [f"{found.floor:.3f}", *(f"{value:+.3f}" for value in above)]
        lines.append(f"| {case.caption} | " + " | ".join(cells) + " |")
    return lines


def tell(scenes: Sequence[str], sky: str, hours: tuple[str, ...]) -> None:
    """Print the table."""
    print("\n".join(HEADER), flush=True)
    for scene in scenes:
        for line in rows(scene, sky, hours):
            print(line, flush=True)


def main() -> None:
    """Draw, trace and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--sky", choices=list(SKIES), default="dynamic_skylight")
    parser.add_argument("--hour", choices=ALL_HOURS, action="append")
    chosen = parser.parse_args()
    tell(chosen.scenes, chosen.sky, tuple(chosen.hour or HOURS))


if __name__ == "__main__":
    main()
