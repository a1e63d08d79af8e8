"""The numbers of one hour at sensors, from a scene and its light alone: no bus, no files."""

from dataclasses import dataclass

from light_transport.daylight_numbers.cie_skies import CieSky, cie_hour
from light_transport.daylight_numbers.now import (
    HourAtSensors,
    daylight_factor,
    hour_at_sensors,
    sky_view,
)
from light_transport.daylight_numbers.work import Work
from light_transport.giving_up import CancelCheck, always
from light_transport.hour.illumination import Illumination
from vrut_lite.numeric_types import FloatArray

GROUND_ALBEDO = 0.2


@dataclass(frozen=True, eq=False)
class NumbersNow:
    """Of sensors (P): lux of the hour; daylight factor and its standard error in percent; the share
    of the hemisphere, weighted by the cosine, through which the sky is seen."""

    light: HourAtSensors
    daylight_factor_percent: FloatArray
    daylight_factor_error_percent: FloatArray
    sky_view: FloatArray


def numbers_now(
    work: Work,
    hour: Illumination,
    cie_sky: CieSky = "16",
    ground_albedo: float = GROUND_ALBEDO,
    go_on: CancelCheck = always,
) -> NumbersNow:
    """The numbers of an hour.

    Args:
        work: `work_of` the scene: it takes seconds and serves all hours.
        hour: the light; see `jobs.hour_of` for that of messages.
        cie_sky: of the daylight factor.
        ground_albedo: under that sky.
        go_on: called between steps.

    Raises:
        GivenUp: by `go_on`.
    """
    of = work.bake, work.glass, work.operator, work.sensors
    light = hour_at_sensors(*of, hour)
    go_on()
    factor, error = daylight_factor(*of, cie_hour(cie_sky, ground_albedo))
    return NumbersNow(light, factor, error, sky_view(work.operator))
