"""The times of the day of measurement, with the sun's place and, where there is one, the scan."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite_lab.study.framework.day import KIDER
from vrut_lite_lab.study.framework.measurements import MeasuredSky
from vrut_lite_lab.study.framework.sun_coordinates import sun_coordinates


@dataclass(frozen=True, eq=False)
class Moment:
    """A time; `measured` is the radiance (81, 40), or None where nothing was measured."""

    label: str
    sun_zenith_rad: float
    sun_azimuth_rad: float
    measured: NDArray[np.float64] | None = None

    @property
    def title(self) -> str:
        """As in `06:35, sun 80.6°`."""
        return f"{self.label}, sun {np.degrees(self.sun_zenith_rad):.1f}°"


def moments(times: Sequence[str], measured: Sequence[MeasuredSky]) -> list[Moment]:
    """Moments at hours `HH:MM` of the day of the measurements, or of 27 May 2013 over Ithaca.

    Raises:
        UserError: a time is none, or the sun is down.
    """
    return [_moment(text.strip(), measured) for text in times]


def measured_moments(measured: Sequence[MeasuredSky]) -> list[Moment]:
    """Every measured one."""
    return [
        Moment(f"{sky.time:%H:%M}", sky.sun_zenith_rad, sky.sun_azimuth_rad, sky.radiance)
        for sky in measured
    ]


def _moment(text: str, measured: Sequence[MeasuredSky]) -> Moment:
    try:
        clock = datetime.strptime(text, "%H:%M")
    except ValueError:
        raise UserError(f"--times: {text!r} is no hour as 06:35") from None
    day = measured[0].day if measured else KIDER
    when = day.midnight.replace(hour=clock.hour, minute=clock.minute)
    label = f"{when:%H:%M}"
    found = (each for each in measured_moments(measured) if each.label == label)
    zenith, azimuth = sun_coordinates(when, day.latitude_deg, day.longitude_deg)
    if zenith >= np.pi / 2:
        raise UserError(f"--times: at {label} the sun is below the horizon of {day.place}")
    return next(found, Moment(label, zenith, azimuth))
