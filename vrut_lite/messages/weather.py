"""A year of weather measured at a place, hour by hour."""

from datetime import UTC, datetime, timedelta
from typing import NamedTuple

import numpy as np

from vrut_lite import checks
from vrut_lite.kernel.messages import Input
from vrut_lite.messages.place import HIGHEST_M, LOWEST_M, SetPlace

HOURS, LEAP_HOURS = 8760, 8784
MOST_DIRECT_W_M2, MOST_DIFFUSE_W_M2 = 1500.0, 1200.0
_COLDEST_C, _WARMEST_C = -100.0, 60.0
_END_OF_FEBRUARY = 31 + 28


class WeatherHour(NamedTuple):
    """One hour's means; `cloud_cover` is a share of the sky, None where unknown."""

    direct_normal_w_m2: float
    diffuse_horizontal_w_m2: float
    dew_point_c: float
    cloud_cover: float | None


class SetWeather(Input, frozen=True, kw_only=True):
    """The weather of a year at its place; a sky that follows it hears this.

    The values are means of hours in the file's standard time, `utc_offset_h` ahead of UTC, the
    first from midnight to one on the 1st of January: 8,760, or 8,784 with a 29th of February.
    `path` names the file, for display only. Irradiances are broadband: watts of all
    wavelengths. `cloud_cover` is a share of the sky, empty where the file has none. `lacks` has a
    line for each missing quantity, with its replacement, and for each contradiction with the sun of
    its place or within the file.
    """

    path: str
    name: str
    latitude_deg: float
    longitude_deg: float
    altitude_m: float
    utc_offset_h: float
    direct_normal_w_m2: tuple[float, ...]
    diffuse_horizontal_w_m2: tuple[float, ...]
    dew_point_c: tuple[float, ...]
    cloud_cover: tuple[float, ...] = ()
    lacks: tuple[str, ...] = ()

    def check(self) -> None:
        """A place, and as many numbers as a year has hours."""
        checks.text(self, "path", "name")
        checks.lines(self, "lacks")
        checks.number(self, "latitude_deg", -90.0, 90.0, of="weather")
        checks.number(self, "longitude_deg", -180.0, 180.0, of="weather")
        checks.number(self, "altitude_m", LOWEST_M, HIGHEST_M, of="weather")
        checks.number(self, "utc_offset_h", -14.0, 14.0, of="weather")
        self._check_year("direct_normal_w_m2", 0.0, MOST_DIRECT_W_M2)
        self._check_year("diffuse_horizontal_w_m2", 0.0, MOST_DIFFUSE_W_M2)
        self._check_year("dew_point_c", _COLDEST_C, _WARMEST_C)
        if self.cloud_cover != ():
            self._check_year("cloud_cover", 0.0, 1.0)

    def _check_year(self, name: str, low: float, high: float) -> None:
        values = getattr(self, name)
        fits = isinstance(values, tuple) and len(values) in (HOURS, LEAP_HOURS)
        if not fits or len(values) != len(self.direct_normal_w_m2):
            checks.refuse(self, name, f"have {HOURS} or {LEAP_HOURS} hours, as all others")
        if not all(map(checks.is_finite, values)):
            checks.refuse(self, name, "hold finite numbers")
        array = np.array(values, dtype=float)
        if not (low <= array.min() and array.max() <= high):
            checks.refuse(self, name, f"hold numbers from {low:g} to {high:g}")

    @property
    def place(self) -> SetPlace:
        """Place of the measurement."""
        return SetPlace(
            latitude_deg=self.latitude_deg,
            longitude_deg=self.longitude_deg,
            altitude_m=self.altitude_m,
        )

    def row_at(self, instant: datetime) -> int:
        """The number of the hour in which an instant lies, of whatever year the instant is.

        Without a 29th of February that day has the weather of the 28th.
        """
        local = instant.astimezone(UTC) + timedelta(hours=self.utc_offset_h)
        day = local.timetuple().tm_yday - 1
        leap = local.year % 4 == 0 and (local.year % 100 != 0 or local.year % 400 == 0)
        rows_leap = len(self.direct_normal_w_m2) == LEAP_HOURS
        if leap and not rows_leap and day >= _END_OF_FEBRUARY:
            day -= 1
        elif rows_leap and not leap and day >= _END_OF_FEBRUARY:
            day += 1
        return 24 * day + local.hour

    def hour_at(self, instant: datetime) -> WeatherHour:
        """The means of the hour in which an instant lies."""
        row = self.row_at(instant)
        return WeatherHour(
            self.direct_normal_w_m2[row],
            self.diffuse_horizontal_w_m2[row],
            self.dew_point_c[row],
            self.cloud_cover[row] if self.cloud_cover else None,
        )
