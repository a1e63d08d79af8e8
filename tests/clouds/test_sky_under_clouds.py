"""The sum of a clear sky and clouds, in pure functions."""

import msgspec
import numpy as np
import pytest
from cloud_stage import rough_layer, slab, slab_irradiance
from clouds.model.cloud_transport import even_transmittance
from clouds.sky_under_clouds import light_under_clouds
from light_messages import clear_sky_light, light_messages

from vrut_lite.atmosphere.haze_layer import HazeLayer
from vrut_lite.atmosphere.sunlight import sunlight_at_altitude
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.spherical_harmonics import (
    evaluate_irradiance,
    horizontal_irradiance,
    irradiance_coefficients,
)
from vrut_lite.sky.sky_layer import Viewpoint

SUN = (0.6, 0.8, 0.0)
IRRADIANCE = np.array([90.0, 80.0, 70.0])
UP = (0.0, 1.0, 0.0)
ON_GROUND = Viewpoint((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)
UPPER = texel_directions(32)[..., 1] > 0.0


def clear_sky(above=(2.0, 3.0, 5.0), albedo=0.2):
    """An even sky over ground of one albedo, under a sun at 53 degrees."""
    cube = np.empty((6, 32, 32, 3))
    cube[UPPER] = above
    cube[~UPPER] = albedo * (np.array(above) + IRRADIANCE * 0.8 / np.pi)
    return light_messages(cube, SUN, IRRADIANCE)


def summed(layer, view=ON_GROUND, sky=None):
    sky = sky or clear_sky()
    return light_under_clouds((layer,), clear_sky_light(*sky), view, 32, "test")


def cube_of(light):
    return decode_float16(light.background.cube.values, light.background.radiance_scale)


def test_a_layer_of_nothing_changes_nothing():
    """A layer without extinction: the clear sky, its light and its ground, to half precision."""
    sky = clear_sky()
    light = summed(slab(extinction_per_m=1e-12), sky=sky)
    np.testing.assert_allclose(cube_of(light), sky[0].cube.values, rtol=1e-3)
    np.testing.assert_allclose(
        light.ambient.irradiance_sh_rgb.values, sky[2].irradiance_sh_rgb.values, atol=1e-3
    )
    np.testing.assert_allclose(
        light.background.ground_radiance_rgb, sky[0].ground_radiance_rgb, rtol=1e-4
    )
    assert light.key_light.irradiance_rgb == pytest.approx(tuple(IRRADIANCE))


def test_the_light_of_a_slab_is_that_on_paper():
    """Under a black sky the level ground gets what discrete ordinates say: within 5 %."""
    layer, black = slab(), light_messages(np.zeros((6, 32, 32, 3)), SUN, IRRADIANCE)
    cube = cube_of(summed(layer, sky=black))
    expected = slab_irradiance(layer, np.array(SUN))
    np.testing.assert_allclose(horizontal_irradiance(cube), expected, rtol=0.05)


def test_lamps_below_light_the_base():
    """A sky without light over lands that shine: the level gets what a slab sends back, to 7 %.

    A slab sends back of even light what it lets not pass. Without lamps there is no light at all.
    """
    layer, lamps = slab(extinction_per_m=0.02), (0.05, 0.03, 0.01)
    dark = light_messages(np.zeros((6, 32, 32, 3)), (0.0, -1.0, 0.0))
    unlit = summed(layer, sky=dark)
    assert not cube_of(unlit).any()
    lit = summed(layer, sky=(*dark[:2], msgspec.structs.replace(dark[2], lamps_rgb=lamps)))
    sent_back = 1.0 - even_transmittance(layer.optical_depth)
    found = horizontal_irradiance(cube_of(lit))
    np.testing.assert_allclose(found, np.pi * np.array(lamps) * sent_back, rtol=0.07)
    by_harmonics = evaluate_irradiance(lit.ambient.irradiance_sh_rgb.values, np.array(UP))
    np.testing.assert_allclose(by_harmonics, found, rtol=0.01)


def test_cube_harmonics_and_ground_agree():
    """Harmonics are those of the cube; ground over irradiance is the clear sky's: 1 %."""
    sky = clear_sky()
    light = summed(rough_layer(), sky=sky)
    cube, harmonics = cube_of(light), light.ambient.irradiance_sh_rgb.values
    np.testing.assert_allclose(
        harmonics, irradiance_coefficients(cube), atol=0.01 * harmonics[0, 0]
    )
    ground = np.array(light.background.ground_radiance_rgb)
    np.testing.assert_allclose(cube[~UPPER], np.broadcast_to(ground, cube[~UPPER].shape), rtol=1e-3)
    on_level = 0.8 * np.array(light.key_light.irradiance_rgb) + horizontal_irradiance(cube)
    np.testing.assert_allclose(np.pi * ground / on_level, 0.2, rtol=0.01)


def test_haze_hides_far_clouds():
    """Low in the sky: haze of depth 5 leaves an even sky where clouds had shown, to 3 %:
    air before clouds is in their shade, that in gaps is not."""
    background, sun, *others = clear_sky()
    hazy = msgspec.structs.replace(sun, haze=(HazeLayer(1000.0, (5.0, 5.0, 5.0)),))
    low = UPPER & (texel_directions(32)[..., 1] < 0.2)
    spread = []
    for key_light in (sun, hazy):
        seen = cube_of(summed(rough_layer(), sky=(background, key_light, *others)))[low]
        spread.append((seen.std(axis=0) / seen.mean(axis=0)).max())
    assert spread[0] > 0.1
    assert spread[1] < 0.03


def test_under_an_overcast_the_sun_goes_and_the_ground_darkens():
    """An opaque layer: no key light, no disc, and less than two fifths of the light."""
    sky = clear_sky()
    light = summed(slab(extinction_per_m=0.03), sky=sky)
    assert max(light.key_light.irradiance_rgb) < 1e-6
    assert max(light.background.seen_sun_irradiance_rgb) < 1e-6
    clear = sunlight_at_altitude(2000.0, 0.8) * 0.8 + np.pi * np.array([2.0, 3.0, 5.0])
    under = evaluate_irradiance(light.ambient.irradiance_sh_rgb.values, UP)
    assert np.all(under < 0.4 * clear)
    falls = np.divide(light.background.ground_radiance_rgb, sky[0].ground_radiance_rgb)
    on_ground = IRRADIANCE * 0.8 + np.pi * np.array([2.0, 3.0, 5.0])
    np.testing.assert_allclose(falls, under / on_ground, rtol=0.02)


def test_light_on_the_ground_stays_that_at_the_ground():
    """From 5 km the cube shows the tops below, and the harmonics still say the light under them."""
    layer = slab(extinction_per_m=0.03)
    low = summed(layer)
    high = summed(layer, Viewpoint((0.0, 5000.0, 0.0), (0.0, 0.0, 0.0), 0.0))
    np.testing.assert_allclose(
        evaluate_irradiance(high.ambient.irradiance_sh_rgb.values, UP),
        evaluate_irradiance(low.ambient.irradiance_sh_rgb.values, UP),
        rtol=0.03,
    )
    tops, sky = cube_of(high)[3].mean(axis=(0, 1)), cube_of(high)[2].mean(axis=(0, 1))
    np.testing.assert_allclose(sky, (2.0, 3.0, 5.0), rtol=1e-3)
    assert np.all(tops > 2.0 * np.array(low.background.ground_radiance_rgb))


def test_a_gap_and_a_bank_light_from_their_own_sides():
    """Harmonics have a direction: walls that face the brighter half of the cube get more."""
    light = summed(rough_layer())
    cube, harmonics = cube_of(light), light.ambient.irradiance_sh_rgb.values
    east, west = (evaluate_irradiance(harmonics, (x, 0.0, 0.0))[1] for x in (1.0, -1.0))
    assert (east > west) == (cube[0, :, :, 1].mean() > cube[1, :, :, 1].mean())
    assert abs(east - west) > 0.02 * (east + west)
