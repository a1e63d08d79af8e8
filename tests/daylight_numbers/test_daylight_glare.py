"""Glare: the view and the sun's images against analytic cases."""

import numpy as np
import pytest
from boxes import box, floor, hour, quads
from daylight_numbers.glare.eye_view import Eye, eye_view
from daylight_numbers.glare.glare import en_level, glare_of, glare_year, position_index, vertical_of
from daylight_numbers.glare.mirrored_sun import Flats
from daylight_numbers.glazing.glass import no_glass
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.now import hour_at_sensors
from daylight_numbers.work import DaylightWork
from daylight_numbers.year.year import solved_year
from daylight_numbers.year.year_light import HOURS, YearLight
from light_transport.rays.sky_nodes import GROUND_NODE, node_radiances
from light_transport.transport import SceneTransport

EAST = Eye(np.array([0.0, 1.2, 0.0]), np.array([1.0, 0.0, 0.0]))


def test_position_index_is_one_ahead_and_grows_outwards():
    """45 degrees up by Guth's formula, and as far down by Iwata's: 1 + 1.2 tan 45 degrees."""
    half = np.sqrt(0.5)
    found = position_index(np.array([[0, 0, 1.0], [0, half, half], [0, -half, half]]))
    np.testing.assert_allclose(found, [1.0, 7.06, 2.2], rtol=1e-3)


def yard(*more):
    """A floor with a wall in the east, or more, and an eye that looks east."""
    surfaces, layout = quads(floor(-3, 3, -3, 3), *more)
    transport = SceneTransport(surfaces, layout)
    transport.add_rays(256)
    glass = no_glass(len(surfaces.part))
    eyes = free_sensors(EAST.place_m[None], EAST.towards[None], "eye")
    return DaylightWork(transport, glass, eyes, operator_of(transport, glass, eyes, 0.01))


def no_mirrors(work):
    count = len(work.glass.ior)
    return Flats(np.empty((0, 3)), np.full(count, -1), np.zeros((count, 3)))


@pytest.fixture(scope="module")
def walled():
    return yard(*box((2, 0, -1), (2.5, 2, 1)))


def test_what_an_eye_sees_is_its_vertical_illuminance(walled):
    """Two ways: pixels of a view, and rays of the sensor."""
    light = hour(5.0, key=(1.0, 1.5, 0.3), irradiance=8.0, ground=1.0)
    view = eye_view(walled.transport, walled.glass, no_mirrors(walled), EAST, light)
    sensor = hour_at_sensors(walled.transport, walled.glass, walled.operator, walled.sensors, light)
    assert len(view.sun_directions) == 1
    np.testing.assert_allclose(vertical_of(view), sensor.total[0], rtol=0.03)


def test_a_mirror_shows_the_sun_behind_the_eye(walled):
    """The box's west side mirrors half: the sun in the west is seen in it, at half its light."""
    flats = no_mirrors(walled)
    west = np.einsum("fi,i->f", walled.transport.receivers.geometry.faces, [-1.0, 0, 0]) > 0.99
    flats.plane_of[west], flats.f0[west] = 0, 0.5
    flats = flats._replace(normal=np.array([[-1.0, 0.0, 0.0]]))
    sun = np.array([-1.0, 0.2, 0.0]) / np.hypot(1.0, 0.2)
    light = hour(0.0, key=tuple(sun), irradiance=8.0)
    view = eye_view(walled.transport, walled.glass, flats, EAST, light)
    np.testing.assert_allclose(view.sun_directions @ EAST.axes, [sun * [-1, 1, 1]], atol=1e-6)
    np.testing.assert_allclose(view.sun_irradiance, 4.0, rtol=0.01)


def test_a_year_has_the_glare_of_its_hours(walled):
    """The sun in view, behind the eye so that the wall glares, and hidden; EN 17037 counts such
    hours of 3,650."""
    lights = [
        hour(5.0, key=(1.0, 1.5, 0.3), irradiance=80.0),
        hour(1.0, key=(-1.0, 0.8, 0.1), irradiance=80.0),
        hour(5.0),
    ]
    sky = [node_radiances(one.sky, one.ground_radiance_rgb)[: GROUND_NODE + 1] for one in lights]
    light = YearLight(
        np.array([12, HOURS + 14, 2 * HOURS + 12]),
        np.array(sky, np.float32),
        np.array([one.key_direction for one in lights], float),
        np.array([one.key_irradiance_rgb for one in lights], float),
        np.zeros(3),
        "test",
    )
    light.sun_direction[:] /= np.linalg.norm(light.sun_direction, axis=1, keepdims=True)
    flats = no_mirrors(walled)
    found = glare_year(walled, flats, light, solved_year(walled.transport, light))
    for n, one in enumerate(lights):
        view = eye_view(walled.transport, walled.glass, flats, EAST, one)
        assert found[0, n] == pytest.approx(glare_of(view, vertical_of(view)).dgp, abs=0.02)
    level, shares = en_level(np.array([0.5, 0.3, 0.3]), light)
    assert level == "high"
    np.testing.assert_allclose(shares, 1.0 / 3650)
