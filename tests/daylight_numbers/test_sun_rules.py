"""Hours of sun by days and by rules of countries, against pvlib's sun and geometry by hand."""

from datetime import date

import numpy as np
import pandas as pd
import pytest
from boxes import floor
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.rooms import SIDES, DaylitRoom, Opening, RoomBox
from daylight_numbers.standards.sun_days import sun_by_day, sun_steps
from daylight_numbers.standards.sun_rules import RULES, above_sill, rule_clauses, rules_of_room
from standards_scenes import OUT, SOUTH, profile_deg, pvlib_hours, work_in

from vrut_lite.messages.place import SetPlace

BEIJING = SetPlace(latitude_deg=39.9, longitude_deg=116.4)
HALF_STEP_H = 0.2


@pytest.mark.parametrize("day", ["2025-01-20", "2025-06-21"])
def test_solar_time_and_hours_are_those_of_pvlibs_sun(day):
    """In the open from 8 to 16 h true solar time; Beijing's clocks are 14 minutes ahead of it."""
    when = date.fromisoformat(day)
    steps = sun_steps(BEIJING, 8.0, when, when)
    counted = steps.some((steps.solar_time_h >= 8) & (steps.solar_time_h <= 16))
    found = counted.hours(np.ones((1, len(counted.day)), bool))[0, 0]
    truth = pvlib_hours(
        BEIJING, 8, day, lambda height, turn, solar: (height > 0) & (solar >= 8) & (solar <= 16)
    )
    assert found == pytest.approx(truth, abs=HALF_STEP_H)


def test_days_of_a_range_are_counted_each():
    """On open ground a level sensor has the length of each day, by pvlib."""
    work = work_in(floor(-5, 5, -5, 5, -1.0))
    place = SetPlace(latitude_deg=51.5, longitude_deg=0.0)
    steps = sun_steps(place, 0.0, date(2026, 2, 8), date(2026, 2, 10))
    found = sun_by_day(work, free_sensors([[0, 0.5, 0]], [[0, 1.0, 0]], "lawn"), steps)
    truth = [
        pvlib_hours(place, 0, f"2026-02-{day:02d}", lambda height, turn, solar: height > 0)
        for day in (8, 9, 10)
    ]
    assert found.shape == (1, 3)
    np.testing.assert_allclose(found[0], truth, atol=HALF_STEP_H)


def south_room(sill_m=1.5):
    opening = Opening(SOUTH, np.array([[0.0, sill_m, 0.0]]), OUT[SOUTH], 1.0)
    return DaylitRoom(RoomBox(np.array([-2.0, 0, -4]), np.array([2.0, 3, 0])), (opening,))


def overhang(depth_m, above_m):
    """A level plate over the window at the origin, endless along the wall."""
    return floor(-500, 500, 0, depth_m, 1.5 + above_m)


@pytest.mark.parametrize("obstruction", ["none", "overhang", "wall"])
def test_windows_have_the_hours_of_the_suns_profile_angle(obstruction):
    """An endless overhang 1 m deep and 0.5 m above hides profile angles above 26.6 degrees, an
    endless wall as far as high those below 20: tan p = tan height / cos(azimuth - south)."""
    beside = {
        "none": [],
        "overhang": [overhang(1.0, 0.5)],
        "wall": [[[500, 0, 30], [-500, 0, 30], [-500, 1.5 + 30 * np.tan(np.radians(20)), 30],
                  [500, 1.5 + 30 * np.tan(np.radians(20)), 30]]],
    }[obstruction]  # fmt: skip
    work = work_in(floor(-5, 5, -5, 5, -1.0), *beside)
    place = SetPlace(latitude_deg=51.0, longitude_deg=0.0)
    found = {one.rule.name: one for one in rules_of_room(work, south_room(), place, 0.0)}
    assert set(found) == {rule.name for rule in RULES}

    def counts(least, band):
        def is_sunny(height, turn, solar):
            ahead, profile = -np.cos(turn), profile_deg(height, turn)
            free = {
                "none": True,
                "overhang": profile < np.degrees(np.arctan(0.5)),
                "wall": profile > 20.0,
            }[obstruction]
            return (height > least) & (ahead > 0) & free & (solar >= band[0]) & (solar <= band[1])

        return is_sunny

    for name, day in (
        ("GB 50180 the same, small; IV, large", "2025-01-20"),
        ("GB 50180 zones V, VI; IV, small", "2025-12-21"),
        ("DIN 5034-1, winter", "2025-01-17"),
        ("DIN 5034-1, equinox", "2025-03-21"),
    ):
        rule = found[name].rule
        truth = pvlib_hours(place, 0, day, counts(rule.least_elevation_deg, rule.solar_time_h))
        assert found[name].hours == pytest.approx(truth, abs=HALF_STEP_H), name
    days = pd.date_range("2025-02-19", "2025-10-21", freq="6D")
    for name, least in (("TNO, light", 0.0), ("The Hague", 10.0)):
        truth = min(
            pvlib_hours(place, 0, f"{day:%Y-%m-%d}", counts(least, (0, 24))) for day in days
        )
        assert found[name].hours == pytest.approx(truth, abs=HALF_STEP_H), name


def test_a_rule_is_met_by_its_hours_and_says_which_day_has_least():
    work = work_in(floor(-5, 5, -5, 5, -1.0))
    place = SetPlace(latitude_deg=51.0, longitude_deg=0.0)
    found = rules_of_room(work, south_room(), place, 0.0)
    rows = {row.clause: row for row in rule_clauses("room 1", found)}
    light = rows["TNO, light"]
    assert light.asks == "2 h each day from 19 February to 21 October"
    assert rows["The Hague"].asks == f"{light.asks}, sun above 10°"
    assert light.subject == f"room 1, {SIDES[SOUTH]}"
    assert light.verdict == "meets"
    rule = next(one for one in found if one.rule.name == "TNO, light")
    short = rule._replace(hours=1.9)
    assert rule_clauses("room 1", [short])[0].verdict == "fails"


def test_a_sill_is_looked_for_above_the_floor():
    """Doors count from 0.9 m upwards; a strip below is taken as it is."""
    room = south_room()
    door = room.openings[0]._replace(places_m=np.array([[0.0, 0.2, 0.0], [0.0, 1.2, 0.0]]))
    np.testing.assert_array_equal(above_sill(door, room).places_m[:, 1], [1.2])
    low = door._replace(places_m=door.places_m[:1])
    assert len(above_sill(low, room).places_m) == 1
