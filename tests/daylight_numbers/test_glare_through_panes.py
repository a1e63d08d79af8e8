"""Glare through measured panes: their luminance by analysis, and clear ones beside an opening."""

import numpy as np
import pytest
from boxes import hour
from daylight_numbers.glare.eye_view import Eye, eye_view
from daylight_numbers.glare.eyes import Eyes
from daylight_numbers.glare.glare import glare_of, glare_year, vertical_of
from daylight_numbers.glare.mirrored_sun import Flats
from daylight_numbers.moving_blinds import PaneStates, StateLight, moving_glare, states_by_glare
from daylight_numbers.now import hour_at_sensors
from daylight_numbers.year.year import solved_year
from light_years import year_like
from pane_rooms import HALF, HEIGHT, Room
from window_xml_files import diffuser, opening

from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.glazing import GlazingFile

EYE = Eye(np.array([-1.0, 1.5, 0.0]), np.array([1.0, 0.0, 0.0]))
SUN = np.array([1.0, 0.3, 0.2]) / np.linalg.norm([1.0, 0.3, 0.2])


def seen(room, light):
    """The eye's view, and the light of a sensor in its place."""
    work = room.work(EYE.place_m[None], EYE.towards[None], 0.01)
    count = len(room.glass.ior)
    flats = Flats(np.empty((0, 3)), np.full(count, -1), np.zeros((count, 3)))
    view = eye_view(room.transport, room.glass, flats, EYE, light, room.bounces)
    sensor = hour_at_sensors(room.transport, room.glass, work.operator, work.sensors, light)
    return view, sensor, work, flats


def on_pane(view):
    """Which directions meet the pane, by geometry, half a pixel from its edge or more."""
    ahead = view.directions @ EYE.axes
    with np.errstate(divide="ignore", invalid="ignore"):
        at = EYE.place_m + ahead * ((HALF - EYE.place_m[0]) / ahead[:, :1])
    inside = (np.abs(at[:, 2]) < HALF - 0.05) & (at[:, 1] > 0.05) & (at[:, 1] < HEIGHT - 0.05)
    return (ahead[:, 0] > 0.0) & inside


def test_a_diffuser_has_the_luminance_that_it_passes():
    """0.6 of an even sky and ground of radiance 2, in black walls; the vertical illuminance is that
    of a sensor with other rays."""
    view, sensor, *_ = seen(Room(diffuser(0.6)), hour(2.0))
    there = on_pane(view)
    assert 0.1 < there.mean() < 0.5
    np.testing.assert_allclose(view.luminance[there], 1.2 * LUMENS_PER_WATT, rtol=0.005)
    np.testing.assert_allclose(vertical_of(view), sensor.total[0], rtol=0.01)


def test_a_diffuser_in_the_sun_shows_no_disc():
    """Its luminance is 0.6 of the sun's illuminance on it, over pi."""
    light = hour(0.0, key=SUN, irradiance=50.0)
    view, sensor, *_ = seen(Room(diffuser(0.6)), light)
    luminance = 0.6 * 50.0 * SUN[0] / np.pi * LUMENS_PER_WATT
    np.testing.assert_allclose(view.luminance[on_pane(view)], luminance, rtol=0.005)
    assert len(view.sun_directions) == 0
    np.testing.assert_allclose(vertical_of(view), sensor.total[0], rtol=0.01)


def gradient(irradiance=30.0):
    directions = texel_directions(32)
    cube = 4.0 * (1.0 + directions[..., 1] + 0.5 * directions[..., 2])
    cube = np.repeat(cube[..., None], 3, axis=-1).astype(np.float32)
    return hour(0.5, key=SUN, irradiance=irradiance, ground=0.8, cube=cube)


def test_a_clear_pane_shows_what_an_opening_shows():
    """Sky, ground, sunlit walls and the sun's disc, beside the same room without a pane."""
    light = gradient()
    clear, clear_sensor, *_ = seen(Room(opening(), 0.5, rays=1024), light)
    bare, bare_sensor, *_ = seen(Room(None, 0.5, rays=1024), light)
    np.testing.assert_allclose(clear.sun_directions, bare.sun_directions, atol=1e-6)
    np.testing.assert_allclose(clear.sun_irradiance, bare.sun_irradiance, rtol=1e-5)
    there = on_pane(clear)
    np.testing.assert_allclose(clear.luminance[there], bare.luminance[there], rtol=0.02)
    assert len(bare.sun_directions) == 1
    # Walls have the light of 20 patches here; spots of the sun have edges by rays, at pixels.
    off = (clear.luminance / bare.luminance - 1.0)[~there]
    assert abs(off.mean()) < 0.02
    assert np.mean(np.abs(off) > 0.3) < 0.02
    ours, theirs = (
        glare_of(view, sensor.total[0])
        for view, sensor in ((clear, clear_sensor), (bare, bare_sensor))
    )
    assert theirs.dgp > 0.3
    assert ours.dgp == pytest.approx(theirs.dgp, abs=0.005)


def test_the_sun_through_a_pane_has_the_light_of_its_straight_beam():
    """A peak of 0.5 beside 0.2 of scattered light: a disc of half the sun."""
    view, sensor, *_ = seen(Room(opening(0.5) + diffuser(0.2), 0.5), gradient())
    np.testing.assert_allclose(view.sun_irradiance, 15.0, rtol=1e-5)
    np.testing.assert_allclose(view.sun_directions @ EYE.axes, [SUN], atol=1e-6)
    np.testing.assert_allclose(vertical_of(view), sensor.total[0], rtol=0.03)


def test_a_year_behind_a_pane_has_the_glare_of_its_hours():
    """With the sun in view, behind the building, and hidden by clouds."""
    room = Room(opening(0.4) + diffuser(0.3), 0.5)
    lights = [
        gradient(60.0),
        hour(4.0, key=(-1.0, 0.8, 0.1), irradiance=80.0, ground=1.0),
        hour(6.0, ground=2.0),
    ]
    light = year_like([10, 35, 61], lights)
    found = [seen(room, one) for one in lights]
    single = [glare_of(view, sensor.total[0]).dgp for view, sensor, *_ in found]
    _, _, work, flats = found[0]
    solved = solved_year(room.transport, light, bounces=room.bounces)
    (year,) = glare_year(work, flats, light, solved)
    np.testing.assert_allclose(year, single, atol=0.01)
    assert single[0] > single[2] + 0.05


def test_glare_closes_blinds_as_far_as_needed():
    """In each hour the state is the first whose DGP, computed alone, is at most 0.40; the
    darkest where none is. DGP of the year is that of these states."""
    lights = [
        gradient(60.0),
        hour(4.0, key=(-1.0, 0.8, 0.1), irradiance=80.0, ground=1.0),
        hour(12.0, ground=4.0),
    ]
    light = year_like([10, 35, 61], lights)
    rooms = [Room(one, 0.5) for one in (opening(0.7), diffuser(0.35), diffuser(0.02))]
    known, alone = [], []
    for room in rooms:
        _, _, work, flats = seen(room, lights[0])
        solved = solved_year(room.transport, light, bounces=room.bounces)
        known.append(StateLight(work, solved, light.hour, Eyes(work, flats)))
        alone.append(glare_year(work, flats, light, solved)[0])
    bsdf = {"pane": GlazingFile("a.xml", closed=("b.xml", "c.xml"), by="glare")}

    def light_of(states):
        return known[states["pane"]]

    found = states_by_glare(PaneStates({}), bsdf, light, light_of)
    alone = np.array(alone)
    truth = np.where((alone <= 0.40).any(axis=0), np.argmax(alone <= 0.40, axis=0), 2)
    np.testing.assert_array_equal(found.of["pane"], truth)
    assert len(set(truth.tolist())) == 3
    (dgp,) = moving_glare(found, light, light_of)
    np.testing.assert_allclose(dgp, alone[truth, np.arange(3)], rtol=1e-6)
