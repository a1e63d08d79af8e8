"""The sun's direct light."""

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.coefficients import WAVELENGTHS_NM
from dynamic_skylight.hosek_wilkie.sky import SOLAR_DISC_RADIUS_RAD
from dynamic_skylight.sun_light import disc_irradiance, in_gamut, limb_darkening_rgb, sun_light
from dynamic_skylight.twilight import sky_of_hour
from hypothesis import given
from hypothesis import strategies as st
from long_parameters import mostly_long

from vrut_lite.geometry.colour import (
    LUMENS_PER_WATT,
    colour_table,
    luminance,
    rgb_from_spectrum,
    solar_irradiance,
)
from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD, visible_fraction


@pytest.mark.parametrize("turbidity", mostly_long([1.0, 4.5, 10.0], (4.5).__ne__))
@pytest.mark.parametrize("elevation_deg", [1.0, 5.0, 40.0, 89.0])
def test_the_irradiance_is_the_discs_radiance_summed(turbidity, elevation_deg):
    """A sum of solar_radiance over 160 000 directions must give the same, to 1e-3 or 1e-7.

    The second, in W m^-2 nm^-1, is a ten-millionth of a high sun's.
    """
    n = 400
    c = (np.arange(n) + 0.5) / n * 2 - 1
    right, up = np.meshgrid(c, c)
    inside = np.hypot(right, up) <= 1.0
    r = SOLAR_DISC_RADIUS_RAD
    gamma = np.hypot(right, up)[inside] * r
    theta = np.pi / 2 - np.radians(elevation_deg) - up[inside] * r
    sky = HosekWilkieSky(turbidity, 0.1, np.radians(elevation_deg))
    radiance = sky.solar_radiance(theta, gamma, WAVELENGTHS_NM)
    brute = radiance.sum(axis=0) * (2 * r / n) ** 2
    found = disc_irradiance(turbidity, np.radians(elevation_deg))
    np.testing.assert_allclose(found, brute, rtol=1e-3, atol=1e-7)


def test_noon_sunlight_is_bright_and_warm():
    """A clear noon's direct light is 70 to 110 klx, yellower than outside the air."""
    light = sun_light(3.0, 0.1, np.radians(60.0), 1.0).irradiance_rgb
    assert 70e3 < LUMENS_PER_WATT * luminance(light) < 110e3
    outside = rgb_from_spectrum(solar_irradiance(WAVELENGTHS_NM), WAVELENGTHS_NM)
    assert light[2] / light[0] < outside[2] / outside[0]


def test_the_error_of_ending_at_720_nm_is_as_stated():
    """The module states it: cutting loses 6e-4 of red and 8e-5 of luminance of ASTM G-173."""
    table = colour_table()
    whole = rgb_from_spectrum(table[:, 4], table[:, 0])
    cut = rgb_from_spectrum(np.where(table[:, 0] <= 720, table[:, 4], 0.0), table[:, 0])
    assert 1 - cut[0] / whole[0] == pytest.approx(5.6e-4, rel=0.05)
    assert 1 - luminance(cut) / luminance(whole) == pytest.approx(8.2e-5, rel=0.05)


@pytest.mark.parametrize("colour", ["disc", "sky_formula", "white"])
@pytest.mark.parametrize("elevation_deg", [-0.2, 0.5, 10.0, 70.0])
def test_colours_differ_in_hue_only(colour, elevation_deg):
    """All three options must have the luminance of the disc."""
    arguments = (3.0, 0.1, np.radians(elevation_deg), 0.7)
    expected = luminance(sun_light(*arguments, "disc").irradiance_rgb)
    light = sun_light(*arguments, colour)
    assert luminance(light.irradiance_rgb) == pytest.approx(float(expected), rel=1e-12)
    if colour == "white":
        assert np.ptp(light.irradiance_rgb) == 0.0
        assert len(set(light.limb_darkening_rgb)) == 1
    if colour == "sky_formula":
        sky = sky_of_hour(3.0, 0.1, np.radians(elevation_deg))
        hue = sky.radiance(np.pi / 2 - max(np.radians(elevation_deg), 0.0), 0.0)
        assert light.irradiance_rgb / light.irradiance_rgb[1] == pytest.approx(hue / hue[1])


def test_limb_polynomials_have_mean_one_and_darken_outwards():
    """Radiance = irradiance / solid angle * polynomial conserves the irradiance (KeyLightChanged).

    Blue darkens more than red (Neckel and Labs 1994).
    """
    edge, centre = [], []
    for polynomial in (*limb_darkening_rgb(), *sun_light(3.0, 0.1, 0.5, 1.0, "white")[1]):
        radius = np.sqrt((np.arange(20_000) + 0.5) / 20_000)
        values = np.polynomial.polynomial.polyval(np.sqrt(1 - radius**2), polynomial)
        assert values.mean() == pytest.approx(1.0, abs=1e-4)
        assert np.all(np.diff(values) < 0)
        centre.append(values[0])
        edge.append(values[-1])
    assert edge[2] / centre[2] < edge[1] / centre[1] < edge[0] / centre[0]


@given(
    st.floats(1, 10),
    st.floats(0, 1),
    st.floats(-np.pi / 2, np.pi / 2),
    st.sampled_from(["disc", "sky_formula", "white"]),
)
def test_light_is_finite_and_never_negative(turbidity, albedo, elevation, colour):
    """Holds at every elevation; once the disc is below the horizon the light is exactly 0."""
    visible = float(visible_fraction(elevation))
    light = sun_light(turbidity, albedo, elevation, visible, colour).irradiance_rgb
    assert np.all(np.isfinite(light))
    assert np.all(light >= 0.0)
    if elevation <= -MEAN_ANGULAR_RADIUS_RAD:
        assert not light.any()


def test_sunset_is_continuous():
    """The light fades with the disc: no step over 1 % of its value at 2 deg per 0.01 deg."""
    elevation = np.radians(np.arange(-0.5, 2.0, 0.01))
    light = np.array(
        [sun_light(3.0, 0.1, e, visible_fraction(e)).irradiance_rgb for e in elevation]
    )
    assert np.abs(np.diff(light, axis=0)).max() < 0.01 * light[-1].max()


def test_colours_outside_the_gamut_keep_their_luminance():
    """A negative blue becomes 0 and the rest is scaled back to the same Y."""
    rgb = np.array([11.4, 2.3, -0.27])
    mended = in_gamut(rgb)
    assert mended[2] == 0.0
    assert luminance(mended) == pytest.approx(float(luminance(rgb)))
    assert mended[1] / mended[0] == pytest.approx(2.3 / 11.4)
