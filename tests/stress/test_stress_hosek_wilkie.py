"""The Hosek-Wilkie sky, sun, cube maps and twilight for all turbidities, albedos and suns."""

from functools import partial

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.coefficients import WAVELENGTHS_NM
from dynamic_skylight.hosek_wilkie.sky import SOLAR_DISC_RADIUS_RAD
from dynamic_skylight.sun_light import disc_irradiance, sun_light
from dynamic_skylight.twilight import BLEND_APPARENT_RAD, sky_of_hour
from stress_cases import (
    assert_continuous,
    assert_finite,
    assert_light,
    assert_rising,
    assert_same_on_threads,
)

from vrut_lite.geometry.cube_map import texel_directions

INTEGERS = np.arange(1.0, 11.0)
RIGHT = np.pi / 2


def skies(stress, count, lowest=0.0):
    """Skies of any turbidity, albedo and solar elevation, often at the ends of the ranges."""
    turbidity = stress.within(count, 1.0, 10.0, INTEGERS)
    albedo = stress.within(count, 0.0, 1.0)
    elevation = stress.within(count, lowest, RIGHT, [max(lowest, 0.0), np.radians(5.0)])
    return zip(turbidity.tolist(), albedo.tolist(), elevation.tolist(), strict=True)


def angles(stress, count):
    """Zenith angles, below the horizon too, and angles from the sun."""
    theta = stress.within(count, 0.0, np.pi, [RIGHT])
    return theta, stress.within(count, 0.0, np.pi, [RIGHT, SOLAR_DISC_RADIUS_RAD])


def in_skies(stress, function, skies_short, each):
    """Yields each sky of a test with its angles, and counts them."""
    for inputs in stress.batches(function, skies_short * each, most=each):
        for sky in skies(stress, 1):
            yield HosekWilkieSky(*sky), *angles(stress, inputs)


def test_radiance_is_light(stress):
    """Finite and not negative everywhere; 0 below the horizon; no jump in either angle above it."""
    for sky, theta, gamma in in_skies(stress, "HosekWilkieSky.radiance", 40, 10_000):
        light = sky.radiance(theta, gamma)
        assert_light(light)
        assert not light[theta > RIGHT].any()
        above = np.minimum(theta, RIGHT - 2e-6)
        assert_continuous(sky.radiance, above, gamma)
        before = np.minimum(gamma, np.pi - 2e-6)
        assert_continuous(lambda at, t, s=sky: s.radiance(t, at), before, above)


def test_spectral_radiance_is_light(stress):
    """Finite and not negative in the model's range; 0 at both ends of it."""
    for sky, theta, gamma in in_skies(stress, "HosekWilkieSky.spectral_radiance", 40, 500):
        wavelength = stress.within(12, 280.0, 760.0, WAVELENGTHS_NM)
        light = sky.spectral_radiance(theta, gamma, wavelength)
        assert_light(light)
        assert not light[..., (wavelength <= 280.0) | (wavelength >= 760.0)].any()


def test_spectrum_has_no_jump(stress):
    """The spectrum is continuous from 280 to 760 nm."""
    for sky, _, _ in in_skies(stress, "HosekWilkieSky.spectral_radiance", 40, 500):
        wavelength = stress.within(500, 280.1, 760.0 - 1e-3, WAVELENGTHS_NM)
        assert_continuous(lambda at, s=sky: s.spectral_radiance(0.7, 0.4, at), wavelength)


def test_the_disc_is_light_inside_it_alone(stress):
    """Finite, not negative, 0 beyond 0.255 deg and below the horizon, smooth within."""
    for sky, theta, gamma in in_skies(stress, "HosekWilkieSky.solar_radiance", 40, 500):
        near = np.where(stress.random.random(gamma.size) < 0.7, gamma * 0.002, gamma)
        wavelength = stress.within(8, 320.0, 720.0, WAVELENGTHS_NM)
        light = sky.solar_radiance(theta, near, wavelength)
        assert_light(light)
        assert not light[(near > SOLAR_DISC_RADIUS_RAD) | (theta > RIGHT)].any()
        above = np.minimum(theta, RIGHT - 2e-6)
        within = np.minimum(near, SOLAR_DISC_RADIUS_RAD - 2e-6)
        disc = partial(sky.solar_radiance, wavelength_nm=wavelength)
        assert_continuous(disc, above, within)
        assert_continuous(lambda at, t, disc=disc: disc(t, at), within, above)


def test_a_sky_has_no_jump_in_what_it_is_made_of(stress):
    """Continuous in turbidity, albedo and solar elevation, from an elevation of 1e-4 up.

    At elevation 0 the model's cube root has an infinite slope.
    """
    for count in stress.batches("HosekWilkieSky", 60, most=60):
        theta, gamma = (part[None, :] for part in angles(stress, 24))
        theta = np.minimum(theta, RIGHT)
        turbidity = np.minimum(stress.within(count, 1.0, 10.0, INTEGERS), 10.0 - 2e-6)
        albedo = np.minimum(stress.within(count, 0.0, 1.0), 1.0 - 2e-6)
        elevation = np.clip(stress.within(count, 0.0, RIGHT), 1e-4, RIGHT - 2e-6)
        look = partial(seen, theta=theta, gamma=gamma)
        assert_continuous(look, turbidity, albedo, elevation)
        assert_continuous(lambda at, t, e, look=look: look(t, at, e), albedo, turbidity, elevation)
        assert_continuous(lambda at, t, a, look=look: look(t, a, at), elevation, turbidity, albedo)


def seen(turbidity, albedo, elevation, theta, gamma):
    """Radiance (n, k, 3) of n skies in k directions (1, k)."""
    made = (HosekWilkieSky(*sky) for sky in zip(turbidity, albedo, elevation, strict=True))
    return np.concatenate([sky.radiance(theta, gamma) for sky in made])


@pytest.mark.parametrize("size", [2, 3, 16, 33])
def test_cube_maps_hold_to_their_bound(stress, size):
    """float32 is within 1e-4 of the model, relative to the larger of value and 1 % of the maximum.

    Halves differ by at most 2^-11 or the smallest half, bytes by at most one.
    """
    direction = texel_directions(size)
    up = direction[..., 1]
    for _ in stress.batches("HosekWilkieSky.cube_map (texels)", 60 * 6 * size**2, 6 * size**2):
        for sky in (HosekWilkieSky(*made) for made in skies(stress, 1)):
            azimuth = float(stress.within(1, -10.0, 10.0, [0.0, np.pi, -np.pi])[0])
            cube = sky.cube_map(size, azimuth)
            assert_light(cube, str(vars(sky)))
            level = np.cos(sky.sun_elevation_rad)
            sun = np.array(
                [np.sin(azimuth) * level, np.sin(sky.sun_elevation_rad), -np.cos(azimuth) * level]
            )
            across = np.linalg.norm(np.cross(direction, sun), axis=-1)
            gamma = np.arctan2(across, direction @ sun)
            exact = sky.radiance(
                np.arctan2(np.hypot(direction[..., 0], direction[..., 2]), up), gamma
            )
            exact[up < 0.0] = 0.0
            bound = 1e-4 * np.maximum(exact, 0.01 * exact.max())
            # An odd map's middle row lies on the horizon, where rounding decides.
            sided = np.abs(up) > 1e-6
            assert (np.abs(cube - exact) <= bound)[sided].all(), str(vars(sky))
            scale = 2.0 ** (np.frexp(max(sky.brightest, 1e-30))[1] - 14)
            half = sky.cube_map_float16(size, azimuth, scale)
            assert_light(half)
            assert np.abs(half * scale - cube)[sided].max() <= cube.max() * 2.0**-10
            small = sky.cube_map_u8(size, azimuth).astype(int)
            curve = 255.0 * -np.expm1(-0.05 * cube)
            assert np.abs(small - curve)[sided].max() <= 1.01


def test_cube_maps_are_the_same_on_two_threads(stress):
    """Two threads give the same bits."""
    for _ in stress.batches("HosekWilkieSky.cube_map (texels)", 3 * 3 * 6 * 64**2, 3 * 6 * 64**2):
        for sky in (HosekWilkieSky(*made) for made in skies(stress, 1)):
            assert_same_on_threads(sky.cube_map, 64, 0.3)
            assert_same_on_threads(sky.cube_map_float16, 64, 0.3)
            assert_same_on_threads(sky.cube_map_u8, 64, 0.3)


def test_the_sun_reddens_and_dims_as_it_sets(stress):
    """Irradiance of the disc is finite, continuous and not negative in any channel.

    A higher sun is never dimmer, except by 2e-3 (measured) between the fit's pieces.
    """
    for count in stress.batches("disc_irradiance", 60):
        turbidity = float(stress.within(1, 1.0, 10.0, INTEGERS)[0])
        elevation = np.sort(stress.within(count, -RIGHT, RIGHT - 2e-6, [0.0]))

        def look(at, turbidity=turbidity):
            return np.array([disc_irradiance(turbidity, float(e)) for e in at])

        light = look(elevation)
        assert_light(light)
        assert_continuous(look, elevation, floor=1e-4)
        assert_rising(light.sum(axis=1) / light.sum(axis=1).max(), 2e-3)
        for e, colour in zip(elevation[:20], 7 * ("disc", "sky_formula", "white"), strict=False):
            assert_light(sun_light(turbidity, 0.2, float(e), 1.0, colour).irradiance_rgb)


def test_the_sky_of_any_hour_is_light(stress):
    """For suns from nadir to zenith the sky is finite, not negative, and positive at night."""
    for count in stress.batches("HourSky.radiance", 60 * 400, most=400):
        for made in skies(stress, 1, lowest=-RIGHT):
            sky = sky_of_hour(*made)
            theta, gamma = angles(stress, count)
            light = sky.radiance(np.minimum(theta, RIGHT), gamma)
            assert_light(light, str(made))
            assert_light(sky.cube_map(8), str(made))
            above = np.minimum(theta, RIGHT)
            before = np.minimum(gamma, np.pi - 2e-6)
        assert_continuous(lambda at, t, s=sky: s.radiance(t, at), before, above)


def test_the_hour_has_no_jump(stress):
    """The sky is continuous in the sun's elevation: at the blend's ends, at 0, at night."""
    marks = [0.0, BLEND_APPARENT_RAD, *np.radians([-18.0, -12.0, -7.0, -2.5, -1.5, -0.8, -13.0])]
    theta, gamma = (np.array(part)[None] for part in ([0.0, 0.7, 1.2, 1.57], [1.5, 0.9, 2.0, 0.1]))
    for count in stress.batches("sky_of_hour", 24, most=24):
        turbidity = float(stress.within(1, 1.0, 10.0, INTEGERS)[0])
        elevation = np.clip(stress.within(count, -RIGHT, RIGHT, marks), -RIGHT, RIGHT - 2e-6)
        near = stress.within(count, np.radians(-20.0), np.radians(2.0), marks)

        def look(at, turbidity=turbidity):
            skies = (sky_of_hour(turbidity, 0.2, float(e)) for e in at)
            return np.concatenate([sky.radiance(theta, gamma) for sky in skies])

        for at in (elevation, near):
            assert_finite(look(at))
            assert_continuous(look, at, floor=1e-9)
