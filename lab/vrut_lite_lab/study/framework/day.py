"""The day of measured skies: its place, and what is known of its air and sun, with sources."""

import math
import tomllib
from datetime import UTC, date, datetime, timedelta, timezone
from pathlib import Path
from typing import Annotated, Any

import msgspec

from vrut_lite.errors import UserError

FILE = "day.toml"
_INPUTS = ("optical_depth_550", "angstrom_exponent", "ozone_du", "sun_distance_au")


class MeasuredDay(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What `day.toml` says beside the scans; `sources` names where each input is from.

    `optical_depth_550` is the aerosol's, vertical; `sun_distance_au` is computed where it is not
    given, and `ozone_du` is a mean column.
    """

    place: str
    date: date
    latitude_deg: Annotated[float, msgspec.Meta(ge=-90, le=90)]
    longitude_deg: Annotated[float, msgspec.Meta(ge=-180, le=180)]
    utc_offset_h: Annotated[float, msgspec.Meta(ge=-14, le=14)]
    optical_depth_550: Annotated[float, msgspec.Meta(ge=0, le=3)]
    angstrom_exponent: Annotated[float, msgspec.Meta(ge=-1, le=4)] = 1.3
    ozone_du: Annotated[float, msgspec.Meta(ge=0, le=700)] = 300.0
    sun_distance_au: Annotated[float, msgspec.Meta(ge=0.98, le=1.02)] | None = None
    sources: dict[str, str] = {}

    @property
    def zone(self) -> timezone:
        """Of the scans' clock."""
        return timezone(timedelta(hours=self.utc_offset_h))

    @property
    def midnight(self) -> datetime:
        """The beginning of the day."""
        return datetime(self.date.year, self.date.month, self.date.day, tzinfo=self.zone)

    @property
    def sun_distance(self) -> float:
        """In au; computed to 1e-4 by the Astronomical Almanac's short formula if not given."""
        if self.sun_distance_au is not None:
            return self.sun_distance_au
        days = (self.midnight - datetime(2000, 1, 1, 12, tzinfo=UTC)).days + 0.5
        anomaly = math.radians(357.528 + 0.9856003 * days)
        return 1.00014 - 0.01671 * math.cos(anomaly) - 0.00014 * math.cos(2.0 * anomaly)

    @property
    def in_words(self) -> str:
        """Place, date and every input with its source, for the page."""
        values = {**msgspec.structs.asdict(self), "sun_distance_au": round(self.sun_distance, 4)}
        said = [
            f"{name.replace('_', ' ')} {values[name]:.4g} ({self._source(name)})"
            for name in _INPUTS
        ]
        return f"{self.place}, {self.date.day} {self.date:%B %Y}: {'; '.join(said)}."

    def _source(self, name: str) -> str:
        if name in self.sources:
            return self.sources[name]
        if name == "sun_distance_au" and self.sun_distance_au is None:
            return "computed from the date"
        default = {"angstrom_exponent": 1.3, "ozone_du": 300.0}
        return "assumed" if default.get(name) == getattr(self, name) else "no source given"


# Kider et al. 2014; the air of Bruneton's evaluation of 2016.
KIDER = MeasuredDay(
    place="Ithaca, New York",
    date=date(2013, 5, 27),
    latitude_deg=42.44337,
    longitude_deg=-76.48163,
    utc_offset_h=-4.0,
    optical_depth_550=0.04 * 0.55**-0.8,
    angstrom_exponent=0.8,
    ozone_du=300.0,
    sun_distance_au=1.0133,
    sources={
        "optical_depth_550": "Bruneton 2016, section 4: Angstrom's beta 0.04",
        "angstrom_exponent": "the same",
        "ozone_du": "a mean column, Bruneton 2017; none in the air of 2016",
        "sun_distance_au": "Astronomical Almanac, 16:00 UT",
    },
)


def day_of(folder: Path, measured_on: date) -> MeasuredDay:
    """What `day.toml` in a folder says, or Kider's day.

    Raises:
        UserError: the file is damaged or of another date, or there is none and it is another day.
    """
    file = folder / FILE
    if not file.is_file():
        if measured_on == KIDER.date:
            return KIDER
        raise UserError(
            f"{folder}: skies of {measured_on} need a file {FILE} beside them with place, date, "
            "latitude_deg, longitude_deg, utc_offset_h and optical_depth_550"
        )
    try:
        values: dict[str, Any] = tomllib.loads(file.read_text(encoding="utf-8"))
        day = msgspec.convert(values, MeasuredDay)
    except OSError as error:
        raise UserError(f"{file}: cannot be read: {error.strerror}") from None
    except (msgspec.ValidationError, ValueError) as error:
        raise UserError(f"{file}: {str(error).replace('`', '')}") from None
    if day.date != measured_on:
        raise UserError(f"{file}: is of {day.date}, but the skies are of {measured_on}")
    return day
