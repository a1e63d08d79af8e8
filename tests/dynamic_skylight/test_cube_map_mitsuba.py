"""Acceptance: the model and its fast cube map against Mitsuba's sunsky, an independent code."""

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from exact_cube import angles_to, world_sun
from path_tracer_here import mitsuba_or_skip

from vrut_lite.geometry.cube_map import texel_directions

mitsuba = mitsuba_or_skip()
# Mitsuba divides RGB by the integral of CIE Y; our radiance is not normalised so.
CIE_Y_NORMALISATION = 106.7502593994140625


def mitsuba_radiance(turbidity, albedo, sun_world, directions_world):
    """Radiance (n, 3) of Mitsuba's sky without its sun; its frame is east, north, up."""
    mitsuba.set_variant("scalar_rgb")
    to_enu = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    emitter = mitsuba.load_dict(
        {
            "type": "sunsky",
            "sun_direction": [float(v) for v in to_enu @ sun_world],
            "turbidity": float(turbidity),
            "albedo": float(albedo),
            "sun_scale": 0.0,
        }
    )
    interaction = mitsuba.SurfaceInteraction3f()
    interaction.time = 0.0
    values = []
    for direction in directions_world @ to_enu.T:
        # The emitter looks along -wi.
        interaction.wi = mitsuba.Vector3f(*(-float(v) for v in direction))
        values.append(list(emitter.eval(interaction)))
    return CIE_Y_NORMALISATION * np.array(values)


@pytest.mark.parametrize(
    ("turbidity", "albedo", "elevation_deg", "azimuth_deg", "size"),
    [
        (3.0, 0.1, 45.0, 0.0, 32),
        (1.0, 0.0, 2.0, 130.0, 14),
        (2.3, 0.5, 17.0, 75.0, 14),
        (5.5, 1.0, 33.0, 260.0, 14),
        (10.0, 0.3, 70.0, 310.0, 14),
        (6.0, 0.8, 88.0, 190.0, 14),
        (1.0, 0.1, 0.1, 20.0, 14),
    ],
)
def test_cube_map_against_mitsuba(turbidity, albedo, elevation_deg, azimuth_deg, size):
    """Every sky texel, exact and fast, must lie within 1e-4 of Mitsuba's sunsky emitter."""
    azimuth, elevation = np.radians(azimuth_deg), np.radians(elevation_deg)
    above = texel_directions(size)[..., 1] > 0
    directions = texel_directions(size)[above]
    sun = world_sun(azimuth, elevation)
    expected = mitsuba_radiance(turbidity, albedo, sun, directions)
    sky = HosekWilkieSky(turbidity, albedo, elevation)
    np.testing.assert_allclose(sky.radiance(*angles_to(directions, sun)), expected, rtol=1e-4)
    cube = sky.cube_map(size, azimuth)
    np.testing.assert_allclose(cube[above], expected, rtol=1e-4)
    assert not cube[~above].any()


def test_a_thousand_random_conditions_against_mitsuba():
    """Any turbidity, albedo, sun and view: Mitsuba's sunsky to its single precision.

    3e-5 of the larger of value and 1 % of the brightest. From 0.05 deg up: below, a float32
    direction tells the sun's elevation too coarsely for the model's cube root of it.
    """
    rng = np.random.default_rng(2013)
    worst = 0.0
    for _ in range(1000):
        turbidity, albedo = rng.uniform(1, 10), rng.uniform(0, 1)
        azimuth = rng.uniform(0, 2 * np.pi)
        elevation = np.radians(0.05 + 89.95 * rng.uniform(0, 1) ** 2)
        sun = world_sun(azimuth, elevation)
        directions = rng.normal(size=(8, 3))
        directions[:, 1] = np.abs(directions[:, 1]) + 1e-3
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        expected = mitsuba_radiance(turbidity, albedo, sun, directions)
        sky = HosekWilkieSky(turbidity, albedo, elevation)
        found = sky.radiance(*angles_to(directions, sun))
        scale = np.maximum(found, 1e-2 * sky.brightest)
        worst = max(worst, float(np.max(np.abs(found - expected) / scale)))
    assert worst < 3e-5
