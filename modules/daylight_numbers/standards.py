"""Compliance with EN 17037, BRE 209, LEED v4.1 and WELL: a requirement, a finding and a verdict for
each clause.

A clause whose input is missing is not assessed, and says what it lacks.
"""

from collections.abc import Mapping, Sequence
from datetime import UTC, date, datetime, time, timedelta
from typing import NamedTuple

import numpy as np

from daylight_numbers.metrics import RoomYear
from daylight_numbers.now import hour_at_sensors
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.report import Table
from daylight_numbers.rooms import SIDES, DaylitRoom
from daylight_numbers.sensors import Sensors
from daylight_numbers.sun_hours import sun_in_openings, sun_level, suns_of_day
from daylight_numbers.view_out import AREA, ViewOut, view_out
from daylight_numbers.windows import WindowLight, sunny_hours, windows_of
from daylight_numbers.work import DaylightWork
from daylight_numbers.year_light import YEAR
from vrut_lite.messages.weather import SetWeather
from vrut_lite.numeric_types import FloatArray
from vrut_lite.quantities import percent_text

NEEDS_YEAR, NEEDS_WEATHER = "not assessed: needs --year", "not assessed: needs --weather"
NEEDS_ROOM = "not assessed: no room with openings is found"
# BRE 209: vertical sky component, and shares of sunny hours of the year and of winter.
_VSC_PERCENT, _ANNUAL_SHARE, _WINTER_SHARE = 27.0, 0.25, 0.05
# LEED v4.1 EQ credit Daylight: least shares of floor for 1, 2 and 3 points, options 1 and 2.
_LEED_SDA, _LEED_LUX = (0.40, 0.55, 0.75), (0.55, 0.75, 0.90)
_LEED_RANGE_LX, _LEED_HOURS = (300.0, 3000.0), (9, 15)
_MOST_ASE = 0.10
# LEED's clear days lie so near to the equinoxes; without weather they are the equinoxes.
_EQUINOXES, _DAYS_NEAR = ((3, 21), (9, 21)), 15
_WELL_SDA = 0.55
_ROUNDING = 1e-9


class PlaneYear(NamedTuple):
    """A year of a work plane: its numbers, and sDA 300/50 with blinds, None without a room."""

    room: RoomYear
    sda: float | None


class YearFound(NamedTuple):
    """Results of a year: work planes by their number, and glare levels of eyes."""

    planes: Mapping[int, PlaneYear]
    glare_levels: Sequence[str]


class _Clause(NamedTuple):
    """A row: clause, subject, requirement, finding and verdict."""

    clause: str
    subject: str
    asks: str
    found: str
    verdict: str


class Facts(NamedTuple):
    """Inputs of the clauses, by the number of a room's work plane.

    Attributes:
        names: of the rooms.
        area_m2: of their work planes.
        lit_by_roof: whether most openings are in the roof.
        views, windows: see `view_out` and `windows_of`.
        sun_h: most hours of sun in a room's openings on a day.
        equinox_share: of the floor with LEED's illuminance at both hours; None without rooms.
        has_weather: whether probable sunlight hours are known.
        year: None if no year was computed.
    """

    names: Mapping[int, str]
    area_m2: Mapping[int, float]
    lit_by_roof: Mapping[int, bool]
    views: Mapping[int, ViewOut]
    windows: Mapping[int, list[WindowLight]]
    sun_h: Mapping[int, float]
    equinox_share: float | None
    has_weather: bool
    year: YearFound | None


def facts_of(
    work: DaylightWork,
    opened: OpenedScene,
    rooms: Mapping[int, DaylitRoom],
    year: YearFound | None,
    sun_day: date,
) -> Facts:
    """The facts of a scene; `sun_day` is that of EN 17037's hours of sun. Moves the clock.

    Raises:
        UserError: the sky has no light for an hour.
    """
    weather, place = weather_of(opened), opened.place
    sunny = None if weather is None else sunny_hours(weather, place.north_offset_rad)
    midnight = datetime.combine(sun_day, time(), UTC) - timedelta(hours=opened.standard_offset_h)
    area_m2 = {plane: _area_m2(work.sensors, plane) for plane in rooms}
    equinox = equinox_share(work, opened, area_m2)
    suns = suns_of_day(opened, midnight)
    return Facts(
        names={plane: work.sensors.names[plane] for plane in rooms},
        area_m2=area_m2,
        lit_by_roof={plane: room.is_lit_by_roof for plane, room in rooms.items()},
        views={plane: view_out(work, plane, room) for plane, room in rooms.items()},
        windows={plane: windows_of(work, room, place, sunny) for plane, room in rooms.items()},
        sun_h={plane: sun_in_openings(work, room, suns) for plane, room in rooms.items()},
        equinox_share=equinox,
        has_weather=sunny is not None,
        year=year,
    )


def weather_of(opened: OpenedScene) -> SetWeather | None:
    """The year of weather of a file, if there is one."""
    weather = opened.kernel.last(SetWeather)
    return weather if weather is not None and weather.path else None


def clauses(facts: Facts) -> list[Table]:
    """Tables of clauses, one for each standard."""
    return [
        _table("EN 17037:2018, Daylight in buildings", _en_17037(facts)),
        _table("BRE 209:2022, Site layout planning", _bre_209(facts)),
        _table("LEED v4.1 BD+C, EQ credit Daylight", _leed(facts)),
        _table("WELL v1, feature 62", _well(facts)),
    ]


def _table(heading: str, rows: Sequence[_Clause]) -> Table:
    return Table(heading, ["clause", "of", "asks", "found", "verdict"], rows, is_text=True)


def _en_17037(facts: Facts) -> list[_Clause]:
    rows, year = [], facts.year
    for plane, name in facts.names.items():
        one = None if year is None else year.planes.get(plane)
        asks = "300 lx on 95 %" if facts.lit_by_roof[plane] else "300 lx on 50 %, 100 lx on 95 %"
        median_low = (
            "" if one is None else f"{one.room.en_median_lx:,.0f}, {one.room.en_low_lx:,.0f} lx"
        )
        verdict = NEEDS_YEAR if one is None else _level(one.room.en_level)
        rows.append(_Clause("5.1 daylight provision, method 2", name, asks, median_low, verdict))
        view = facts.views[plane]
        width, distance = (_of_most(values) for values in (view.width_deg, view.distance_m))
        layers = zip(("sky", "landscape", "ground"), view.layers.T, strict=True)
        seen = ", ".join(f"{layer} {percent_text(float(of.mean()))}" for layer, of in layers)
        found = f"{width:.0f}°, {_metres(distance)}, {seen}"
        asks = "14°, 6 m and the landscape, from 75 % of the area"
        rows.append(_Clause("5.2 view out", name, asks, found, _level(view.level)))
        hours = facts.sun_h[plane]
        asks = "1.5 h on a day from 1 February to 21 March"
        verdict = _level(sun_level(hours))
        rows.append(_Clause("5.3 exposure to sunlight", name, asks, f"{hours:.1f} h", verdict))
    clause, asks = "5.4 protection from glare", "DGP above 0.45 in 5 % of hours at most"
    levels = () if year is None else year.glare_levels
    rows += [
        _Clause(clause, f"eye {n + 1}", asks, level, _level(level))
        for n, level in enumerate(levels)
    ] or [_Clause(clause, "eyes", asks, "", "not assessed: needs --year and --eyes")]
    return rows


def _bre_209(facts: Facts) -> list[_Clause]:
    rows = []
    for plane, of_room in facts.windows.items():
        for window in of_room:
            where = f"{facts.names[plane]}, {SIDES[window.side]}, {window.azimuth_deg:.0f}°"
            low, high = window.vsc_range_percent
            found = f"{window.vsc_percent:.1f} % ({low:.1f} to {high:.1f})"
            verdict = _met(window.vsc_percent >= _VSC_PERCENT)
            rows.append(
                _Clause("2.2 vertical sky component", where, f"{_VSC_PERCENT:g} %", found, verdict)
            )
            clause, asks = "3.2 probable sunlight hours", "25 % of the year's, 5 % in winter"
            annual, winter = window.annual_share, window.winter_share
            if annual is None or winter is None:
                lack = "no hour of the file is sunny" if facts.has_weather else NEEDS_WEATHER
                rows.append(_Clause(clause, where, asks, "", lack))
                continue
            found = f"{percent_text(annual, 1)}, winter {percent_text(winter, 1)}"
            verdict = (
                _met(annual >= _ANNUAL_SHARE and winter >= _WINTER_SHARE)
                if window.faces_sun
                else "not asked: faces away from the sun"
            )
            rows.append(_Clause(clause, where, asks, found, verdict))
    return rows


def _leed(facts: Facts) -> list[_Clause]:
    asks = "sDA 300/50 of the floor: 40, 55, 75 % for 1, 2, 3 points"
    shares = _sda_and_ase(facts)
    if shares is None:
        first = _Clause("option 1", "all rooms", asks, "", _lack_of_sda(facts))
    else:
        found = f"sDA {percent_text(shares.sda, 1)}, most ASE {percent_text(shares.most_ase, 1)}"
        remark = "" if _at_most(shares.most_ase, _MOST_ASE) else "; say how glare is dealt with"
        first = _Clause(
            "option 1", "all rooms", asks, found, _points(shares.sda, _LEED_SDA) + remark
        )
    asks = "300 to 3,000 lx at 9:00 and 15:00: 55, 75, 90 % of the floor"
    share = facts.equinox_share
    found = "" if share is None else percent_text(share, 1)
    verdict = NEEDS_ROOM if share is None else _points(share, _LEED_LUX)
    return [first, _Clause("option 2", "all rooms", asks, found, verdict)]


def _well(facts: Facts) -> list[_Clause]:
    shares, sda, ase = _sda_and_ase(facts), "sDA 300/50 of 55 %", "ASE 1000/250 of at most 10 %"
    if shares is None:
        lack = _lack_of_sda(facts)
        return [_Clause(n, "all rooms", asks, "", lack) for n, asks in (("1a", sda), ("1b", ase))]
    found = percent_text(shares.sda, 1), percent_text(shares.ase, 1)
    return [
        _Clause("1a", "all rooms", sda, found[0], _met(_at_most(_WELL_SDA, shares.sda))),
        _Clause("1b", "all rooms", ase, found[1], _met(_at_most(shares.ase, _MOST_ASE))),
    ]


def _lack_of_sda(facts: Facts) -> str:
    return NEEDS_YEAR if facts.year is None else NEEDS_ROOM


class _Shares(NamedTuple):
    """SDA and ASE of the rooms' floor, and the ASE of the room with most."""

    sda: float
    ase: float
    most_ase: float


def _sda_and_ase(facts: Facts) -> _Shares | None:
    """Shares of the floor, weighted by area; None without a year or rooms."""
    planes = {} if facts.year is None else facts.year.planes
    found = [
        (facts.area_m2[plane], one.sda, one.room.ase_1000_250)
        for plane, one in planes.items()
        if plane in facts.names and one.sda is not None
    ]
    if not found:
        return None
    area, sda, ase = np.array(found, float).T
    return _Shares(
        float(np.average(sda, weights=area)), float(np.average(ase, weights=area)), float(ase.max())
    )


def _at_most(share: float, limit: float) -> bool:
    """Whether a share is at most a limit; sums of areas leave rounding."""
    return share <= limit + _ROUNDING


def _area_m2(sensors: Sensors, plane: int) -> float:
    """Area of a plane's cells; points in no grid count as 1 m^2 each."""
    return float((sensors.plane == plane).sum()) * (sensors.step_m[plane] ** 2 or 1.0)


def equinox_share(
    work: DaylightWork, opened: OpenedScene, area_m2: Mapping[int, float]
) -> float | None:
    """Share of the floor of some planes with 300 to 3,000 lx at 9:00 and at 15:00, standard time,
    by the mean of two clear days near the equinoxes; None without planes. Moves the clock."""
    if not area_m2:
        return None
    sensors, days = work.sensors, _clear_days(weather_of(opened))
    fits = np.ones(len(sensors), bool)
    low, high = _LEED_RANGE_LX
    for hour in _LEED_HOURS:
        lux = np.mean([_lux_at(work, opened, day, hour) for day in days], axis=0)
        fits &= (lux >= low) & (lux <= high)
    share = [fits[sensors.plane == plane].mean() for plane in area_m2]
    return float(np.average(share, weights=list(area_m2.values())))


def _clear_days(weather: SetWeather | None) -> list[datetime]:
    """The two days: those with most direct beam at both hours, or the equinoxes."""
    days = [datetime(YEAR, month, day, tzinfo=UTC) for month, day in _EQUINOXES]
    if weather is None:
        return days
    beam = np.array(weather.direct_normal_w_m2)[: 365 * 24].reshape(-1, 24)
    first = datetime(YEAR, 1, 1, tzinfo=UTC)
    found = []
    for equinox in days:
        middle = (equinox - first).days
        near = np.arange(middle - _DAYS_NEAR, middle + _DAYS_NEAR + 1)
        at_hours = beam[near][:, list(_LEED_HOURS)].sum(axis=1)
        found.append(first + timedelta(days=int(near[np.argmax(at_hours)])))
    return found


def _lux_at(work: DaylightWork, opened: OpenedScene, day: datetime, hour: int) -> FloatArray:
    opened.go_to(day + timedelta(hours=hour - opened.standard_offset_h))
    light = opened.hour()
    return hour_at_sensors(work.transport, work.glass, work.operator, work.sensors, light).total


def _level(level: str) -> str:
    return "fails" if level == "none" else f"meets {level}"


def _met(met: bool) -> str:
    return "meets" if met else "fails"


def _points(share: float, least: Sequence[float]) -> str:
    count = sum(_at_most(one, share) for one in least)
    return "fails" if not count else f"{count} point{'s' if count > 1 else ''}"


def _of_most(values: FloatArray) -> float:
    """The value that three quarters of the places reach."""
    return float(np.quantile(values, 1.0 - AREA, method="lower"))


def _metres(distance_m: float) -> str:
    return "open" if np.isinf(distance_m) else f"{distance_m:.0f} m"


def method(weather: SetWeather | None) -> list[str]:
    """Sentences on how the facts are found."""
    days = (
        "21 March and 21 September under this sky"
        if weather is None
        else "the clearest of the weather file within 15 days of the equinoxes"
    )
    return [
        "View out: rays from eyes 1.2 m above the floor that leave by the room's openings, 2 "
        "degrees apart; width and distance are those that three quarters of the places reach. "
        "Landscape is what stands outside and the horizon within 4 degrees; ground is level.",
        "Vertical sky component: CIE's overcast sky without reflected light on the wall's outer "
        "face, in the mean over the openings of a side; glass of other buildings hides the sky. "
        "Probable sunlight hours are those of the weather file whose direct beam exceeds 120 W/m².",
        f"LEED's rooms are all that are found; its option 2 is the mean of two days, {days}.",
    ]
