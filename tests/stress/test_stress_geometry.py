"""Frames, cube maps, panoramas, harmonics, colour and encoding for any direction and value."""

from functools import partial

import numpy as np
import pytest
from stress_cases import assert_continuous, assert_finite, assert_light, assert_rising

from vrut_lite.atmosphere.air_colour import lost_and_depth, shares_of_white
from vrut_lite.atmosphere.sunlight import sunlight_at_altitude
from vrut_lite.geometry import colour, cube_map, encoding, frames, panorama
from vrut_lite.geometry import spherical_harmonics as harmonics
from vrut_lite.geometry.sky_map import CubeFaces, FisheyeMap, LatLongMap
from vrut_lite.geometry.sun_disc import disc_radiance
from vrut_lite.sky.air_reach import rung_m

TURN = 2.0 * np.pi


def test_angles_and_directions_are_one(stress):
    """Angles and directions convert back and forth, poles included; azimuth in [0, 2 pi)."""
    for count in stress.batches("direction_from_angles and back", 400_000):
        azimuth = stress.within(count, -TURN, TURN, [0.0, np.pi, -np.pi])
        elevation = stress.within(count, -np.pi / 2, np.pi / 2, [0.0])
        direction = frames.direction_from_angles(azimuth, elevation)
        assert np.abs(np.linalg.norm(direction, axis=1) - 1.0).max() < 1e-15 * 4
        turned, up = frames.angles_from_direction(direction)
        assert_light(turned)
        assert turned.max() < TURN
        assert np.abs(up - elevation).max() < 1e-15 * 4
        again = frames.direction_from_angles(turned, up)
        assert np.abs(again - direction).max() < 1e-14


def test_an_azimuth_is_less_than_a_full_turn():
    """Just west of north the azimuth is 0, not 360 degrees."""
    for west in (1e-16, 1e-17, 1e-20, 1e-300, 5e-324, 0.0):
        azimuth, _ = frames.angles_from_direction([-west, 1.0, 0.0])
        assert 0.0 <= azimuth < TURN


def test_frames_turn_and_turn_back(stress):
    """World and local axes convert back and forth for any north offset; lengths stay."""
    for count in stress.batches("world_from_enu and back", 400_000):
        direction = stress.directions(count)
        offset = float(stress.within(1, -TURN, TURN)[0])
        world = frames.world_from_enu(direction, offset)
        assert np.abs(frames.enu_from_world(world, offset) - direction).max() < 1e-15 * 4
        assert np.abs(np.linalg.norm(world, axis=1) - 1.0).max() < 1e-15 * 8


@pytest.mark.parametrize("size", [1, 2, 3, 8, 65])
def test_a_cube_map_answers_everywhere(stress, size):
    """Look-ups in any direction, edges and corners too, lie between the map's extremes."""
    values = stress.random.random((6, size, size, 3)) if size > 1 else np.ones((6, 1, 1, 3))
    for count in stress.batches("sample_cube, sample_sky", 20_000):
        direction = stress.directions(count)
        signs = stress.random.choice([-1.0, 0.0, 1.0], (count, 3))
        corners = np.where(np.abs(signs).sum(axis=1, keepdims=True) > 0, signs, [0.0, 1.0, 0.0])
        direction = np.where(stress.random.random((count, 1)) < 0.2, corners, direction)
        for look in (cube_map.sample_cube, panorama.sample_sky):
            found = look(values, direction)
            assert_light(found)
            assert found.max() <= values.max() * (1.0 + 1e-12)
            assert found.min() >= values.min() * (1.0 - 1e-12)


@pytest.mark.parametrize("size", [1, 2, 5, 32])
def test_pictures_share_light_without_loss(stress, size):
    """In each projection a direction's light is shared with weights in [0, 1] of sum 1.

    Solid angles are not negative and sum to the sphere's, or the half sphere's of a fisheye.
    """
    for sky_map, whole in (
        (LatLongMap(size), 2.0 * TURN),
        (FisheyeMap(max(size, 2)), TURN),
        (CubeFaces(size), 2.0 * TURN),
    ):
        areas = sky_map.solid_angles()
        assert_light(areas)
        rough = 0.6 if isinstance(sky_map, FisheyeMap) else 1e-12
        assert areas.sum() == pytest.approx(whole, rel=rough)
        assert np.linalg.norm(sky_map.directions(), axis=-1) == pytest.approx(1.0, abs=1e-14)
        for count in stress.batches("SkyMap.spread", 6_000):
            direction = stress.directions(count)
            if isinstance(sky_map, FisheyeMap):
                direction[:, 1] = np.abs(direction[:, 1])
            pixel, share = sky_map.spread(direction)
            assert pixel.min() >= 0
            assert pixel.max() < areas.size
            assert_finite(share)
            assert share.min() >= -1e-12
            assert share.sum(axis=1) == pytest.approx(1.0, abs=1e-12)


def test_the_disc_keeps_its_light_in_every_picture(stress):
    """For any sun, at zenith and horizon too, the picture has the sun's irradiance."""
    for _ in stress.batches("disc_radiance", 12, 12):
        for up in stress.within(12, 0.0, 1.0, [1e-9]):
            turn = float(stress.within(1, -np.pi, np.pi)[0])
            level = np.sqrt((1.0 - up) * (1.0 + up))
            sun = np.array([level * np.sin(turn), up, -level * np.cos(turn)])
            for sky_map in (LatLongMap(16), FisheyeMap(16), CubeFaces(8)):
                light = disc_radiance(sky_map, sun, [3.0, 2.0, 1.0], 0.00465, [[0.4, 0.6]] * 3)
                assert_light(light)
                total = (light * sky_map.solid_angles()[..., None]).reshape(-1, 3).sum(axis=0)
                assert total == pytest.approx([3.0, 2.0, 1.0], rel=1e-5)


def test_harmonics_are_light_from_any_side(stress):
    """Irradiance of any map at any normal is finite, not negative and smooth."""
    for count in stress.batches("evaluate_irradiance", 100_000, most=20_000):
        cube = 10.0 ** stress.within(6 * 64, -12.0, 5.0).reshape(6, 8, 8, 1)
        coefficients = harmonics.irradiance_coefficients(cube)
        assert_light(harmonics.evaluate_irradiance(coefficients, stress.directions(count)))
        assert_light(harmonics.horizontal_irradiance(cube))
        elevation = stress.within(count, -np.pi / 2, np.pi / 2, [0.0])

        def look(at, c=coefficients):
            return harmonics.evaluate_irradiance(c, frames.direction_from_angles(0.3, at))

        assert_continuous(look, elevation)


def test_halves_keep_eleven_bits(stress):
    """From a millionth of starlight to the sun's disc values are kept within 2^-11 or, far below
    the brightest, 2^-39 of that; the order of values is kept."""
    for count in stress.batches("encode_float16", 400_000, most=20_000):
        top = float(10.0 ** stress.within(1, -18.0, 12.0)[0])
        values = np.sort(top * 10.0 ** stress.within(count, -12.0, 0.0)).astype(np.float32)
        values[0] = 0.0
        half, scale = encoding.encode_float16(values)
        back = encoding.decode_float16(half, scale)
        assert_light(back)
        assert np.log2(scale) == np.round(np.log2(scale))
        error = np.abs(back.astype(float) - values)
        assert (error <= np.maximum(2.0**-11 * values, 2.0**-39 * values.max())).all()
        assert_rising(back)


@pytest.mark.parametrize("largest", [0.0, 5e-324, 1e-300, 1e-38, 1.0, 1e30])
def test_any_largest_value_has_a_scale(largest):
    """The scale is a power of two, and finite in float32 with its inverse."""
    scale = np.float32(encoding.float16_scale(largest))
    assert np.isfinite([scale, 1.0 / scale]).all()
    assert scale > 0.0


def test_colours_are_of_light(stress):
    """Spectra on 3 or 8 to 95 wavelengths, rising or falling: finite, and the same colour.

    Luminance is not negative where there are enough wavelengths.
    """
    for count in stress.batches("rgb_from_spectrum", 6000, most=60):
        wavelength = np.sort(stress.within(int(stress.random.integers(8, 60)), 360.0, 830.0))
        wavelength = np.unique(np.round(wavelength, 3))
        if wavelength.size < 8:
            continue
        spectra = 10.0 ** stress.within(count * wavelength.size, -9.0, 3.0).reshape(count, -1)
        rgb = colour.rgb_from_spectrum(spectra, wavelength)
        assert_finite(rgb)
        assert (colour.luminance(rgb) >= -1e-12 * np.abs(rgb).max()).all()
        turned = colour.rgb_from_spectrum(spectra[:, ::-1], wavelength[::-1])
        assert turned == pytest.approx(rgb, rel=1e-12, abs=1e-12 * np.abs(rgb).max())


def test_the_transfer_function_only_rises(stress):
    """sRGB's curve rises from 0 to 1, and its two pieces meet within its 8 digits."""
    for count in stress.batches("srgb_encode, solar_irradiance", 400_000):
        linear = np.sort(stress.within(count, -0.5, 1.5, [0.0, 0.0031308, 1.0]))
        encoded = colour.srgb_encode(linear)
        assert_light(encoded)
        assert encoded.max() <= 1.0
        assert_rising(encoded, 3e-8)
        assert_continuous(colour.srgb_encode, linear)
        assert_light(colour.solar_irradiance(stress.within(count, 0.0, 5000.0)))


def test_air_takes_no_more_than_all(stress):
    """For 1 - T from 0 to 1 the depth is finite, not negative, and 0 without air."""
    shares = shares_of_white(colour.SKYLIGHT_NM, colour.solar_irradiance(colour.SKYLIGHT_NM))
    for count in stress.batches("lost_and_depth", 400_000):
        depth = 10.0 ** stress.within(count, -18.0, 3.0)
        ratio = 1.0 + 3.0 * stress.random.random((count, 4))
        lost = -np.expm1(-depth[:, None] * ratio)
        taken, channels = lost_and_depth(lost, shares)
        assert_light(channels)
        assert_finite(taken)
        assert taken.max() <= 1.0
    none = lost_and_depth(np.zeros(4), shares)
    assert not np.any(none)


def test_rungs_reach(stress):
    """For any need up to light years the reach is 1 to 1.56 times as far."""
    for count in stress.batches("rung_m", 3000):
        for needed in 10.0 ** stress.within(count, -20.0, 20.0):
            reach = rung_m(float(needed))
            assert needed * (1.0 - 1e-9) <= reach <= max(1.0, 1.4143 * needed)
            assert rung_m(float(needed), reach) == reach


def test_the_sun_aloft_is_light(stress):
    """From the ground to the moon sunlight is finite, not negative and continuous."""
    for count in stress.batches("sunlight_at_altitude", 3000, most=1000):
        special = [1e-6, 10_000.0, 25_000.0, 40_000.0, 80_000.0]
        low = stress.within(count, 0.0, 90_000.0, special)
        altitude = np.where(stress.random.random(count) < 0.9, low, 4e8)
        sine = stress.within(count, -1.0, 1.0 - 2e-6, [0.0, 1e-9, -1e-9])
        assert_light(sunlight_at_altitude(altitude, sine))
        assert_continuous(lambda at, h: sunlight_at_altitude(h, at), sine, altitude)
        assert_continuous(sunlight_at_altitude, low, np.abs(sine))


def vectorised():
    """Functions of one array each, by name."""
    return {
        "frames": lambda x: frames.direction_from_angles(x, 0.5 * x),
        "srgb": colour.srgb_encode,
        "solar": colour.solar_irradiance,
        "luminance": lambda x: colour.luminance(np.stack([x, x, x], axis=-1)),
        "sun aloft": partial(sunlight_at_altitude, 1000.0),
    }


@pytest.mark.parametrize("name", vectorised())
def test_single_precision_input_loses_nothing(stress, name):
    """A float32 array gives the same bits as the same numbers in float64."""
    function = vectorised()[name]
    for count in stress.batches("float32 input", 2000):
        single = stress.within(count, -1.0, 1.0).astype(np.float32)
        np.testing.assert_array_equal(function(single), function(single.astype(float)))
