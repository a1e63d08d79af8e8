"""Hours of a year of weather at sensors, by the year's product and by Radiance, live.

    .venv/bin/python -m tools.radiance.year prague.epw

Prints a row a scene: mean, rms and largest difference in percent of the year's mean light, without
the sun's own, and CPU seconds of both.
"""

import resource
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from light_transport.daylight_numbers.annual import solved_year, year_matrices, year_of
from light_transport.daylight_numbers.opened_scene import OpenedScene
from light_transport.daylight_numbers.sensors import free_sensors
from light_transport.daylight_numbers.work import work_of
from light_transport.daylight_numbers.year_light import HOURS, lit_hours, middle_of, year_light
from light_transport.surfaces.surfaces import surfaces_of

from tools.radiance.grids import GRIDS, Grid
from tools.radiance.irradiance import Effort, irradiance_by_radiance
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.numeric_types import FloatArray
from vrut_lite.project import project_of_path, with_weather

SCENES = ("work/indoor.glb", "large/hall.toml", "courtyard")
# Times of day of which every day is computed; all that is interpolated is between days.
CLOCKS = (9, 12, 15)


@dataclass(frozen=True, eq=False)
class ComparedYear:
    """Lux (P, H) without the sun's own of sampled hours, by both, and CPU seconds.

    `ours_cpu_s` is for the year's hours that were computed, `radiance_cpu_s` for the sample.
    """

    ours: FloatArray
    radiance: FloatArray
    hours: int
    ours_cpu_s: float
    radiance_cpu_s: float

    @property
    def error(self) -> FloatArray:
        """Differences (P, H), as shares of each hour's mean light."""
        return np.asarray((self.ours - self.radiance) / self.radiance.mean(axis=0))

    @property
    def of_sum(self) -> FloatArray:
        """Differences (P,) of all sampled hours together, as shares of their mean."""
        total = self.radiance.sum(axis=1)
        return np.asarray((self.ours.sum(axis=1) - total) / total.mean())


def compared_year(
    grid: Grid, weather: str, sampled: int, effort: Effort, tolerance: float = 0.1
) -> ComparedYear:
    """Compare some hours of a year, evenly spread, at the corners and the middle of a grid."""
    project = project_of_path(str(Path("scenes") / grid.file))
    opened = OpenedScene(with_weather(project, weather))
    try:
        began = time.process_time()
        places = grid.places_m
        shown = places[np.linspace(0, len(places) - 1, 5).astype(int)]
        up = np.tile([0.0, 1.0, 0.0], (len(shown), 1))
        work = work_of(opened.scene, free_sensors(shown, up, grid.scene), tolerance)
        offset_h = opened.standard_offset_h
        hours = lit_hours(opened.place, offset_h)
        hours = hours[np.isin(hours % HOURS, CLOCKS)]
        light = year_light(opened, hours, offset_h, range(len(hours)))
        matrices = year_matrices(work, light, solved_year(work.bake, light))
        year = year_of(matrices, light)
        ours_s = time.process_time() - began
        chosen = np.linspace(0, len(hours) - 1, sampled + 2).astype(int)[1:-1]
        ours = (year.total - year.sun)[:, chosen].astype(float)
        surfaces = surfaces_of(opened.scene)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        theirs = []
        for hour in hours[chosen]:
            opened.go_to(middle_of(int(hour), offset_h))
            found = irradiance_by_radiance(surfaces, opened.hour(), shown, up, effort)
            theirs.append(luminance(found) * LUMENS_PER_WATT)
        radiance_s = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    finally:
        opened.close()
    return ComparedYear(ours, np.array(theirs).T, len(hours), ours_s, radiance_s)


def main(weather: str, scenes: tuple[str, ...] = SCENES) -> None:
    """Print the table."""
    for scene in scenes:
        grid = next(grid for grid in GRIDS if grid.scene == scene)
        found = compared_year(grid, weather, 12, Effort(8_192))
        error, of_sum = found.error, found.of_sum
        print(
            f"{scene}: hour {error.mean():+.2%} mean, {np.sqrt(np.mean(error**2)):.2%} rms, "
            f"{np.abs(error).max():.1%} most; year {of_sum.mean():+.2%} mean, "
            f"{np.sqrt(np.mean(of_sum**2)):.2%} rms; CPU {found.ours_cpu_s:.0f} s for "
            f"{found.hours} hours, Radiance {found.radiance_cpu_s:.0f} s for 12",
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1], tuple(sys.argv[2:]) or SCENES)
