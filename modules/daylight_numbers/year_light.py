"""The light of a year, hour by hour: what the holder of the sky says at the middle of each hour.

The sky may be that of a year of weather or a clear one: it comes by messages, as any hour's.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

import numpy as np
from light_transport.public import GROUND_NODE, node_radiances
from numpy.typing import NDArray

from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.sky_cells import cell_directions, node_of_cell
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.place import SetPlace
from vrut_lite.numeric_types import Float32Array, FloatArray

DAYS, HOURS = 365, 24
# A year of 365 days.
YEAR = 2025
# Hours with a lower sun have no light that counts.
_LOWEST_SUN_DEG = -4.0


@dataclass(frozen=True, eq=False)
class YearLight:
    """The light of the hours (H) of a year that have some; linear sRGB, world axes.

    Attributes:
        hour: (H,) int, of the year from its first, in the place's standard time: 24 a day.
        sky: (H, GROUND_NODE + 1, 3) float32, radiance of the sky's cells and of open ground.
        sun_direction: (H, 3); sun_irradiance_rgb: (H, 3), W m^-2 on a plane that faces it.
        ground_albedo_rgb: of the ground disc.
        source: who made the sky.
    """

    hour: NDArray[np.int64]
    sky: Float32Array
    sun_direction: FloatArray
    sun_irradiance_rgb: FloatArray
    ground_albedo_rgb: FloatArray
    source: str

    @property
    def diffuse_lux(self) -> FloatArray:
        """Illuminance (H,) on open level ground without the sun's own."""
        mean = np.einsum("hkc,k->hc", self.sky[:, :GROUND_NODE], node_sines())
        return np.asarray(luminance(mean) * (2.0 * np.pi / GROUND_NODE) * LUMENS_PER_WATT)


def node_sines() -> FloatArray:
    """Mean sine of height (GROUND_NODE,) of the sky's cells."""
    sine = cell_directions()[..., 1].mean(axis=1)
    return np.bincount(node_of_cell(), sine) / np.bincount(node_of_cell())


def middle_of(hour: int, offset_h: float, year: int = YEAR) -> datetime:
    """The instant in the middle of an hour of a year of 365 days."""
    first = datetime(year, 1, 1, tzinfo=UTC) - timedelta(hours=offset_h)
    return first + timedelta(hours=hour + 0.5)


def lit_hours(place: SetPlace, offset_h: float) -> NDArray[np.int64]:
    """Hours of the year whose sun is at most a little below the horizon."""
    hour = np.arange(DAYS * HOURS)
    day, clock = hour // HOURS, hour % HOURS + 0.5
    # Spencer 1971: declination to 0.1 degrees, equation of time to half a minute.
    b = 2.0 * np.pi * day / 365.0
    tilt = 0.006918 - 0.399912 * np.cos(b) + 0.070257 * np.sin(b) - 0.006758 * np.cos(2 * b)
    tilt += 0.000907 * np.sin(2 * b)
    minutes = 229.18 * (0.000075 + 0.001868 * np.cos(b) - 0.032077 * np.sin(b))
    minutes += 229.18 * (-0.014615 * np.cos(2 * b) - 0.040849 * np.sin(2 * b))
    solar = clock + minutes / 60.0 + place.longitude_deg / 15.0 - offset_h
    turn, latitude = np.radians(15.0 * (solar - 12.0)), np.radians(place.latitude_deg)
    sine = np.sin(latitude) * np.sin(tilt) + np.cos(latitude) * np.cos(tilt) * np.cos(turn)
    return np.flatnonzero(sine > np.sin(np.radians(_LOWEST_SUN_DEG)))


def year_light(
    opened: OpenedScene, hours: NDArray[np.int64], offset_h: float, tracked: Iterable[int]
) -> YearLight:
    """The light of some hours; `tracked` are their numbers, which may show progress.

    Raises:
        UserError: the sky has no light for an hour.
    """
    sky = np.zeros((len(hours), GROUND_NODE + 1, 3), np.float32)
    towards, sun = np.zeros((2, len(hours), 3))
    albedo = np.zeros((len(hours), 3))
    opened.coarser()
    for n in tracked:
        opened.go_to(middle_of(int(hours[n]), offset_h))
        hour = opened.hour()
        radiances = node_radiances(hour.sky, hour.ground_radiance_rgb)
        sky[n] = radiances[: GROUND_NODE + 1]
        towards[n], sun[n] = hour.key_direction, hour.key_irradiance_rgb
        albedo[n] = hour.ground_albedo_rgb
        if not opened.lit_by_sun:
            sun[n] = 0.0
    return YearLight(hours, sky, towards, sun, np.median(albedo, axis=0), opened.source)
