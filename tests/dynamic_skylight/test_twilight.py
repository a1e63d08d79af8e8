"""From Hosek's day to the night: continuous, finite, blue in between."""

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.twilight import (
    BLEND_APPARENT_RAD,
    NIGHT_ILLUMINANCE_LX,
    ON_CURVE_DEG,
    HourSky,
    sky_of_hour,
)
from dynamic_skylight.twilight_blend import (
    BLEND_DEG,
    BLEND_ENDS_DEG,
    model_on_map,
)
from dynamic_skylight.twilight_curve import illuminance_lx
from dynamic_skylight.twilight_table import luminous_irradiance
from exact_cube import assert_texels_agree, twin_cube
from hypothesis import example, given
from hypothesis import strategies as st

from vrut_lite.atmosphere.refraction import geometric_elevation, refraction_of_true_rad
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
    return float(geometric + refraction_of_true_rad(geometric))


def illuminance_of(turbidity: float, albedo: float, geometric_deg: float) -> float:
    """Illuminance on level ground, lux, of the fast cube map."""
    cube = sky_of_hour(turbidity, albedo, apparent(geometric_deg)).cube_map(64)
    return LUMENS_PER_WATT * float(luminance(spherical_harmonics.horizontal_irradiance(cube)))


def test_the_curve_is_the_published_one():
    """Seidelmann 1992 p. 491: 759 lx at 0, 3.4 at -6, 8e-3 at -12, 6.4e-4 at -18 deg; and by day.

    The American Meteorological Society's glossary: 585 to 410 lx at sunset, 3.5 to 2 lx at -6 deg.
    """
    assert illuminance_lx([0.0, -6.0, -12.0, -18.0]) == pytest.approx(
        [10**2.88, 3.41, 8.06e-3, 6.39e-4], rel=0.02
    )
    assert illuminance_lx(0.0) == pytest.approx(10**2.88)
    x = 1 / 9
    day = 3.05 + 13.28 * x - 45.98 * x**2 + 64.33 * x**3
    assert illuminance_lx(10.0) == pytest.approx(10**day, rel=0.01)
    assert 410 < illuminance_lx(-50 / 60) < 585


def test_the_curve_is_continuous_and_falls_with_the_sun():
    """Its pieces, published with steps of up to 1 %, must meet."""
    e = np.linspace(-18, 20, 380_001)
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


@given(TURBIDITIES, ALBEDOS, ELEVATIONS)
@example(1.0, 0.0, -np.pi / 2)
@example(10.0, 1.0, BLEND_APPARENT_RAD)
def test_every_sky_is_finite_and_lit(turbidity, albedo, elevation):
    """No hour gives a NaN, a negative value or a black sky."""
    sky = sky_of_hour(turbidity, albedo, elevation)
    cube = sky.cube_map(8, 1.0)
    assert np.all(np.isfinite(cube))
    assert np.all(cube >= 0.0)
    assert cube[2].max() > 0.0
    exact = sky.radiance(SKY_THETA, SKY_GAMMA)
    assert np.all(np.isfinite(exact))
    assert np.all(exact >= 0.0)


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


@given(TURBIDITIES, ALBEDOS, st.floats(-17.9, BLEND_DEG), st.floats(1e-4, 0.5))
@example(10.0, 0.1, 0.3, 0.2)
@example(10.0, 0.1, 0.1, 0.1)
@example(10.0, 1.0, BLEND_DEG, 0.01)
def test_illuminance_falls_with_the_sun(turbidity, albedo, geometric_deg, step_deg):
    """From +0.5 deg down a lower sun gives less light, for every haze and ground.

    The model itself does not: T = 10, albedo 0.1 has 1998 lx at 0.3 deg and 2075 at 0.1.
    """
    higher = illuminance_of(turbidity, albedo, geometric_deg)
    lower = illuminance_of(turbidity, albedo, max(geometric_deg - step_deg, -18.0))
    assert lower < higher


@pytest.mark.parametrize(("turbidity", "albedo"), [(1.0, 0.0), (3.0, 0.1), (10.0, 1.0)])
def test_twilight_meets_the_published_curve(turbidity, albedo):
    """Hosek's last sky has two to four times the curve's light; at -7 deg none of that is left.

    From there on it is the curve, with the night's 1e-3 lx in place of the curve's own 6.4e-4.
    """
    above = (BLEND_DEG, 0.0, -2.0, -4.0, -6.0, ON_CURVE_DEG)
    excess = [illuminance_of(turbidity, albedo, e) / float(illuminance_lx(e)) for e in above]
    assert 2.0 < excess[0] < 4.0
    assert np.all(np.diff(excess) < 0)
    rest = float(NIGHT_ILLUMINANCE_LX - illuminance_lx(-18.0))
    for e in (ON_CURVE_DEG, -10.0, -12.0, -15.0):
        expected = float(illuminance_lx(e)) + rest
        assert illuminance_of(turbidity, albedo, e) == pytest.approx(expected, rel=3e-3)


def test_night_is_the_published_starlight_and_does_not_change():
    """Below -18 deg: 1e-3 lx (RCA Electro-Optics Handbook 1974) from everywhere alike."""
    night = sky_of_hour(3.0, 0.1, np.radians(-18.01))
    midnight = sky_of_hour(8.0, 0.9, np.radians(-90.0))
    assert illuminance_of(3.0, 0.1, -25.0) == pytest.approx(NIGHT_ILLUMINANCE_LX, rel=1e-3)
    np.testing.assert_array_equal(night.cube_map(8)[2], midnight.cube_map(8)[2])
    assert np.ptp(night.cube_map(8)[2]) == 0.0


def largest_change(turbidity: float, albedo: float, geometric_deg: float, top_deg: float) -> float:
    """The change of luminance over illuminance in 0.05 deg of sun, down to 0.15 deg of height.

    Relative to the larger of the value and 1 % of the brightest; `top_deg`: of the heights seen.
    """
    theta = np.pi / 2 - np.radians(0.15 + SKY_THETA / (np.pi / 2) * (top_deg - 0.15))
    before, after = (
        luminance(sky_of_hour(turbidity, albedo, apparent(e)).radiance(theta, SKY_GAMMA))
        / illuminance_of(turbidity, albedo, e)
        for e in (geometric_deg, geometric_deg + 0.05)
    )
    return float((np.abs(after - before) / np.maximum(before, 1e-2 * before.max())).max())


@given(
    st.floats(1.0, 8.0), ALBEDOS, st.floats(-17.0, BLEND_DEG - 0.05), st.sampled_from([4.0, 90.0])
)
@example(1.0, 0.0, -2.15, 8.0)
@example(1.0, 0.0, -2.9, 16.0)
@example(2.0, 0.2, -2.15, 8.0)
@example(4.0, 0.2, -1.45, 4.0)
@example(6.0, 0.2, -1.15, 4.0)
def test_no_direction_runs_ahead_of_the_light(turbidity, albedo, geometric_deg, top_deg):
    """In 0.05 deg of sun no direction may change much more in luminance than the illuminance.

    5 % in the blend (4.6 % seen: the sun's horizon at turbidity 4) and 3.5 % where the computed
    twilight is alone. Below turbidity 2 the planet's shadow has a sharp edge, opposite the sun:
    7.1 % is seen there in the blend and 4.6 % below it at turbidity 1.
    """
    in_blend = geometric_deg + 0.05 > BLEND_ENDS_DEG
    limit = 0.05 if in_blend else 0.035
    if turbidity < 2.0:
        limit = 0.075 if in_blend else 0.047
    assert largest_change(turbidity, albedo, geometric_deg, top_deg) < limit


@given(
    st.floats(8.0, 10.0), ALBEDOS, st.floats(-3.0, BLEND_DEG - 0.05), st.sampled_from([4.0, 90.0])
)
@example(10.0, 0.0, 0.4, 4.0)
@example(10.0, 0.0, -0.22, 4.0)
def test_a_black_horizon_lights_up_slowly(turbidity, albedo, geometric_deg, top_deg):
    """In thick haze over dark ground the model's horizon is black, 100 deg from the sun.

    It has to become brighter while the sun sinks: by 15.7 % in 0.05 deg at most (a scan by 0.01
    deg at turbidity 10, sun at -0.22 deg), where a sum of model and twilight took a factor of 2.3.
    """
    assert largest_change(turbidity, albedo, geometric_deg, top_deg) < 0.165


@pytest.mark.parametrize("geometric_deg", [-1.0, -4.0, -9.0])
def test_the_sky_is_even_about_the_plane_of_the_sun(geometric_deg):
    """With the sun in the north, east (+X) must mirror west (-X)."""
    cube = sky_of_hour(4.0, 0.1, apparent(geometric_deg)).cube_map(32, 0.0)
    np.testing.assert_allclose(cube[0], cube[1][:, ::-1], rtol=1e-5)


def test_the_zenith_of_the_blue_hour_is_blue():
    """Ozone makes the zenith blue when the sun is 4 to 6 deg down (Hulburt 1953).

    Grey-green at sunset, it must get bluer with every degree; blue over green passes that of a
    sun 10 deg up, 1.8. In clear air the horizon where the sun went down stays orange.
    """
    ratios = []
    for geometric_deg in (0.0, -2.0, -4.0, -5.0, -6.0):
        red, green, blue = zenith(3.0, geometric_deg)
        ratios.append(blue / red)
        glow = sunward(2.0, geometric_deg)
        assert glow[2] < 0.5 * glow[0]
    assert np.all(np.diff(ratios) > 0)
    assert ratios[2] > 1.5 * ratios[0]
    day = zenith(3.0, 10.0)
    assert blue / green > day[2] / day[1]


def zenith(turbidity: float, geometric_deg: float) -> np.ndarray:
    elevation = apparent(geometric_deg)
    return sky_of_hour(turbidity, 0.1, elevation).radiance(0.0, np.pi / 2 - elevation)


def sunward(turbidity: float, geometric_deg: float) -> np.ndarray:
    """Radiance 2 deg above the horizon where the sun went down."""
    elevation, theta = apparent(geometric_deg), np.radians(88.0)
    return sky_of_hour(turbidity, 0.1, elevation).radiance(theta, np.pi / 2 - elevation - theta)


def antisolar_profile(turbidity: float, geometric_deg: float) -> tuple[np.ndarray, np.ndarray]:
    """Elevations (deg) from 1 to 40 opposite the sun, and the radiance there."""
    view_deg = np.linspace(1.0, 40.0, 79)
    elevation, theta = apparent(geometric_deg), np.radians(90.0 - view_deg)
    gamma = np.pi / 2 - elevation + theta
    sky = sky_of_hour(turbidity, 0.1, elevation)
    return view_deg, sky.radiance(theta, np.minimum(gamma, 2 * np.pi - gamma))


@pytest.mark.parametrize("geometric_deg", [-2.0, -3.0])
def test_the_anti_twilight_arch(geometric_deg):
    """Opposite the sun a reddish band must stand above the planet's bluish shadow.

    Lee 2015 ("Measuring and modeling twilight's Belt of Venus", Applied Optics 54, B194) has its
    reddest part some degrees above the horizon, darker and bluer below it, blue sky above.
    """
    view_deg, rgb = antisolar_profile(2.0, geometric_deg)
    redness = rgb[:, 0] / rgb[:, 2]
    reddest = int(np.argmax(redness))
    assert 2.0 < view_deg[reddest] < 25.0
    assert redness[reddest] > 1.03 * redness[0]
    assert redness[reddest] > 1.2 * redness[-1]
    brightest = int(np.argmax(rgb @ [0.2126, 0.7152, 0.0722]))
    assert 0 < brightest < view_deg.size - 1


@pytest.mark.parametrize("geometric_deg", [0.3, -0.5, -3.0, -10.0, -17.0])
def test_the_fast_twilight_is_the_exact_one(geometric_deg):
    """The cube map of a sun below the horizon is held to its float64 twin like the day's."""
    sky = sky_of_hour(2.0, 0.2, apparent(geometric_deg))
    cube = sky.cube_map(16, 2.0)
    above = twin_cube(sky, 16, 2.0) > 0
    assert_texels_agree(np.where(above, cube, 0.0), twin_cube(sky, 16, 2.0))


def test_the_illuminance_of_the_models_map():
    """The map's 64 x 32 directions hold the model's last sky: its irradiance within 0.5 %.

    A fine cube map's is the truth; the aureole is what a bilinear map rounds off.
    """
    for turbidity in (1.0, 3.0, 10.0):
        for elevation in (BLEND_APPARENT_RAD, np.radians(-2.0)):
            model = HosekWilkieSky(turbidity, 0.1, BLEND_APPARENT_RAD)
            numbers = model.rgb_distribution, model.rgb_mean_radiance
            fine = HourSky(*numbers, elevation, 0.0).cube_map(256)
            exact = luminance(spherical_harmonics.horizontal_irradiance(fine))
            on_map = luminous_irradiance(model_on_map(*numbers, elevation))
            assert on_map == pytest.approx(float(exact), rel=5e-3)


def test_the_blend_is_where_it_says():
    """The constant in apparent elevation must be the refraction of the one in geometric."""
    assert np.degrees(geometric_elevation(BLEND_APPARENT_RAD)) == pytest.approx(BLEND_DEG)


@pytest.mark.parametrize("elevation", [-1.6, 1.6, np.nan])
def test_impossible_elevations_are_refused(elevation):
    """Elevations end at nadir and zenith."""
    with pytest.raises(ValueError, match="elevation"):
        sky_of_hour(3.0, 0.1, elevation)
