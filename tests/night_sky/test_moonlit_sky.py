"""The moonlit sky of the solved atmosphere, against a published model and spectrum by spectrum."""

import numpy as np
import pytest
from bruneton_sky import solve
from bruneton_sky.presets import earth_spectral
from bruneton_sky.raised_ground import raise_ground
from night_sky.data_files import table
from night_sky.moon_light import Phase, albedo_at, irradiance_rgb, sun_rgb

from vrut_lite.atmosphere.aerosols import type_optics
from vrut_lite.geometry.colour import (
    LUMENS_PER_WATT,
    SKYLIGHT_NM,
    luminance,
    rgb_from_spectrum,
)

pytestmark = pytest.mark.long
FULL = Phase(np.radians(7.0), np.radians(-7.0))
MOON_ZENITH_DEG = 35.0
# Zenith angle and azimuth from the moon, deg.
VIEWS = np.array([(z, a) for z in (10.0, 30.0, 50.0, 65.0) for a in (45.0, 90.0, 135.0, 180.0)])


@pytest.fixture(scope="module")
def sky():
    return solve(earth_spectral(SKYLIGHT_NM))


def cosines():
    z, a = np.radians(VIEWS.T)
    moon = np.radians(MOON_ZENITH_DEG)
    nu = np.cos(z) * np.cos(moon) + np.sin(z) * np.sin(moon) * np.cos(a)
    return np.cos(z), np.full(z.shape, np.cos(moon)), nu


def test_it_is_as_bright_as_krisciunas_and_schaefer_say(sky):
    """Their model (1991) takes all extinction for scattering, with more haze than this air has:
    it is the brighter one, above all near the moon.
    """
    mu, mu_moon, nu = cosines()
    share = irradiance_rgb(FULL) / sun_rgb()
    ours = luminance(sky.radiance_rgb(0.0, mu, mu_moon, nu) * share) * LUMENS_PER_WATT
    depth = -np.log(sky.radiance_to_point(0.0, 1.0, 0.6, 0.6, 2e5)[1])
    extinction = 1.086 * float(np.interp(550.0, SKYLIGHT_NM[::-1], depth[::-1]))
    rho = np.degrees(np.arccos(nu))
    scatter = 10.0**5.36 * (1.06 + nu**2) + 10.0 ** (6.15 - rho / 40.0)
    magnitude = 3.84 + 0.026 * 7.0 + 4e-9 * 7.0**4
    masses = [(1.0 - 0.96 * (1.0 - m**2)) ** -0.5 for m in (mu_moon, mu)]
    nanolamberts = scatter * 10.0 ** (-0.4 * (magnitude + extinction * masses[0]))
    theirs = 3.183e-6 * nanolamberts * (1.0 - 10.0 ** (-0.4 * extinction * masses[1]))
    ratio = ours / theirs
    assert 0.65 < ratio.mean() < 0.95
    assert 0.5 < ratio.min() < ratio.max() < 1.15


def at_opposition(wavelength_nm):
    """The moon's albedo at the phase 0 over that at 1.55 deg, by ROLO's formula."""
    bands, g = table("rolo_disk_albedo.csv"), 1.55
    rise = bands[:, 8] * (1.0 - np.exp(-g / 4.06)) + bands[:, 9] * (1.0 - np.exp(-g / 12.88))
    wave = np.cos(-30.59 / 16.75) - np.cos((g - 30.59) / 16.75)
    slope = bands[:, 2:5] @ np.radians(g) ** np.arange(1, 4)
    bright = np.exp(rise + bands[:, 10] * wave - slope)
    return np.interp(wavelength_nm, bands[:, 0], bright)


def test_it_is_as_bright_as_jones_and_others_say():
    """Full moon, 45 deg high, seen in the zenith of Cerro Paranal (2635 m, aerosol 0.045): ESO's
    SkyCalc 1.4.3, Noll and others' sky (2012) with Jones and others' moonlight (2013), gives these
    magnitudes per square arc second with the moon and without; the moon's light is good to 20 %
    there. It is evaluated at the phase 0, where ROLO's table ends at 1.55 deg.
    """
    # Cousins I and R, Johnson V and B, by their middles; zero points of Bessell 1998.
    nm = 798.0, 641.0, 545.0, 438.0
    zero = np.array([1.13e-11, 2.18e-11, 3.63e-11, 6.32e-11])
    full, new = np.array([17.95, 18.00, 18.01, 18.20]), np.array([19.74, 21.06, 21.83, 22.78])
    theirs = zero * (10.0 ** (-0.4 * full) - 10.0 ** (-0.4 * new)) * np.degrees(3600.0) ** 2
    air = earth_spectral(nm).with_optics(type_optics("continental-clean"))
    air = raise_ground(air, 2635.0).with_aerosol(0.045, 1.38)
    mu = np.cos(np.radians(45.0))
    phase = Phase(np.radians(1.55), np.radians(-1.55))
    share = albedo_at(phase, np.array(nm)) * at_opposition(nm) * 6.4177e-5 / np.pi
    ratio = solve(air).radiance(0.0, 1.0, mu, mu) * share / theirs
    np.testing.assert_allclose(ratio, 1.0, atol=0.2)


def test_one_number_a_channel_is_as_good_as_all_wavelengths(sky):
    """Moonlight over sunlight, applied to the sky's colour, is within 2 % of doing it by light."""
    mu, mu_moon, nu = cosines()
    scale = irradiance_rgb(FULL) / sun_rgb()
    by_channel = sky.radiance_rgb(0.0, mu, mu_moon, nu) * scale
    spectral = sky.radiance(0.0, mu, mu_moon, nu) * albedo_at(FULL, np.array(SKYLIGHT_NM))
    exact = rgb_from_spectrum(spectral, SKYLIGHT_NM)
    level = (luminance(by_channel) / luminance(exact)).mean()
    np.testing.assert_allclose(by_channel, exact * level, rtol=0.03)
    # 6.4177e-5 sr of disc over pi, at the mean distance and 1 au.
    np.testing.assert_allclose(level, 6.4177e-5 / np.pi, rtol=0.02)
