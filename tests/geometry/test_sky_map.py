"""Projections of the whole sky: solid angles of pixels, and splatting that keeps energy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_parameters import mostly_long

from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.geometry.sky_map import CubeFaces, FisheyeMap, LatLongMap
from vrut_lite.geometry.sun_disc import disc_radiance, disc_samples

SUN_RAD = np.radians(0.2666)
# Limb darkening like the sun's, stronger in blue; the scale does not matter.
LIMB = ((0.4, 0.6), (0.3, 0.7, 0.1), (0.2, 1.2))
IRRADIANCE = np.array([135.0, 109.0, 80.0])
OFFSET_RAD = 0.3
MAPS = {
    "lat-long": LatLongMap(256, OFFSET_RAD),
    "lat-long, odd": LatLongMap(255, OFFSET_RAD),
    "fisheye": FisheyeMap(256, OFFSET_RAD),
    "cube": CubeFaces(128),
    "cube, odd": CubeFaces(129),
}


def sun_at(azimuth_deg, elevation_deg):
    enu = direction_from_angles(np.radians(azimuth_deg), np.radians(elevation_deg))
    return world_from_enu(enu, OFFSET_RAD)


def disc_in(sky_map, direction):
    return disc_radiance(sky_map, direction, IRRADIANCE, SUN_RAD, LIMB).astype(float)


@pytest.mark.parametrize(("name", "whole"), [("lat-long", 4), ("fisheye", 2), ("cube", 4)])
def test_solid_angles_add_up_to_the_sphere(name, whole):
    """4 pi, a fisheye's hemisphere 2 pi: exact but for the pixels that its circle cuts (1e-4)."""
    tolerance = 1e-4 if name == "fisheye" else 1e-12
    total = MAPS[name].solid_angles().sum() / np.pi
    np.testing.assert_allclose(total, whole, rtol=tolerance)


@pytest.mark.parametrize("name", ["lat-long", "fisheye"])
def test_a_pixels_direction_lies_in_its_middle(name):
    """Directions and positions are inverse to each other, away from the fisheye's rim."""
    sky_map = MAPS[name]
    directions = sky_map.directions()
    row, column = sky_map.position(directions)
    inside = directions[..., 1] > 0.02
    rows, columns = np.indices(row.shape)
    np.testing.assert_allclose(row[inside], rows[inside], atol=1e-9)
    np.testing.assert_allclose(column[inside], columns[inside], atol=1e-9)


@settings(deadline=None, max_examples=25)
@given(
    name=st.sampled_from(sorted(MAPS)),
    azimuth_deg=st.floats(0, 360),
    elevation_deg=st.floats(-0.26, 90),
)
def test_the_disc_has_its_energy_wherever_it_stands(name, azimuth_deg, elevation_deg):
    """Radiance times solid angle adds up to the irradiance, 1e-6; nothing falls on the ground."""
    sky_map = MAPS[name]
    radiance = disc_in(sky_map, sun_at(azimuth_deg, elevation_deg))
    energy = (radiance * sky_map.solid_angles()[..., None]).reshape(-1, 3).sum(axis=0)
    np.testing.assert_allclose(energy, IRRADIANCE, rtol=1e-6)
    assert (radiance >= 0).all()
    assert (radiance[sky_map.directions()[..., 1] < 0] == 0).all()


@pytest.mark.parametrize("name", MAPS)
@pytest.mark.parametrize("elevation_deg", mostly_long([10, 33.3, 60, 89], (10, 89).__contains__))
def test_the_disc_lights_level_ground_as_the_sun_does(name, elevation_deg):
    """E sin(elevation) within 2e-4, even with pixels twice as wide as the disc."""
    sky_map = MAPS[name]
    for azimuth_deg in (0, 44.9, 123.4, 200.3):
        sun = sun_at(azimuth_deg, elevation_deg)
        level = sky_map.solid_angles() * np.maximum(sky_map.directions()[..., 1], 0.0)
        lit = np.tensordot(level, disc_in(sky_map, sun), level.ndim)
        np.testing.assert_allclose(lit, IRRADIANCE * sun[1], rtol=2e-4)


def test_the_limb_is_darker_than_the_middle():
    """With a disc 6 pixels wide the limb follows the polynomials within 5 %."""
    sky_map = LatLongMap(2048)
    sun = sun_at(180.0, 30.0)
    directions, share = disc_samples(sun, SUN_RAD, LIMB)
    np.testing.assert_allclose(share.sum(axis=0), 1.0, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, rtol=1e-12)
    radiance = disc_in(sky_map, sun)
    row, column = (round(float(at)) for at in sky_map.position(sun))
    mean = IRRADIANCE / (4 * np.pi * np.sin(SUN_RAD / 2) ** 2)
    for channel, polynomial in enumerate(LIMB):
        power = np.arange(len(polynomial))
        middle = sum(polynomial) / (np.array(polynomial) * 2.0 / (power + 2.0)).sum()
        seen = radiance[row, column, channel] / mean[channel]
        np.testing.assert_allclose(seen, middle, rtol=0.05)
    assert radiance[row, column + 3, 2] < 0.7 * radiance[row, column, 2]
