"""The camera climbs over the terrain, from a person's eye to 3,000 km: pictures, and their steps.

    python -m vrut_lite_lab.pictures.climb FOLDER [--measure] [--sky NAME]

Writes climb.jpg, a film strip of twelve heights. With --measure it also draws pictures at heights
2 % apart and compares each with the one before: pictures are blurred, so that things may move by a
pixel, and their rim is left out; the rest is the change of light between two frames. climb.csv has
a line for each pair; climb_steps.png plots them; pairs that stand out of their neighbours are
reported as jumps.
"""

import argparse
import csv
import math
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, median_filter

from vrut_lite.host import Host
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.project import daylight_inputs, setting_inputs, view_inputs
from vrut_lite.scene.loading import load_scene
from vrut_lite_lab.pictures.drawing import scene_project, sheet

SCENE = "large/terrain.toml"
PLANET_M, EYE_M, HIGHEST_M = 6.36e6, 1.7, 3e6
STRIP, STRIP_PX = 12, (480, 270)
STEP, STEP_PX = 1.02, (320, 180)
_FIELD_OF_VIEW_RAD = math.radians(55.0)
# The horizon stands so far above the picture's middle.
_BELOW_HORIZON_RAD = math.radians(7.0)
# Blur in pixels of the small pictures: what moves by less is not taken for a change of light.
_BLUR_PX = 6.0
# So many blurs wide is the rim that is not compared: things come and go there.
_RIM_BLURS = 2.0
# A jump is so many times its neighbours' median, and more than one step of 8 bits.
_STANDS_OUT, _LEAST_JUMP, _NEIGHBOURS = 3.0, 1.0 / 255.0, 15


class ClimbStep(NamedTuple):
    """How the picture changes between two heights above the ground, in shares of white.

    `largest` and `most` (99.9th percentile) are of the change itself. `unsteady` is of what is
    left of it when the mean of the change before and the one after is taken off: steady movement
    cancels, a jump of light stays.
    """

    lower_m: float
    upper_m: float
    largest: float
    most: float
    unsteady: float
    jump: bool


def heights_m(ratio: float | None = None) -> NDArray[np.float64]:
    """Heights above the ground (n,), from the eye's to the highest, log-spaced."""
    span = math.log(HIGHEST_M / EYE_M)
    count = STRIP if ratio is None else math.ceil(span / math.log(ratio)) + 1
    return np.asarray(EYE_M * np.exp(np.linspace(0.0, span, count)))


def view_from(height_m: float, ground_m: float) -> MoveCamera:
    """Looking west, a little below the horizon, which sinks with height."""
    altitude_m = ground_m + height_m
    dip_rad = math.atan2(math.sqrt(altitude_m * (2.0 * PLANET_M + altitude_m)), PLANET_M)
    pitch_rad = dip_rad + _BELOW_HORIZON_RAD
    # A target at the distance of the eye's height keeps its digits.
    away_m = max(altitude_m, 1.0)
    target = (-away_m * math.cos(pitch_rad), altitude_m - away_m * math.sin(pitch_rad), 0.0)
    return MoveCamera(
        eye_m=(0.0, altitude_m, 0.0),
        target_m=target,
        vertical_field_of_view_rad=_FIELD_OF_VIEW_RAD,
    )


def ground_under_origin_m(path: str) -> float:
    """Height of the terrain's highest point within a stride of the origin."""
    scene = load_scene(path)
    corners = np.concatenate([place.world_triangles().reshape(-1, 3) for place in scene.meshes])
    near = np.hypot(corners[:, 0], corners[:, 2]) < 3.0
    return float(corners[near, 1].max())


def draw_climb(
    heights: NDArray[np.float64], size: tuple[int, int], sky: str
) -> list[NDArray[np.uint8]]:
    """Pictures (h, w, 3) at heights above the ground, in turn, as an application would."""
    project = scene_project(SCENE, size=size, slots={"sky": sky})
    ground_m = ground_under_origin_m(project.scene)
    with Host() as host:
        host.inject(*setting_inputs(project, host.kernel), *daylight_inputs(project))
        host.inject(*view_inputs(project))
        pictures = []
        for height_m in heights:
            host.inject(view_from(float(height_m), ground_m))
            pictures.append(np.asarray(host.draw().display))
        return pictures


def steps_between(
    heights: NDArray[np.float64], pictures: list[NDArray[np.uint8]], blur_px: float = _BLUR_PX
) -> list[ClimbStep]:
    """What changes from each picture to the next when small movement is blurred away."""
    smooth = (_blurred(picture, blur_px) for picture in pictures)
    changes = [upper - lower for lower, upper in pairwise(smooth)]
    around = [changes[0], *changes, changes[-1]]
    rows = []
    for before, change, after in zip(around, changes, around[2:], strict=False):
        size = np.abs(change).max(axis=2)
        unsteady = np.abs(change - 0.5 * (before + after)).max(axis=2)
        rows.append((size.max(), np.percentile(size, 99.9), np.percentile(unsteady, 99.9)))
    usual = median_filter(np.array([row[2] for row in rows]), _NEIGHBOURS, mode="nearest")
    limit = np.maximum(_STANDS_OUT * usual, _LEAST_JUMP)
    return [
        ClimbStep(
            float(lower), float(upper), float(row[0]), float(row[1]), float(row[2]), row[2] > top
        )
        for lower, upper, row, top in zip(heights, heights[1:], rows, limit, strict=False)
    ]


def _blurred(picture: NDArray[np.uint8], blur_px: float) -> NDArray[np.float32]:
    """The picture in shares of white, blurred, without its rim."""
    rim_px = round(_RIM_BLURS * blur_px)
    whole = gaussian_filter(np.float32(picture) / 255.0, (blur_px, blur_px, 0.0))
    height, width = whole.shape[:2]
    return np.asarray(whole[rim_px : height - rim_px, rim_px : width - rim_px])


def write_steps(folder: Path, steps: list[ClimbStep]) -> None:
    """Table, plot, and the jumps in words."""
    with (folder / "climb.csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(ClimbStep._fields)
        rows.writerows(steps)
    print(f"{'height above ground, m':>24} {'largest':>9} {'99.9 %':>9} {'unsteady':>9}   (of 255)")
    for step in steps:
        if step.jump or step in steps[:: max(len(steps) // 24, 1)]:
            told = "  JUMP" if step.jump else ""
            sizes = (255 * v for v in (step.largest, step.most, step.unsteady))
            print(f"{step.upper_m:24.4g}" + "".join(f" {v:9.2f}" for v in sizes) + told)
    print(f"{sum(step.jump for step in steps)} jumps in {len(steps)} steps")
    _plot(folder / "climb_steps.png", steps)


def _plot(path: Path, steps: list[ClimbStep]) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(9, 4.2), layout="constrained")
    heights = [step.upper_m for step in steps]
    axes.loglog(heights, [255 * step.largest for step in steps], "0.7", label="largest")
    axes.loglog(heights, [255 * step.most for step in steps], label="99.9th percentile")
    axes.loglog(heights, [255 * step.unsteady for step in steps], label="unsteady part of it")
    jumps = [step for step in steps if step.jump]
    axes.loglog(
        [step.upper_m for step in jumps],
        [255 * step.unsteady for step in jumps],
        "rx",
        label="jump",
    )
    axes.set(xlabel="height above the ground, m", ylabel="change to the next picture, of 255")
    axes.legend()
    figure.savefig(path, dpi=120)
    pyplot.close(figure)


def main() -> None:
    """Draw, measure, write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--measure", action="store_true", help="Compare pictures 2 percent apart.")
    parser.add_argument("--sky", default="bruneton_sky", help="The module that holds the sky.")
    wish = parser.parse_args()
    wish.folder.mkdir(parents=True, exist_ok=True)
    strip = heights_m()
    pictures = draw_climb(strip, STRIP_PX, wish.sky)
    captions = [f"{h:.3g} m" if h < 1e3 else f"{h / 1e3:.0f} km" for h in strip]
    paper = sheet(list(zip(captions, pictures, strict=True)), 3)
    paper.save(wish.folder / "climb.jpg", quality=88)
    if wish.measure:
        heights = heights_m(STEP)
        write_steps(wish.folder, steps_between(heights, draw_climb(heights, STEP_PX, wish.sky)))


if __name__ == "__main__":
    main()
