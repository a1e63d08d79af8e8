"""Light while time plays: a strip of two hours, and how much the light of shade swims.

    python -m tools.pictures.light_strip STRIP.jpg [SCENE ...]

The strip has a picture every half hour. For the figures each scene is drawn every two minutes for a
quarter of an hour, on a morning and at noon. In shade light changes smoothly while the sun moves: a
straight line and a bow are fitted to each pixel, and what is left over is what a viewer sees swim.
Told are its rms and its 99th percentile over pixels, relative to the pixel, and beside them by how
much the hour changes the pixel in one step. Pixels that the sun reaches meanwhile are left out:
those that change by more than a fifth in a step.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tools.pictures.drawing import Captioned, scene_project, sheet, shots
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import FloatArray

_DAY, _SCENES = "2026-06-21", ("street.toml", "work/indoor.glb")
_STRIP = ("15:00", "15:30", "16:00", "16:30", "17:00")
_STARTS, _STEPS, _STEP_MIN = ("09:00", "12:30"), 8, 2
_SIZE = (320, 200)
_MOST_STEP, _BRIGHT = 0.2, 1e-3


class Swimming(NamedTuple):
    """Shares of the light of a pixel: left over, rms and 99th percentile; change a step, rms."""

    rms: float
    p99: float
    step_rms: float
    pixels: int


def swimming(frames: FloatArray) -> Swimming:
    """Of luminances (steps, pixels) at even times."""
    lit = frames.min(axis=0) > _BRIGHT * frames.max()
    ratios = frames[1:, lit] / frames[:-1, lit]
    calm = np.abs(np.log(ratios)).max(axis=0) < _MOST_STEP
    relative = frames[:, lit][:, calm]
    relative = relative / relative.mean(axis=0)
    times = np.linspace(-1.0, 1.0, len(frames))
    powers = np.stack([times**n for n in range(3)], axis=1)
    smooth = powers @ np.linalg.lstsq(powers, relative, rcond=None)[0]
    # The fit has taken three of the degrees of freedom.
    off = np.sqrt(((relative - smooth) ** 2).sum(axis=0) / (len(frames) - powers.shape[1]))
    steps = np.diff(relative, axis=0)
    return Swimming(
        float(np.sqrt(np.mean(off**2))),
        float(np.quantile(off, 0.99)),
        float(np.sqrt(np.mean(steps**2))),
        relative.shape[1],
    )


def strip(scene: str) -> list[Captioned]:
    """A picture each half hour."""
    project = scene_project(scene, size=_SIZE)
    taken = shots(project, [f"{_DAY}T{hour}" for hour in _STRIP])
    return [(shot.caption, shot.picture.display) for shot in taken]


def swimming_from(scene: str, start: str) -> Swimming:
    """Of the frames that begin at a local hour."""
    hour, minute = map(int, start.split(":"))
    times = [minute + _STEP_MIN * n for n in range(_STEPS)]
    said = [f"{_DAY}T{hour + m // 60:02}:{m % 60:02}" for m in times]
    project = scene_project(scene, size=_SIZE)
    frames = [luminance(shot.picture.radiance[..., :3]).ravel() for shot in shots(project, said)]
    return swimming(np.array(frames, float))


def main() -> None:
    """Write the strip and print a Markdown table."""
    scenes = tuple(sys.argv[2:]) or _SCENES
    pictures = [picture for scene in scenes for picture in strip(scene)]
    sheet(pictures, len(_STRIP)).save(Path(sys.argv[1]), quality=88)
    print("| scene | from | swims, rms | 99 % of pixels | the hour, a step | pixels |")
    print("|---|---|---:|---:|---:|---:|")
    for scene in scenes:
        for start in _STARTS:
            found = swimming_from(scene, start)
            print(
                f"| {scene} | {start} | {found.rms:.3%} | {found.p99:.3%} "
                f"| {found.step_rms:.2%} | {found.pixels:,} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
