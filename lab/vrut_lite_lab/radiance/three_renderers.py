"""Three renderers on level grids under the very same sky: ours, Radiance and Cycles.

    BLENDER_PYTHON=PYTHON python -m vrut_lite_lab.radiance.three_renderers [SCENE ...]

PYTHON has the package bpy. All have the scene's triangles as Lambert's, the sky of 12:30 as data
and the sun; light is that without the sun's own rays. Each is run with two seeds or efforts: half
their difference is the noise, and CPU times are also given for a noise of 1 %, by its square.
"""

import argparse
import os
import time
from collections.abc import Callable

import numpy as np
from light_transport.hour.illumination import Illumination
from light_transport.view.point_light import light_at

from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.radiance.by_cycles import irradiance_by_cycles
from vrut_lite_lab.radiance.grids import GRIDS, Baked, compared_hours
from vrut_lite_lab.radiance.irradiance import RadianceEffort, irradiance_by_radiance

SKY, HOUR = "dynamic_skylight", "12:30"
_SAMPLES, _RAYS = 8, 8192
_LEAST_SHARE = 0.02


def _row(name: str, work: Callable[[int], tuple[FloatArray, float]], radiance: FloatArray) -> str:
    """A line of the table: difference from Radiance, noise, CPU time, that for 1 %."""
    (first, spent_s), (second, _) = work(0), work(1)
    free = radiance > _LEAST_SHARE * radiance.mean()
    mean = radiance[free].mean()
    noise = float(np.std((first - second)[free]) / np.sqrt(2.0) / mean)
    error = (0.5 * (first + second) - radiance)[free] / mean
    rms = float(np.sqrt(np.mean(error**2)))
    cells = f"{error.mean():+.2%} | {rms:.2%} | {noise:.2%} | {spent_s:.1f}"
    return f"| {name} | {cells} | {spent_s * (noise / 0.01) ** 2:.2g} |"


def compare(baked: Baked, hour: Illumination, places_m: FloatArray) -> list[str]:
    """The lines of a scene."""
    up = np.tile([0.0, 1.0, 0.0], (len(places_m), 1))

    def radiance(seed: int) -> tuple[FloatArray, float]:
        before = os.times()
        found = irradiance_by_radiance(
            baked.surfaces, hour, places_m, up, RadianceEffort(_RAYS + 64 * seed)
        )
        after = os.times()
        spent_s = after.children_user - before.children_user
        return np.asarray(luminance(found), float), spent_s

    def cycles(seed: int) -> tuple[FloatArray, float]:
        found, spent_s = irradiance_by_cycles(baked.surfaces, hour, places_m, _SAMPLES, seed)
        return np.asarray(luminance(found), float), spent_s

    def ours(seed: int) -> tuple[FloatArray, float]:
        start = time.process_time()
        lit = baked.transport.light(hour)
        found = light_at(baked.transport, places_m, up, lit, _RAYS + 64 * seed).irradiance_rgb
        return np.asarray(luminance(found), float), time.process_time() - start

    known = 0.5 * (radiance(0)[0] + radiance(1)[0])
    return [
        _row("Radiance", radiance, known),
        _row("Cycles", cycles, known),
        _row("ours, on a baked map", ours, known),
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    names = [grid.scene for grid in GRIDS]
    parser.add_argument("scenes", nargs="*", default=names, help=f"of {', '.join(names)}")
    chosen = parser.parse_args().scenes
    print("| | mean | rms | noise | CPU s | CPU s for 1 % |\n|---|---:|---:|---:|---:|---:|")
    for grid in (each for each in GRIDS if each.scene in chosen):
        start = time.process_time()
        for caption, baked, hour in compared_hours(grid, SKY, (HOUR,)):
            print(f"| **{caption}** | | | | {time.process_time() - start:.1f} (bake) | |")
            print("\n".join(compare(baked, hour, grid.places_m)), flush=True)


if __name__ == "__main__":
    main()
