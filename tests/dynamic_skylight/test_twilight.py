"""From Hosek's day to the night: continuous, finite, blue in between."""

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.sun.refraction import geometric_elevation, refraction_rad
from dynamic_skylight.twilight import (
    BLEND_APPARENT_RAD,
    BLEND_DEG,
    NIGHT_ILLUMINANCE_LX,
    horizontal_irradiance,
    sky_of_hour,
)
from dynamic_skylight.twilight_curve import illuminance_lx, ozone_tint
from exact_cube import assert_texels_agree, twin_cube
from hypothesis import example, given, settings
from hypothesis import strategies as st

from vrut_lite.geometry import spherical_harmonics
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance

ELEVATIONS = st.floats(-np.pi / 2, np.pi / 2)
TURBIDITIES, ALBEDOS = st.floats(1, 10), st.floats(0, 1)
SKY_THETA, SKY_GAMMA = (
    v.ravel() for v in np.meshgrid(np.linspace(0, np.pi / 2, 13), np.linspace(0, np.pi, 17))
)


def apparent(geometric_deg: float) -> float:
    """Apparent elevation (rad) of a geometric one in degrees."""
    geometric = np.radians(geometric_deg)
    return float(geometric + refraction_rad(geometric))


def illuminance_of(turbidity: float, albedo: float, geometric_deg: float) -> float:
    """Illuminance on level ground, lux, of the fast cube map."""
    cube = sky_of_hour(turbidity, albedo, apparent(geometric_deg)).cube_map(64)
    return LUMENS_PER_WATT * float(luminance(spherical_harmonics.horizontal_irradiance(cube)))


def test_the_curve_is_the_published_one():
    """Seidelmann 1992 p. 491: 759 lx at 0, 3.4 lx at -6, 8e-3 lx at -12, 6.4e-4 lx at -18 deg."""
    assert illuminance_lx([0.0, -6.0, -12.0, -18.0]) == pytest.approx(
        [10**2.88, 3.41, 8.06e-3, 6.39e-4], rel=0.02
    )


def test_the_curve_is_continuous_and_falls_with_the_sun():
    """Its pieces, published with steps of up to 1 %, must meet."""
    e = np.linspace(-18, 5, 230_001)
    logarithm = np.log10(illuminance_lx(e))
    slope = np.diff(logarithm) / np.diff(e)
    assert np.all(slope > 0)
    assert slope.max() < 0.6


def test_by_day_the_sky_is_hoseks_own():
    """Above the blend nothing may be added, tinted or scaled."""
    elevation = BLEND_APPARENT_RAD + 1e-6
    sky, day = sky_of_hour(3.0, 0.1, elevation), HosekWilkieSky(3.0, 0.1, elevation)
    np.testing.assert_array_equal(sky.radiance(0.6, 0.7), day.radiance(0.6, 0.7))
    np.testing.assert_array_equal(sky.cube_map(16, 0.3), day.cube_map(16, 0.3))


@settings(deadline=None, max_examples=80)
@given(TURBIDITIES, ALBEDOS, ELEVATIONS)
@example(1.0, 0.0, -np.pi / 2)
@example(10.0, 1.0, BLEND_APPARENT_RAD)
def test_every_sky_is_finite_and_lit(turbidity, albedo, elevation):
    """At no hour a NaN, a negative or a black sky."""
    sky = sky_of_hour(turbidity, albedo, elevation)
    cube = sky.cube_map(8, 1.0)
    assert np.all(np.isfinite(cube))
    assert np.all(cube >= 0.0)
    assert cube[2].max() > 0.0
    exact = sky.radiance(SKY_THETA, SKY_GAMMA)
    assert np.all(np.isfinite(exact))
    assert np.all(exact >= 0.0)


@settings(deadline=None, max_examples=60)
@given(TURBIDITIES, ALBEDOS, st.floats(-20.0, 1.5))
@example(3.0, 0.1, BLEND_DEG - 0.025)
@example(1.0, 1.0, -0.8)
@example(6.0, 0.0, -5.0)
@example(3.0, 0.1, -18.0)
def test_no_step_beyond_the_curves_own(turbidity, albedo, geometric_deg):
    """In 0.05 deg the illuminance may change by what the curve changes and 1 % more.

    Between the blend and the day the sky itself is steep: 0.05 deg of sun is worth 3 %.
    """
    before = illuminance_of(turbidity, albedo, geometric_deg)
    after = illuminance_of(turbidity, albedo, geometric_deg + 0.05)
    curve = illuminance_lx(geometric_deg + 0.05) / illuminance_lx(geometric_deg)
    allowed = max(curve, 1.03 if geometric_deg + 0.05 > BLEND_DEG else 1.0) + 0.01
    assert 0.99 < after / before < allowed


@settings(deadline=None, max_examples=60)
@given(TURBIDITIES, ALBEDOS, st.floats(-19.0, 1.5))
@example(3.0, 0.1, BLEND_DEG)
@example(1.0, 0.0, 0.0)
@example(3.0, 0.1, -0.5)
@example(3.0, 0.1, -18.0)
def test_no_direction_jumps(turbidity, albedo, geometric_deg):
    """In a millionth of a degree no radiance may change by more than a thousandth.

    This catches steps, at the blend, the horizon and the curve's joints; slopes are finite.
    """
    sky = [
        sky_of_hour(turbidity, albedo, apparent(e)).radiance(SKY_THETA, SKY_GAMMA)
        for e in (geometric_deg - 5e-7, geometric_deg + 5e-7)
    ]
    np.testing.assert_allclose(sky[0], sky[1], rtol=1e-3, atol=1e-3 * sky[0].max())


@pytest.mark.parametrize(("turbidity", "albedo"), [(1.0, 0.0), (3.0, 0.1), (10.0, 1.0)])
def test_twilight_approaches_the_published_curve(turbidity, albedo):
    """The excess of Hosek's last sky over the curve, about threefold, must fade with depth."""
    depths = (BLEND_DEG, 0.0, -2.0, -6.0, -9.0, -12.0)
    excess = [illuminance_of(turbidity, albedo, e) / float(illuminance_lx(e)) for e in depths]
    assert 2.0 < excess[0] < 4.0
    # The night's own 1e-3 lx counts from -9 deg on.
    assert np.all(np.diff(excess[:5]) < 0)
    assert excess[-1] < 1.5


def test_night_is_the_published_starlight_and_does_not_change():
    """Below -18 deg: 1e-3 lx (RCA Electro-Optics Handbook 1974) from everywhere alike."""
    night = sky_of_hour(3.0, 0.1, np.radians(-18.01))
    midnight = sky_of_hour(8.0, 0.9, np.radians(-90.0))
    assert illuminance_of(3.0, 0.1, -25.0) == pytest.approx(NIGHT_ILLUMINANCE_LX, rel=1e-3)
    np.testing.assert_array_equal(night.cube_map(8)[2], midnight.cube_map(8)[2])
    assert np.ptp(night.cube_map(8)[2]) == 0.0


def test_the_blue_hour_is_bluer_than_sunset():
    """Ozone takes red and green out of twilight (Hulburt 1953): blue's share must grow."""
    shares = []
    for geometric_deg in (BLEND_DEG, -1.0, -2.0, -4.0, -6.0):
        sky = sky_of_hour(3.0, 0.1, apparent(geometric_deg))
        rgb = horizontal_irradiance(sky.distribution, sky.mean_radiance, sky.sun_elevation_rad)
        shares.append(rgb[2] / rgb[0])
    assert np.all(np.diff(shares) > 0)
    assert shares[-1] > 2 * shares[0]


def test_the_tint_begins_and_ends_smoothly():
    """No colour by day, full colour from -6 deg, without a kink at either end."""
    assert ozone_tint(BLEND_DEG, BLEND_DEG) == pytest.approx([1, 1, 1])
    np.testing.assert_array_equal(ozone_tint(-6.0, 0.5), ozone_tint(-40.0, 0.5))
    e = np.linspace(-7, 1, 8001)
    slope = np.gradient(ozone_tint(e, BLEND_DEG), e, axis=0)
    assert np.abs(np.diff(slope, axis=0)).max() < 1e-3


@pytest.mark.parametrize("geometric_deg", [0.3, -0.5, -3.0, -10.0, -17.0])
def test_the_fast_twilight_is_the_exact_one(geometric_deg):
    """The cube map of a sun below the horizon is held to its float64 twin like the day's."""
    sky = sky_of_hour(2.0, 0.2, apparent(geometric_deg))
    cube = sky.cube_map(16, 2.0)
    above = twin_cube(sky, 16, 2.0) > 0
    assert_texels_agree(np.where(above, cube, 0.0), twin_cube(sky, 16, 2.0))


def test_the_quadrature_of_the_irradiance():
    """16 x 32 directions integrate the horizontal irradiance to 1e-3 of a fine cube map's."""
    for turbidity, elevation in ((1.0, 0.5), (3.0, 0.02), (10.0, 1.2)):
        sky = HosekWilkieSky(turbidity, 0.1, elevation)
        fine = spherical_harmonics.horizontal_irradiance(sky.cube_map(256))
        rule = horizontal_irradiance(sky.rgb_distribution, sky.rgb_mean_radiance, elevation)
        np.testing.assert_allclose(rule, fine, rtol=1e-3)


def test_the_blend_is_where_it_says():
    """The constant in apparent elevation must be the refraction of the one in geometric."""
    assert np.degrees(geometric_elevation(BLEND_APPARENT_RAD)) == pytest.approx(BLEND_DEG)


@pytest.mark.parametrize("elevation", [-1.6, 1.6, np.nan])
def test_impossible_elevations_are_refused(elevation):
    """Elevations end at nadir and zenith."""
    with pytest.raises(ValueError, match="elevation"):
        sky_of_hour(3.0, 0.1, elevation)
