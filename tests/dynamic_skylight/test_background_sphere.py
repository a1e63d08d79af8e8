"""Sky above, ground below."""

import numpy as np
import pytest
from dynamic_skylight.background import fill_ground
from dynamic_skylight.daylight import Daylight
from hypothesis import example, given
from hypothesis import strategies as st

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance, horizontal_irradiance
from vrut_lite.sky.visible_disc import visible_fraction


def daylight(turbidity=3.0, albedo=0.1, elevation=0.7, azimuth=1.0, colour="disc") -> Daylight:
    """The light of an hour, with as much of the disc up as there is."""
    return Daylight(
        turbidity, albedo, colour, elevation, azimuth, float(visible_fraction(elevation))
    )


@pytest.mark.parametrize("size", [16, 31])
def test_the_ground_is_below_and_the_sky_above(size):
    """Texels that look up carry sky; all others, the level row of odd sizes too, the ground."""
    light = daylight()
    cube = light.background(size)
    up = texel_directions(size)[..., 1] > 0
    assert cube.shape == (6, size, size, 3)
    assert cube.dtype == np.float32
    np.testing.assert_array_equal(cube[~up], np.broadcast_to(cube[3, 0, 0], cube[~up].shape))
    np.testing.assert_array_equal(cube[up], light.sky.cube_map(size, 1.0)[up])


def test_the_ground_reflects_sun_and_sky():
    """Lambert: L = albedo / pi (E_sky + E_sun sin(elevation)), E_sky from a fine map to 1e-3."""
    for albedo in (0.0, 0.3, 1.0):
        light = daylight(albedo=albedo, elevation=0.4)
        sky = horizontal_irradiance(light.sky.cube_map(256))
        total = sky + light.sun.irradiance_rgb * np.sin(0.4)
        np.testing.assert_allclose(light.ground_rgb, albedo / np.pi * total, rtol=1e-3)


def test_the_ambient_light_is_that_of_the_sphere():
    """Harmonics on level ground give the sky's irradiance, from below the ground's, pi L."""
    light = daylight(albedo=0.5)
    coefficients = light.ambient()
    up, down = evaluate_irradiance(coefficients, [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    # Bands 0 to 4 carry the irradiance of a clear sky within 2 %.
    np.testing.assert_allclose(up, horizontal_irradiance(light.background(64)), rtol=0.02)
    np.testing.assert_allclose(down, np.pi * light.ground_rgb, rtol=0.03)


def test_the_azimuth_turns_the_sky_only():
    """Turned by a right angle, the east face must show what the north face did."""
    north, east = daylight(azimuth=0.0).background(32), daylight(azimuth=np.pi / 2).background(32)
    np.testing.assert_allclose(east[0], north[5], rtol=1e-4)


@given(
    st.floats(1, 10),
    st.floats(0, 1),
    st.floats(-np.pi / 2, np.pi / 2),
    st.floats(-np.pi, np.pi),
    st.sampled_from(["disc", "sky_formula", "white"]),
)
@example(1.0, 1.0, 0.0, 0.0, "disc")
@example(10.0, 0.0, -np.pi / 2, 0.0, "sky_formula")
def test_every_sphere_is_finite_and_not_negative(turbidity, albedo, elevation, azimuth, colour):
    """Holds for every elevation of the sun, turbidity and albedo."""
    light = daylight(turbidity, albedo, elevation, azimuth, colour)
    for values in (light.background(8), light.ambient()):
        assert np.all(np.isfinite(values))
    assert light.background(8).min() >= 0.0


@given(st.floats(1, 10), st.floats(0, 1), st.floats(-0.4, np.pi / 2 - 3e-6))
@example(3.0, 1.0, 0.0)
def test_the_ground_does_not_jump(turbidity, albedo, elevation):
    """A ten-thousandth of a degree may not change the ground by more than 1 %."""
    before = daylight(turbidity, albedo, elevation).ground_rgb
    after = daylight(turbidity, albedo, elevation + np.radians(1e-4)).ground_rgb
    np.testing.assert_allclose(after, before, rtol=1e-2, atol=1e-12)


def test_fill_ground_leaves_the_sky_alone():
    """Only what does not look up is overwritten."""
    cube = np.ones((6, 8, 8, 3), np.float32)
    fill_ground(cube, np.array([2.0, 3.0, 4.0]))
    up = texel_directions(8)[..., 1] > 0
    assert np.all(cube[up] == 1.0)
    np.testing.assert_array_equal(cube[~up], np.broadcast_to([2, 3, 4], cube[~up].shape))
