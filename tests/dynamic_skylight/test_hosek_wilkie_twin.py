"""The float64 model against the authors' own C code, and what it refuses."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.coefficients import WAVELENGTHS_NM
from dynamic_skylight.hosek_wilkie.sky import SOLAR_DISC_RADIUS_RAD

REFERENCE = np.load(Path(__file__).parents[1] / "data" / "hosek_wilkie_reference.npz")
CASES = list(product(range(4), range(4), range(10)))


def make_sky(case: tuple[int, int, int]) -> HosekWilkieSky:
    t, a, e = case
    return HosekWilkieSky(
        REFERENCE["turbidity"][t], REFERENCE["albedo"][a], np.radians(REFERENCE["elevation_deg"][e])
    )


def assert_equal_to_reference(values: np.ndarray, expected: np.ndarray) -> None:
    """Within 1e-9 wherever the reference exceeds 1e-6 of its maximum."""
    counted = np.abs(expected) > 1e-6 * np.abs(expected).max()
    np.testing.assert_allclose(values[counted], expected[counted], rtol=1e-9, atol=0)


def test_rgb_radiance_is_that_of_the_authors_code():
    """RGB radiance must equal the C reference 1.4a (hosek_wilkie_reference.npz) in float64."""
    for case in CASES:
        values = make_sky(case).raw_radiance(REFERENCE["theta"], REFERENCE["gamma"])
        assert_equal_to_reference(values, REFERENCE["rgb_radiance"][case])


def test_spectral_radiance_is_that_of_the_authors_code():
    """Spectral radiance must equal the C reference at its eleven bands, clamped at zero."""
    theta, gamma = REFERENCE["theta"][:16], REFERENCE["gamma"][:16]
    for case in CASES:
        values = make_sky(case).spectral_radiance(theta, gamma, REFERENCE["wavelengths_nm"])
        assert_equal_to_reference(values, np.maximum(REFERENCE["spectral_radiance"][case], 0.0))


def test_wavelengths_between_and_beyond_the_bands_follow_the_authors_code():
    """Between bands linear; 281 to 320 nm holds, 720 to 760 nm fades: as the C reference does."""
    theta, gamma = REFERENCE["theta"][6:10], REFERENCE["gamma"][6:10]
    for case in CASES:
        values = make_sky(case).spectral_radiance(theta, gamma, REFERENCE["wavelengths_interp_nm"])
        expected = np.maximum(REFERENCE["spectral_radiance_interp"][case], 0.0)
        assert_equal_to_reference(values, expected)


def test_no_sky_light_at_the_ends_of_the_modelled_spectrum():
    """At 280 and 760 nm the C reference returns 0; beyond, where it knows nothing, we refuse."""
    sky = HosekWilkieSky(3.0, 0.1, 0.8)
    assert not sky.spectral_radiance(0.5, 0.4, [280.0, 760.0]).any()
    for outside_nm in (200.0, 279.9, 760.1, 830.0):
        with pytest.raises(ValueError, match=f"between 280 and 760 nm, not {outside_nm}"):
            sky.spectral_radiance(0.5, 0.4, [500.0, outside_nm])


def test_solar_disc_is_the_authors_total_less_their_sky():
    """Inside 0.255 deg the disc alone is the C reference's solar radiance less its sky's."""
    gamma = np.radians(REFERENCE["solar_gamma_deg"])
    inside = gamma <= SOLAR_DISC_RADIUS_RAD
    difference = REFERENCE["solar_total_radiance"] - REFERENCE["solar_sky_radiance"]
    for case in CASES:
        sky = make_sky(case)
        theta = np.pi / 2 - sky.sun_elevation_rad
        values = sky.solar_radiance(theta, gamma, WAVELENGTHS_NM)
        assert_equal_to_reference(values[inside], difference[case][inside])
        assert not values[~inside].any()


def test_solar_disc_between_bands_follows_the_authors_code():
    """Radiance and darkening are interpolated separately, as in the C reference at 0.1 deg."""
    gamma, wavelength = np.radians(0.1), REFERENCE["solar_wavelengths_interp_nm"]
    for case in CASES:
        sky = make_sky(case)
        theta = np.pi / 2 - sky.sun_elevation_rad
        total = sky.solar_radiance(theta, gamma, wavelength) + sky.spectral_radiance(
            theta, gamma, wavelength
        )
        assert_equal_to_reference(total, REFERENCE["solar_total_radiance_interp"][case])


def test_parameters_are_those_of_the_authors_code():
    """The interpolated A to I and factors must equal the C reference's state."""
    for case in CASES:
        sky = make_sky(case)
        np.testing.assert_allclose(sky.rgb_distribution, REFERENCE["rgb_config"][case], rtol=1e-9)
        np.testing.assert_allclose(
            sky.spectral_mean_radiance, REFERENCE["spectral_config_radiance"][case], rtol=1e-9
        )


def test_albedo_per_channel_mixes_the_channels_of_uniform_skies():
    """Channels know nothing of each other: each must be that of the sky with its own albedo."""
    albedo = (0.0, 0.3, 1.0)
    mixed = HosekWilkieSky(4.2, albedo, 0.3).radiance(0.7, 0.9)
    for channel, value in enumerate(albedo):
        assert mixed[channel] == HosekWilkieSky(4.2, value, 0.3).radiance(0.7, 0.9)[channel]
    spectral = HosekWilkieSky(4.2, np.linspace(0, 1, 11), 0.3).spectral_radiance(0.7, 0.9, 440.0)
    assert spectral == HosekWilkieSky(4.2, 0.3, 0.3).spectral_radiance(0.7, 0.9, 440.0)


def test_shapes_broadcast():
    """Angles of any shapes that broadcast give (..., 3) or (..., wavelengths)."""
    sky = HosekWilkieSky(3.0, 0.1, 0.8)
    theta, gamma = np.linspace(0, 1.5, 5)[:, None], np.linspace(0, 3, 4)
    assert sky.radiance(theta, gamma).shape == (5, 4, 3)
    assert sky.radiance(0.1, 0.2).shape == (3,)
    assert sky.spectral_radiance(theta, gamma, [400.0, 500.0]).shape == (5, 4, 2)
    assert sky.spectral_radiance(theta, gamma, 500.0).shape == (5, 4)
    assert sky.solar_radiance(theta, gamma, 500.0).shape == (5, 4)
    assert sky.solar_radiance(theta, gamma, [[400.0], [500.0]]).shape == (5, 4, 2, 1)


def test_radiance_is_clamped_and_raw_radiance_is_not():
    """The fit dips below zero in places that the angles of some skies reach; light cannot."""
    theta, gamma = np.meshgrid(np.linspace(0, np.pi / 2, 40), np.linspace(0, np.pi, 60))
    lowest = 0.0
    for turbidity, elevation in product((1.0, 2.0, 10.0), (0.0, 0.02, 0.8, np.pi / 2)):
        sky = HosekWilkieSky(turbidity, 0.0, elevation)
        lowest = min(lowest, sky.raw_radiance(theta, gamma).min())
        assert sky.radiance(theta, gamma).min() >= 0.0
    assert lowest < 0.0


def test_nothing_below_the_horizon():
    """The model knows no ground: sky and disc are 0 for theta beyond a right angle."""
    sky = HosekWilkieSky(3.0, 0.1, 0.0)
    assert not sky.radiance(1.6, 0.1).any()
    assert not sky.spectral_radiance(1.6, 0.1, WAVELENGTHS_NM).any()
    assert not sky.solar_radiance(np.pi / 2 + 1e-3, 1e-3, WAVELENGTHS_NM).any()


@pytest.mark.parametrize(
    ("turbidity", "albedo", "elevation"),
    [
        (0.9, 0.1, 0.5),
        (10.1, 0.1, 0.5),
        (np.nan, 0.1, 0.5),
        (3.0, -0.1, 0.5),
        (3.0, (0.1, 1.1, 0.1), 0.5),
        (3.0, (0.1, 0.1), 0.5),
        (3.0, np.nan, 0.5),
        (3.0, 0.1, -0.01),
        (3.0, 0.1, 1.6),
        (3.0, 0.1, np.nan),
    ],
)
def test_inputs_outside_the_fit_are_refused(turbidity, albedo, elevation):
    """Turbidity 1 to 10, albedo 0 to 1, sun 0 to 90 deg: an extrapolated fit is worth nothing."""
    with pytest.raises(ValueError, match="must"):
        HosekWilkieSky(turbidity, albedo, elevation)


def test_albedo_of_the_wrong_kind_is_refused():
    """Three albedos say nothing of eleven wavelengths."""
    with pytest.raises(ValueError, match="11"):
        HosekWilkieSky(3.0, (0.1, 0.1, 0.1), 0.5).spectral_radiance(0.1, 0.2, 500.0)


def test_the_sun_has_no_light_outside_its_tables():
    """The C reference asserts 320 to 720 nm for the sun."""
    with pytest.raises(ValueError, match="319"):
        HosekWilkieSky(3.0, 0.1, 0.5).solar_radiance(1.0, 0.0, 319.0)
