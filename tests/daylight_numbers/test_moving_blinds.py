"""Blinds that move: hours by schedules and by the sun, against single states and pvlib's sun."""

import numpy as np
import pandas as pd
import pvlib
import pytest
from boxes import hour
from daylight_numbers.moving_blinds import (
    PaneStates,
    StateLight,
    moving_year,
    pane_states,
    states_table,
    sun_on_panes,
)
from daylight_numbers.state_schedule import read_schedule
from daylight_numbers.year.year import solved_year, year_matrices, year_of
from daylight_numbers.year.year_light import HOURS, YearLight
from light_transport.rays.sky_nodes import GROUND_NODE
from light_years import year_like
from pane_rooms import NORMALS, PLACES, Room
from window_xml_files import diffuser, opening

from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.geometry.frames import world_from_enu
from vrut_lite.messages.glazing import GlazingFile

LIGHTS = [
    hour(0.5, key=(1.0, 1.0, 0.3), irradiance=4.0, ground=0.1),
    hour(1.0, key=(0.4, 0.5, -0.6), irradiance=2.0, ground=0.3),
    hour(0.8, key=(0.9, 0.3, 0.1), irradiance=1.0, ground=0.2),
    hour(0.3),
]


@pytest.fixture(scope="module")
def rooms():
    """The same room behind clear glass and behind a diffuser that is darker."""
    return [Room(each, 0.5) for each in (opening(0.7) + diffuser(0.1), diffuser(0.2))]


def year_of_room(room, light):
    work = room.work(PLACES, NORMALS)
    solved = solved_year(room.transport, light, bounces=room.bounces)
    return year_of(year_matrices(work, light, solved), light), StateLight(work, solved, light.hour)


def test_hours_of_two_states_are_those_of_the_years_of_either(rooms):
    """To the last digit of float32: the light of an hour does not depend on other hours' states."""
    light = year_like([12, 37, 61, 85], LIGHTS)
    (opened, clear), (closed, dark) = (year_of_room(room, light) for room in rooms)
    chosen = np.array([0, 1, 1, 0])
    found = moving_year(
        PaneStates({"pane": chosen}), light, lambda states: (clear, dark)[states["pane"]]
    )
    for name in ("total", "sun"):
        truth = np.where(chosen, getattr(closed, name), getattr(opened, name))
        np.testing.assert_allclose(getattr(found, name), truth, rtol=1e-6)
    for half in range(2):
        truth = np.where(chosen, closed.halves[half], opened.halves[half])
        np.testing.assert_allclose(found.halves[half], truth, rtol=1e-6)
    assert (opened.total[:, 1] > 1.5 * found.total[:, 1]).all()


def test_a_blind_that_stays_open_has_the_numbers_of_one_that_does_not_move(rooms):
    light = year_like([12, 37, 61, 85], LIGHTS)
    opened, clear = year_of_room(rooms[0], light)
    states = PaneStates({"pane": np.zeros(4, int), "other": np.zeros(4, int)})
    found = moving_year(states, light, lambda states: clear)
    np.testing.assert_array_equal(found.total, opened.total)


def test_sun_closes_blinds_in_the_hours_of_pvlibs_sun(rooms):
    """A pane that faces east in the open, under a sun of 80,000 lx all year at 50 degrees north:
    closed where 80,000 lx times the cosine of incidence reach 30,000, half closed from 10,000."""
    times = pd.date_range("2025-01-01T00:30", periods=8760, freq="h", tz="UTC")
    sun = pvlib.solarposition.get_solarposition(times, 50.0, 0.0)
    height, azimuth = (
        np.radians(sun[name].to_numpy()) for name in ("apparent_elevation", "azimuth")
    )
    level = np.cos(height)
    east_north_up = np.stack([level * np.sin(azimuth), level * np.cos(azimuth), np.sin(height)], 1)
    up = np.flatnonzero(height > 0.0)
    irradiance = np.full((len(up), 3), 80_000.0 / LUMENS_PER_WATT)
    sky = np.ones((len(up), GROUND_NODE + 1, 3), np.float32)
    towards = world_from_enu(east_north_up[up], 0.0)
    light = YearLight(up, sky, towards, irradiance, np.full(3, 0.2), "test")
    panes = rooms[0].bounces.panes
    blind = GlazingFile("a.xml", closed=("b.xml", "c.xml"), by="sun", sun_lx=(10_000.0, 30_000.0))
    found = pane_states(panes, {"pane": blind}, light).of["pane"]
    lux = 80_000.0 * np.maximum(east_north_up[up, 0], 0.0)
    truth = (lux >= 10_000.0).astype(int) + (lux >= 30_000.0)
    near = np.min(np.abs(lux[:, None] - [10_000.0, 30_000.0]), axis=1) < 50.0
    np.testing.assert_array_equal(found[~near], truth[~near])
    assert near.sum() < 20
    # Within 30 degrees of the normal alone.
    steep = sun_on_panes(panes, 0, light, within_deg=30.0)
    inside = east_north_up[up, 0] > np.cos(np.radians(30.0))
    np.testing.assert_allclose(steep, np.where(inside, lux, 0.0), rtol=0.01, atol=1.0)
    shares = {
        int(row[1]): row[3] for row in states_table(PaneStates({"pane": found}), {"pane": blind},
                                                    light).rows
    }  # fmt: skip
    clock = up % HOURS
    used = (clock >= 8) & (clock < 18)
    assert float(shares[2].split()[0]) == pytest.approx(
        100 * (truth[used] == 2).sum() / 3650, abs=0.2
    )
    assert sum(float(share.split()[0]) for share in shares.values()) == pytest.approx(100, abs=0.2)


def test_too_many_combinations_are_refused():
    """Each takes a whole year's work: seventeen would take minutes without a word."""
    states = PaneStates({f"pane {n}": np.arange(17) // (n + 1) for n in range(2)})
    light = year_like(np.arange(17), LIGHTS[:1] * 17)
    with pytest.raises(UserError, match="17 combinations of states occur in the year"):
        moving_year(states, light, lambda states: None)


def test_a_schedule_by_months_and_hours_is_that_of_each_hour(tmp_path):
    """Shut at noon in July alone: hours 181 x 24 + 12 to 211 x 24 + 12 of the year."""
    rows = [[0] * 24 for _ in range(12)]
    rows[6][12] = 1
    path = tmp_path / "noon.csv"
    path.write_text("# state by month and hour\n" + "\n".join(",".join(map(str, r)) for r in rows))
    found = read_schedule(path, 2)
    assert np.flatnonzero(found).tolist() == [day * 24 + 12 for day in range(181, 212)]
    path.write_text("\n".join(str(int(n == 5)) for n in range(8760)))
    assert np.flatnonzero(read_schedule(path, 2)).tolist() == [5]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("0,1\n", "has 1 rows: give 12, months of 24 hours, or 8,760 hours"),
        ("0,1\n" * 12, "line 1 of .* has 2 numbers: give 24"),
        ((",".join(["0"] * 23) + ",2\n") * 12, "line 1 of .* has '2': give a state from 0 to 1"),
        ((",".join(["0"] * 23) + ",-1\n") * 12, "has '-1': give a state"),
    ],
)
def test_schedules_that_say_no_state_are_refused(tmp_path, text, sentence):
    path = tmp_path / "blinds.csv"
    path.write_text(text)
    with pytest.raises(UserError, match=sentence):
        read_schedule(path, 2)


@pytest.mark.parametrize(
    "fields",
    [
        {"closed": ("b.xml",)},
        {"by": "sun", "sun_lx": (1.0,)},
        {"closed": ("b.xml",), "by": "sun"},
        {"closed": ("b.xml", "c.xml"), "by": "sun", "sun_lx": (2.0, 1.0)},
        {"closed": ("b.xml",), "by": "sun", "sun_lx": (-1.0,)},
        {"closed": ("b.xml",), "by": "sun", "sun_lx": (1.0,), "within_deg": 91.0},
        {"closed": ("b.xml",), "by": "schedule"},
        {"closed": ("b.xml",), "by": "schedule", "schedule": "a.csv", "sun_lx": (1.0,)},
    ],
)
def test_rules_without_their_inputs_are_refused(fields):
    with pytest.raises(ValueError, match=r"closed|schedule|sun_lx|within_deg"):
        GlazingFile("a.xml", **fields)
