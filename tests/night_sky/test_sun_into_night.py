"""The sun's part of the light of level ground, from high noon to the last of twilight."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import SolvedSky
from bruneton_sky.ground_light import SKYLIGHT_EXPONENT
from bruneton_sky.module import BrunetonSky
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of, spectral_atmosphere_of
from bruneton_sky.solver import order_tolerance, solve
from bruneton_sky.solver_rungs import rung_sizes
from bruneton_sky.sun_light import sun_irradiance_rgb as bruneton_sun_rgb
from dynamic_skylight.hosek_wilkie.levelled_sky import LevelledSky
from dynamic_skylight.module import DynamicSkyLight
from dynamic_skylight.twilight import BLEND_APPARENT_RAD, NIGHT_ILLUMINANCE_LX
from dynamic_skylight.twilight_curve import illuminance_lx

from vrut_lite.atmosphere.equal_haze import equal_sky
from vrut_lite.atmosphere.refraction import geometric_elevation
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance, rgb_from_spectrum
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.haze import DEFAULT_HAZE, SetHaze
from vrut_lite.messages.sky import AmbientChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.sky.clear_sun import sun_irradiance_rgb
from vrut_lite.testing.sky_on_bus import SkyOnBus

# Apparent elevations; and those where models meet.
SUNS_DEG = np.concatenate([
    np.arange(60.0, 3.0, -9.0), np.arange(3.0, -3.0, -0.5), np.arange(-3.0, -18.1, -1.5)
])  # fmt: skip
HOSEK_SUNS_DEG = (
    60.0,
    30.0,
    10.0,
    6.0,
    3.0,
    1.2,
    0.6,
    0.2,
    -0.5,
    -1.0,
    -2.0,
    -3.5,
    -5.0,
    -7.0,
    -9.0,
    -12.0,
    -15.0,
    -17.5,
)
STEPS = (0.92, 0.0, -0.25, -0.83, -2.5, -7.0, -12.0)


def sky_of(kind):
    sky = SkyOnBus(kind)
    sky.want(KeyLightChanged, AmbientChanged)
    return sky


def lux(sky, degrees):
    """Of sun and sky on level ground."""
    sky.sun(float(degrees))
    key, ambient = sky.kernel.last(KeyLightChanged), sky.kernel.last(AmbientChanged)
    light = evaluate_irradiance(ambient.irradiance_sh_rgb.values, (0.0, 1.0, 0.0))
    light = light + np.array(key.irradiance_rgb) * max(key.direction[1], 0.0)
    return float(luminance(light)) * LUMENS_PER_WATT


@pytest.fixture(scope="module", params=[DynamicSkyLight, BrunetonSky], ids=["hosek", "bruneton"])
def sky(request):
    return sky_of(request.param)


def test_the_suns_light_falls_with_it_and_has_no_step(sky):
    """Noon to night: each sun gives less than a higher one; within a minute of arc at every place
    where models, sun and night meet, a fiftieth less at most, or as the curve of twilight falls.
    """
    night = NIGHT_ILLUMINANCE_LX if sky.name == "dynamic_skylight" else 0.0
    light = [lux(sky, e) for e in SUNS_DEG]
    assert (np.diff(light) < 0.0).all()
    assert light[-1] - night < 1e-3
    for degrees in STEPS:
        above, below = (lux(sky, degrees + d) for d in (0.008, -0.008))
        assert 0.0 <= np.log(above / below) < 0.03


def hosek_lux(apparent_rad):
    """Of the model's sky of equal haze, summed over the hemisphere directly."""
    turbidity, level = equal_sky(DEFAULT_HAZE.optical_depth_550, apparent_rad)
    sky = LevelledSky(turbidity, 0.1, apparent_rad, level)
    x, w = np.polynomial.legendre.leggauss(48)
    cos_theta, w = 0.5 * (x[:, None] + 1.0), 0.5 * w[:, None]
    azimuth = (np.arange(96) + 0.5) * np.pi / 96
    sine = np.sqrt(1.0 - cos_theta**2)
    cos_gamma = cos_theta * np.sin(apparent_rad) + sine * np.cos(apparent_rad) * np.cos(azimuth)
    theta = np.broadcast_to(np.arccos(cos_theta), cos_gamma.shape)
    seen = luminance(sky.radiance(theta, np.arccos(np.clip(cos_gamma, -1.0, 1.0))))
    return float((seen * cos_theta * w).mean(axis=1).sum() * 2.0 * np.pi) * LUMENS_PER_WATT


def hosek_reference(degrees):
    """By day the model and the sun behind the air; then the published curve, with the model's last
    excess over it fading evenly in its logarithm to -7 deg."""
    apparent = float(np.radians(degrees))
    geometric = float(np.degrees(geometric_elevation(apparent)))
    direct = float(luminance(sun_irradiance_rgb(DEFAULT_HAZE, apparent))) * LUMENS_PER_WATT
    if apparent >= BLEND_APPARENT_RAD:
        return hosek_lux(apparent) + direct * np.sin(apparent)
    rest = illuminance_lx(-18.0)
    excess = hosek_lux(BLEND_APPARENT_RAD) / float(illuminance_lx(0.5) - rest)
    share = max((geometric + 7.0) / 7.5, 0.0)
    return float(illuminance_lx(geometric) - rest) * excess**share


@pytest.mark.parametrize("degrees", HOSEK_SUNS_DEG)
def test_hosek_and_wilkies_light_is_its_reference_curve(degrees):
    sky = sky_of(DynamicSkyLight)
    night = NIGHT_ILLUMINANCE_LX * min(max(0.5 - degrees, 0.0), 1.0)
    assert lux(sky, degrees) - night == pytest.approx(hosek_reference(degrees), rel=0.01)


def _finer(air):
    sizes = replace(
        rung_sizes(air, "finest"), altitude=40, mu_s=128, direction_mu=32, direction_azimuth=16,
        steps=256, node_bins=128, higher_bins=36,
    )  # fmt: skip
    field = solve(air, sizes=sizes, all_orders=True, tolerance=order_tolerance(air) / 4.0)
    seen = {"steps": 384, "single_bins": 192, "multiple_bins": 96}
    return replace(field, sizes=replace(sizes, **seen, irradiance_mu=64, irradiance_azimuth=32))


@pytest.mark.long
@pytest.mark.parametrize("depth", [DEFAULT_HAZE.optical_depth_550, 0.03])
def test_brunetons_light_is_that_of_a_finer_solution(depth):
    """To 1 % until the sun is 18 deg down, where the night is twenty times it."""
    haze = SetHaze(optical_depth_550=depth)
    sky, air = sky_of(BrunetonSky), atmosphere_of(BrunetonSkySettings(), haze=haze)
    sky.kernel.inject(haze)
    suns = np.array([
        60.0, 30.0, 20.0, 10.0, 6.0, 3.0, 1.0, 0.0, -1.0, -2.0, -2.5, -3.0, -3.5, -4.0, -5.0, -6.0,
        -7.0, -8.0, -9.0, -10.0, -11.0, -12.0, -13.0, -14.0, -15.0, -16.0, -17.0, -17.5, -18.0,
    ])  # fmt: skip
    mu = np.sin(np.radians(suns))
    _, spectral = SolvedSky(field=_finer(air)).irradiance(0.0, mu)
    exact = rgb_from_spectrum(spectral, air.wavelength_nm, SKYLIGHT_EXPONENT)
    many = spectral_atmosphere_of(BrunetonSkySettings(), haze=haze)
    direct = [bruneton_sun_rgb(many, 0.0, down, 1.0) * max(down, 0.0) for down in mu]
    expected = luminance(exact + np.array(direct)) * LUMENS_PER_WATT
    error = np.array([lux(sky, degrees) for degrees in suns]) / expected - 1.0
    assert np.abs(error).max() < 0.01
