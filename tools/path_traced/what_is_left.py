"""What is left between frame and truth: terms switched off one after another.

    python -m tools.path_traced.what_is_left [--sky NAME] [SCENE ...]

Each column is HDR-FLIP above the floor: as it is; with 16 of the frame's pixels in one, which ends
what antialiasing and filtered maps leave; with the finest light map; with both; and without coats
or with a sharp sun, in frame and truth alike (traced where it is not on disk, ten seconds each).
"""

import argparse
from collections.abc import Mapping, Sequence
from typing import Any
from unittest.mock import patch

import msgspec
import numpy as np

from tools.path_traced.cases import HOURS, SIZE, Case, states
from tools.path_traced.denoising import GUIDES_NAME, denoised
from tools.path_traced.regions import flip
from tools.path_traced.table import truth_of
from tools.path_traced.truths import Picture, Recipe, known, truth
from tools.pictures.drawing import SKIES, shots
from vrut_lite.render.passes import mesh_renderer

SCENES = ("street.toml", "large/hall.toml", "work/indoor.glb")
HEADER = [
    "| scene, hour, sky | floor | as it is | 16 pixels in one | finest map | both | no coats "
    "| sharp sun |",
    "|---" * 8 + "|",
]
_FINE = 4
_FINEST: Mapping[str, Any] = {"light_transport": {"quality": "finest"}}
_BARE, _SHARP = Recipe(surfaces="bare"), Recipe(sun="sharp")


def frames(case: Case, times: int = 1, settings: Mapping[str, Any] | None = None) -> list[Picture]:
    """The frame (h, w, 3) at all hours, each pixel the mean of `times` by `times`."""
    project = msgspec.structs.replace(
        case.project,
        size=(SIZE[0] * times, SIZE[1] * times),
        settings={**case.project.settings, **(settings or {})},
    )
    found = []
    for shot in shots(project, [f"2026-06-21T{hour}" for hour in HOURS]):
        fine = shot.picture.radiance[..., :3].astype(np.float64)
        pieces = fine.reshape(SIZE[1], times, SIZE[0], times, 3)
        found.append(pieces.mean(axis=(1, 3)).astype(np.float32))
    return found


def rows(scene: str, sky: str) -> list[str]:
    """A line of the table for each hour whose truth is on disk."""
    first = Case(scene, sky, HOURS[0])
    ways = [frames(first), frames(first, _FINE), frames(first, 1, _FINEST)]
    ways.append(frames(first, _FINE, _FINEST))
    with patch.object(mesh_renderer, "DIELECTRIC_F0", 0.0):
        bare = frames(first)
    lines = []
    for number, (case, state) in enumerate(states(scene, sky)):
        found, guide = truth_of(case), known(case, GUIDES_NAME)
        if found is None or guide is None:
            continue
        above = [flip(way[number], found.clean) - found.floor for way in ways]
        for frame, recipe in ((bare[number], _BARE), (ways[0][number], _SHARP)):
            other = denoised(truth(case, state, recipe, case.samples), guide)
            above.append(flip(frame, other) - found.floor)
        cells = [f"{found.floor:.3f}", *(f"{value:+.3f}" for value in above)]
        lines.append(f"| {case.caption} | " + " | ".join(cells) + " |")
    return lines


def tell(scenes: Sequence[str], sky: str) -> None:
    """Print the table."""
    print("\n".join(HEADER))
    for scene in scenes:
        for line in rows(scene, sky):
            print(line, flush=True)


def main() -> None:
    """Draw, trace and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--sky", choices=list(SKIES), default="dynamic_skylight")
    chosen = parser.parse_args()
    tell(chosen.scenes, chosen.sky)


if __name__ == "__main__":
    main()
