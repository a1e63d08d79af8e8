"""Compliance with EN 17037, BRE 209, LEED v4.1 and WELL: a requirement, a finding and a verdict for
each clause.

A clause whose input is missing is not assessed, and says what it lacks.
"""

from collections.abc import Mapping, Sequence
from datetime import UTC, date, datetime, time, timedelta
from typing import NamedTuple

import numpy as np

from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.now import CieSky, hour_at_sensors
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.report import Table
from daylight_numbers.rooms import DaylitRoom
from daylight_numbers.standards.bre_209 import bre_clauses
from daylight_numbers.standards.compliance import (
    Clause,
    at_most,
    level_text,
    met_text,
    points_by_share,
    points_text,
)
from daylight_numbers.standards.site_change import (
    GardenSun,
    SiteChange,
    SiteScene,
    garden_sun,
    site_change,
)
from daylight_numbers.standards.sun_hours import (
    STEP_MINUTES,
    sun_in_openings,
    sun_level,
    suns_of_day,
)
from daylight_numbers.standards.sun_rules import RuleFound, rule_clauses, rules_of_room
from daylight_numbers.standards.view_out import AREA, ViewOut, view_out
from daylight_numbers.standards.windows import WindowLight, sunny_hours, windows_of
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.metrics import EN_LEAST_LX, EN_TARGET_LX, RoomYear, en_plane
from daylight_numbers.year.year_light import YEAR
from vrut_lite.messages.weather import SetWeather
from vrut_lite.numeric_types import FloatArray
from vrut_lite.quantities import percent_text

NEEDS_YEAR = "not assessed: needs --year"
NEEDS_ROOM = "not assessed: no room with openings is found"
# LEED v4.1 EQ credit Daylight: least shares of floor for 1, 2 and 3 points, options 1 and 2.
_LEED_SDA, _LEED_LUX = (0.40, 0.55, 0.75), (0.55, 0.75, 0.90)
_LEED_RANGE_LX, _LEED_HOURS = (300.0, 3000.0), (9, 15)
_MOST_ASE = 0.10
# LEED's clear days lie so near to the equinoxes; without weather they are the equinoxes.
_EQUINOXES, _DAYS_NEAR = ((3, 21), (9, 21)), 15
_WELL_SDA = 0.55
# WELL v2: illuminances that EN 17037's daylight hours must have, least shares of floor with 200 lx
# for L01, and of floor for 1 and 2 points of L06 by sDA 300/50 and by 300 and 100 lx.
WELL_EN_LX = (100.0, 200.0, 300.0)
_WELL_L01, _WELL_L06_SDA, _WELL_L06_EN = 0.30, (0.55, 0.75), (0.50, 0.95)
# CIE sky that EN 17037, B.2, does not take for daylight factors.
_EVEN_SKY = "5"


class PlaneYear(NamedTuple):
    """A year of a work plane: its numbers, sDA 300/50 and 200/40 with blinds, None without a room,
    and its shares with each of WELL_EN_LX in half of the daylight hours."""

    room: RoomYear
    sda: float | None
    sda_200_40: float | None
    with_en_lx: Sequence[float]


class YearFound(NamedTuple):
    """Results of a year: work planes by their number, glare levels of eyes, and the median diffuse
    illuminance outdoors (lx) of the daylight hours."""

    planes: Mapping[int, PlaneYear]
    glare_levels: Sequence[str]
    median_diffuse_lx: float


class OvercastLux(NamedTuple):
    """EN 17037's method 1 on a work plane: its level, and daylight factors in percent that 50 % and
    95 % of it reach."""

    level: str
    median_percent: float
    low_percent: float


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
        change: the state before the change; None without another scene.
        gardens: sun of work planes under no roof, by their names.
        sun_rules: of countries, see `sun_rules`.
        overcast: daylight factors of work planes; none without a year of weather, nor under a sky
            that EN 17037 does not take for them.
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
    change: SiteChange | None
    gardens: Mapping[str, GardenSun]
    sun_rules: Mapping[int, list[RuleFound]]
    overcast: Mapping[int, OvercastLux]
    year: YearFound | None


def facts_of(
    work: DaylightWork,
    opened: OpenedScene,
    rooms: Mapping[int, DaylitRoom],
    year: YearFound | None,
    sun_day: date,
    factor_percent: FloatArray,
    cie_sky: CieSky,
    before: SiteScene | None = None,
) -> Facts:
    """The facts of a scene; `sun_day` is that of EN 17037's hours of sun. Moves the clock.

    `factor_percent` (P,): daylight factors of the sensors under `cie_sky`. `before`: the
    scene without the new building.

    Raises:
        UserError: the sky has no light for an hour.
    """
    weather, place = weather_of(opened), opened.place
    sunny = None if weather is None else sunny_hours(weather, place.north_offset_rad)
    midnight = datetime.combine(sun_day, time(), UTC) - timedelta(hours=opened.standard_offset_h)
    area_m2 = {plane: _area_m2(work.sensors, plane) for plane in rooms}
    equinox = equinox_share(work, opened, area_m2)
    suns = suns_of_day(place, midnight)
    return Facts(
        names={plane: work.sensors.names[plane] for plane in rooms},
        area_m2=area_m2,
        lit_by_roof={plane: room.is_lit_by_roof for plane, room in rooms.items()},
        views={plane: view_out(work, plane, room) for plane, room in rooms.items()},
        windows={plane: windows_of(work, room, place, sunny) for plane, room in rooms.items()},
        sun_h={plane: sun_in_openings(work, room, suns) for plane, room in rooms.items()},
        equinox_share=equinox,
        has_weather=sunny is not None,
        change=None if before is None else site_change(work, rooms, place, sunny, before),
        gardens=garden_sun(
            work,
            [plane for plane in range(len(work.sensors.names)) if plane not in rooms],
            place,
            opened.standard_offset_h,
            before,
        ),
        sun_rules={
            plane: rules_of_room(work, room, place, opened.standard_offset_h)
            for plane, room in rooms.items()
        },
        overcast={}
        if year is None or weather is None or cie_sky == _EVEN_SKY
        else {
            plane: overcast_lux(
                factor_percent, work.sensors, plane, room.is_lit_by_roof, year.median_diffuse_lx
            )
            for plane, room in rooms.items()
        },
        year=year,
    )


def overcast_lux(
    factor_percent: FloatArray,
    sensors: Sensors,
    plane: int,
    is_lit_by_roof: bool,
    median_diffuse_lx: float,
) -> OvercastLux:
    """EN 17037:2018, clause 5.1, method 1: daylight factors (P,) times the median diffuse
    illuminance of the place (lx) must reach the targets of tables A.1 and A.2."""
    lux = factor_percent / 100.0 * median_diffuse_lx
    level, median, low = en_plane(lux, sensors, plane, is_lit_by_roof)
    return OvercastLux(level, *(100.0 * one / median_diffuse_lx for one in (median, low)))


def weather_of(opened: OpenedScene) -> SetWeather | None:
    """The year of weather of a file, if there is one."""
    weather = opened.kernel.last(SetWeather)
    return weather if weather is not None and weather.path else None


def clauses(facts: Facts) -> list[Table]:
    """Tables of clauses, one for each standard."""
    return [
        _table("EN 17037:2018, Daylight in buildings", _en_17037(facts)),
        _table(
            "BRE 209:2022, Site layout planning",
            bre_clauses(facts.names, facts.windows, facts.change, facts.gardens, facts.has_weather),
        ),
        _table(
            "Sunlight at windows, rules of countries",
            [
                row
                for plane, found in facts.sun_rules.items()
                for row in rule_clauses(facts.names[plane], found)
            ],
        ),
        _table("LEED v4.1 BD+C, EQ credit Daylight", _leed(facts)),
        _table("WELL v1, feature 62", _well(facts)),
        _table("WELL v2, Light", _well_v2(facts)),
    ]


def _table(heading: str, rows: Sequence[Clause]) -> Table:
    return Table(heading, ["clause", "of", "asks", "found", "verdict"], rows, is_text=True)


def _en_17037(facts: Facts) -> list[Clause]:
    rows, year = [], facts.year
    for plane, name in facts.names.items():
        one = None if year is None else year.planes.get(plane)
        asks = "300 lx on 95 %" if facts.lit_by_roof[plane] else "300 lx on 50 %, 100 lx on 95 %"
        median_low = (
            "" if one is None else f"{one.room.en_median_lx:,.0f}, {one.room.en_low_lx:,.0f} lx"
        )
        verdict = NEEDS_YEAR if one is None else level_text(one.room.en_level)
        rows.append(_method_1(facts, plane))
        rows.append(Clause("5.1 daylight provision, method 2", name, asks, median_low, verdict))
        view = facts.views[plane]
        width, distance = (_of_most(values) for values in (view.width_deg, view.distance_m))
        layers = zip(("sky", "landscape", "ground"), view.layers.T, strict=True)
        seen = ", ".join(f"{layer} {percent_text(float(of.mean()))}" for layer, of in layers)
        found = f"{width:.0f}°, {_metres(distance)}, {seen}"
        asks = "14°, 6 m and the landscape, from 75 % of the area"
        rows.append(Clause("5.2 view out", name, asks, found, level_text(view.level)))
        hours = facts.sun_h[plane]
        asks = "1.5 h on a day from 1 February to 21 March"
        verdict = level_text(sun_level(hours))
        rows.append(Clause("5.3 exposure to sunlight", name, asks, f"{hours:.1f} h", verdict))
    clause, asks = "5.4 protection from glare", "DGP above 0.45 in 5 % of hours at most"
    levels = () if year is None else year.glare_levels
    rows += [
        Clause(clause, f"eye {n + 1}", asks, level, level_text(level))
        for n, level in enumerate(levels)
    ] or [Clause(clause, "eyes", asks, "", "not assessed: needs --year and --eyes")]
    return rows


def _method_1(facts: Facts, plane: int) -> Clause:
    """The row of daylight factors, with the targets of the place."""
    clause, name = "5.1 daylight provision, method 1", facts.names[plane]
    found = facts.overcast.get(plane)
    if facts.year is None or found is None:
        lack = "not assessed: needs --year, --weather and an overcast --cie-sky"
        return Clause(clause, name, "300 lx on 50 %, 100 lx on 95 %, by factors", "", lack)
    median = facts.year.median_diffuse_lx
    target, least = (100.0 * lux[0] / median for lux in (EN_TARGET_LX, EN_LEAST_LX))
    asks = f"{target:.1f} % on 95 %" if facts.lit_by_roof[plane] else (
        f"{target:.1f} % on 50 %, {least:.1f} % on 95 %"
    )  # fmt: skip
    asks += f" of {median:,.0f} lx"
    factors = f"{found.median_percent:.2f}, {found.low_percent:.2f} %"
    return Clause(clause, name, asks, factors, level_text(found.level))


def _leed(facts: Facts) -> list[Clause]:
    asks = "sDA 300/50 of the floor: 40, 55, 75 % for 1, 2, 3 points"
    shares = _sda_and_ase(facts)
    if shares is None:
        first = Clause("option 1", "all rooms", asks, "", _lack_of_sda(facts))
    else:
        found = f"sDA {percent_text(shares.sda, 1)}, most ASE {percent_text(shares.most_ase, 1)}"
        remark = "" if at_most(shares.most_ase, _MOST_ASE) else "; say how glare is dealt with"
        first = Clause(
            "option 1", "all rooms", asks, found, points_by_share(shares.sda, _LEED_SDA) + remark
        )
    asks = "300 to 3,000 lx at 9:00 and 15:00: 55, 75, 90 % of the floor"
    share = facts.equinox_share
    found = "" if share is None else percent_text(share, 1)
    verdict = NEEDS_ROOM if share is None else points_by_share(share, _LEED_LUX)
    return [first, Clause("option 2", "all rooms", asks, found, verdict)]


def _well(facts: Facts) -> list[Clause]:
    shares, sda, ase = _sda_and_ase(facts), "sDA 300/50 of 55 %", "ASE 1000/250 of at most 10 %"
    if shares is None:
        lack = _lack_of_sda(facts)
        return [Clause(n, "all rooms", asks, "", lack) for n, asks in (("1a", sda), ("1b", ase))]
    found = percent_text(shares.sda, 1), percent_text(shares.ase, 1)
    return [
        Clause("1a", "all rooms", sda, found[0], met_text(at_most(_WELL_SDA, shares.sda))),
        Clause("1b", "all rooms", ase, found[1], met_text(at_most(shares.ase, _MOST_ASE))),
    ]


def _well_v2(facts: Facts) -> list[Clause]:
    """Rows of the features L01, L05 and L06; thresholds as in Ladybug Tools'
    honeybee-radiance-postprocess (well.py)."""
    shares = _sda_and_ase(facts)
    exposure, simulation = "L01 light exposure", "L06 daylight simulation"
    asked = (
        (f"{exposure}, by sDA", "sDA 200/40 of 30 %"),
        (f"{exposure}, by EN 17037", "200 lx in half of the daylight hours on 30 %"),
        (f"{simulation}, by sDA", "sDA 300/50: 55, 75 % for 1, 2 points"),
        (f"{simulation}, by EN 17037", "300 lx on 50 % for 1 point, 100 lx on 95 % too for 2"),
    )
    design = Clause(
        "L05 daylight design", "all rooms", "area, transmittance and distance of glass", "",
        "not assessed: needs workstations and the glass of all facades",
    )  # fmt: skip
    if shares is None:
        lack = _lack_of_sda(facts)
        return [Clause(clause, "all rooms", asks, "", lack) for clause, asks in asked] + [design]
    low, medium, high = shares.with_en_lx
    points = 0
    if at_most(_WELL_L06_EN[0], high):
        points = 2 if at_most(_WELL_L06_EN[1], low) else 1
    found = (
        (percent_text(shares.sda_200_40, 1), met_text(at_most(_WELL_L01, shares.sda_200_40))),
        (percent_text(medium, 1), met_text(at_most(_WELL_L01, medium))),
        (percent_text(shares.sda, 1), points_by_share(shares.sda, _WELL_L06_SDA)),
        (f"{percent_text(high, 1)}, {percent_text(low, 1)}", points_text(points)),
    )
    return [
        Clause(clause, "all rooms", asks, *one)
        for (clause, asks), one in zip(asked, found, strict=True)
    ] + [design]


def _lack_of_sda(facts: Facts) -> str:
    return NEEDS_YEAR if facts.year is None else NEEDS_ROOM


class _Shares(NamedTuple):
    """SDA 300/50 and ASE of the rooms' floor, the ASE of the room with most, sDA 200/40, and the
    shares of `PlaneYear.with_en_lx`."""

    sda: float
    ase: float
    most_ase: float
    sda_200_40: float
    with_en_lx: FloatArray


def _sda_and_ase(facts: Facts) -> _Shares | None:
    """Shares of the floor, weighted by area; None without a year or rooms."""
    planes = {} if facts.year is None else facts.year.planes
    found = [
        (facts.area_m2[plane], one.sda, one.room.ase_1000_250, one.sda_200_40, *one.with_en_lx)
        for plane, one in planes.items()
        if plane in facts.names and one.sda is not None
    ]
    if not found:
        return None
    area, *shares = np.array(found, float).T
    sda, ase, sda_200_40, *with_en_lx = np.average(shares, axis=1, weights=area)
    most_ase = float(shares[1].max())
    return _Shares(float(sda), float(ase), most_ase, float(sda_200_40), np.array(with_en_lx))


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
        "EN 17037, 5.1: method 1 asks for daylight factors that bring the target illuminance under "
        "the median diffuse illuminance outdoors of the 4,380 daylight hours of the weather file; "
        "method 2 for that illuminance in half of these hours, with the sun.",
        "View out: rays from eyes 1.2 m above the floor that leave by the room's openings, 2 "
        "degrees apart; width and distance are those that three quarters of the places reach. "
        "Landscape is what stands outside and the horizon within 4 degrees; ground is level.",
        "Vertical sky component: CIE's overcast sky without reflected light on the wall's outer "
        "face, in the mean over the openings of a side; glass of other buildings hides the sky. "
        "Probable sunlight hours are those of the weather file whose direct beam exceeds 120 W/m².",
        "Rules of countries: possible sun, by the best place in the openings of a side, from sills "
        f"0.9 m above the floor upwards, in steps of {STEP_MINUTES} minutes; TNO on the inner "
        "face of the wall, the others on the outer one.",
        "What was before: windows and sensors of this scene, looked at from the same places in the "
        "other one; the no-sky line by 12,960 directions from each sensor; gardens are planes "
        "under no roof, at the height of their sensors.",
        f"LEED's rooms are all that are found; its option 2 is the mean of two days, {days}.",
    ]
