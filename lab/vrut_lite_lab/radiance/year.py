"""Hours of a year of weather at sensors, by the year's product and by Radiance, live.

    .venv/bin/python -m vrut_lite_lab.radiance.year prague.epw [--hours N] [--points N] [SCENE ...]

The sun is in it. Prints for each scene: mean and rms of the differences of sampled hours, in
percent of each hour's mean light, of all light and without the sun's own; those of the sum of the
sampled hours; and CPU seconds of both. It needs the extra `radiance`.
"""

import argparse
import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.work import DaylightWork, work_of
from daylight_numbers.year.year import Year, solved_year, year_matrices, year_of
from daylight_numbers.year.year_light import (
    HOURS,
    YearLight,
    lit_hours,
    middle_of,
    year_light,
)
from light_transport.surfaces.surfaces import Surfaces, surfaces_of

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.numeric_types import BoolArray, FloatArray, IntArray
from vrut_lite.project import project_of_path, with_weather
from vrut_lite_lab.radiance.grids import GRIDS, MeasuredPoints
from vrut_lite_lab.radiance.irradiance import RadianceEffort, both_by_radiance

SCENES = ("work/indoor.glb", "large/hall.toml", "courtyard")
# Times of day of which every day is computed; all that is interpolated is between days.
CLOCKS = (9, 12, 15)
_RAYS = 8_192
# Of open ground without the sun: a dimmer hour is not compared.
_LEAST_LX = 500.0


@dataclass(frozen=True, eq=False)
class ComparedYear:
    """Lux (P, H) of sampled hours by both, whole and of the sun alone, and CPU seconds.

    `ours_cpu_s` is for the hours of the year that were computed, `radiance_cpu_s` for the sample.
    """

    ours: FloatArray
    radiance: FloatArray
    our_sun: FloatArray
    their_sun: FloatArray
    hour: IntArray
    hours: int
    ours_cpu_s: float
    radiance_cpu_s: float

    @property
    def error(self) -> FloatArray:
        """Differences (P, H) of all light, as shares of each hour's mean light."""
        return np.asarray((self.ours - self.radiance) / self.radiance.mean(axis=0))

    @property
    def of_rest(self) -> FloatArray:
        """Differences (P, H) without the sun's own light, as shares of each hour's mean of it."""
        rest = self.radiance - self.their_sun
        return np.asarray((self.ours - self.our_sun - rest) / rest.mean(axis=0))

    @property
    def of_sum(self) -> FloatArray:
        """Differences (P,) of all sampled hours together, as shares of their mean."""
        total = self.radiance.sum(axis=1)
        return np.asarray((self.ours.sum(axis=1) - total) / total.mean())


@dataclass(frozen=True, eq=False)
class YearHere:
    """Some hours of a year at points of an open scene, and the CPU seconds that they took."""

    opened: OpenedScene
    surfaces: Surfaces
    work: DaylightWork
    light: YearLight
    year: Year
    cpu_s: float

    @property
    def is_day(self) -> BoolArray:
        """Which hours (H,) count: others hold less than a thousandth of the year's light."""
        return np.asarray(self.light.diffuse_lux > _LEAST_LX)


@contextmanager
def year_here(
    grid: MeasuredPoints, weather: str, points: int, tolerance: float = 0.1
) -> Iterator[YearHere]:
    """The year at evenly spread points of a grid, at CLOCKS of each day."""
    project = project_of_path(str(Path("scenes") / grid.file))
    opened = OpenedScene(with_weather(project, weather))
    try:
        began = time.process_time()
        shown = grid.places_m[np.linspace(0, len(grid.places_m) - 1, points).astype(int)]
        up = np.tile([0.0, 1.0, 0.0], (len(shown), 1))
        work = work_of(opened.scene, free_sensors(shown, up, grid.scene), tolerance)
        offset_h = opened.standard_offset_h
        hours = lit_hours(opened.place, offset_h)
        hours = hours[np.isin(hours % HOURS, CLOCKS)]
        light = year_light(opened, hours, offset_h, lambda some, _count: some)
        year = year_of(year_matrices(work, light, solved_year(work.transport, light)), light)
        cpu_s = time.process_time() - began
        yield YearHere(opened, surfaces_of(opened.scene), work, light, year, cpu_s)
    finally:
        opened.close()


def compared_year(
    grid: MeasuredPoints,
    weather: str,
    sampled: int,
    effort: RadianceEffort,
    tolerance: float = 0.1,
    points: int = 9,
) -> ComparedYear:
    """Compare some hours of a year, evenly spread, at some points of a grid."""
    with year_here(grid, weather, points, tolerance) as here:
        opened, sensors = here.opened, here.work.sensors
        day = np.flatnonzero(here.is_day)
        chosen = day[np.linspace(0, len(day) - 1, sampled).astype(int)]
        hours = here.light.hour[chosen]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        theirs = []
        for hour in hours:
            opened.go_to(middle_of(int(hour), opened.standard_offset_h))
            found = both_by_radiance(
                here.surfaces, opened.hour(), sensors.places_m, sensors.normals, effort
            )
            theirs.append([luminance(part) * LUMENS_PER_WATT for part in found])
        radiance_s = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    whole, of_sun = np.array(theirs).transpose(1, 2, 0)
    return ComparedYear(
        here.year.total[:, chosen].astype(float),
        whole,
        here.year.sun[:, chosen].astype(float),
        of_sun,
        hours,
        len(here.light.hour),
        here.cpu_s,
        radiance_s,
    )


def main() -> None:
    """Print a line for each scene."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("weather")
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--hours", type=int, default=24)
    parser.add_argument("--points", type=int, default=9)
    told = parser.parse_args()
    for scene in told.scenes:
        grid = next(grid for grid in GRIDS if grid.scene == scene)
        found = compared_year(
            grid, told.weather, told.hours, RadianceEffort(_RAYS), points=told.points
        )
        of_sum = found.of_sum
        print(
            f"{scene}: all light {_said(found.error)}; without the sun's own "
            f"{_said(found.of_rest)}; sum {of_sum.mean():+.2%} mean, {rms(of_sum):.2%} rms, "
            f"{np.abs(of_sum).max():.2%} most; the sun reaches {(found.their_sun > 0).mean():.0%}, "
            f"or {(found.our_sun > 0).mean():.0%}; CPU {found.ours_cpu_s:.0f} s for {found.hours} "
            f"hours, Radiance {found.radiance_cpu_s:.0f} s for {told.hours}",
            flush=True,
        )


def _said(error: FloatArray) -> str:
    return f"{error.mean():+.2%} mean, {rms(error):.2%} rms"


def rms(values: FloatArray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


if __name__ == "__main__":
    main()
