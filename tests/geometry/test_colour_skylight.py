"""Linear sRGB from four wavelengths, by the matrix fitted to clear skies."""

import numpy as np
import pytest

from vrut_lite.geometry.colour import (
    RGB_OF_TRANSFER,
    SKYLIGHT_NM,
    colour_table,
    luminance,
    rgb_from_spectrum,
    solar_irradiance,
)

FINE_NM = colour_table()[:, 0]


@pytest.mark.parametrize(
    ("power", "tolerance"), [(4.0, 0.0115), (2.0, 0.005), (0.0, 0.004), (-2.0, 0.01)]
)
def test_colour_of_smooth_light_is_that_of_its_whole_spectrum(
    power: float, tolerance: float
) -> None:
    """Sunlight times wavelength^-power, from bluer than the sky to redder than a hazy horizon.

    The colour of 95 wavelengths is the truth; no channel errs by more than 1.1 % of luminance.
    """
    whole, four = (
        rgb_from_spectrum(solar_irradiance(nm) * (np.asarray(nm) / 550.0) ** -power, nm)
        for nm in (FINE_NM, SKYLIGHT_NM)
    )
    assert np.abs(four - whole).max() < tolerance * luminance(whole)


def test_four_wavelengths_give_a_colour_per_spectrum() -> None:
    """Leading axes are kept, and the conversion is linear."""
    spectra = np.random.default_rng(3).random((2, 5, 4))
    rgb = rgb_from_spectrum(spectra, SKYLIGHT_NM)
    assert rgb.shape == (2, 5, 3)
    np.testing.assert_allclose(rgb_from_spectrum(2.0 * spectra, SKYLIGHT_NM), 2.0 * rgb)
    sun = solar_irradiance(SKYLIGHT_NM)
    np.testing.assert_allclose(rgb[1, 2], (spectra[1, 2] / sun) @ RGB_OF_TRANSFER)


@pytest.mark.parametrize(
    "wavelength_nm", [SKYLIGHT_NM[::-1], (680.0, 600.0, 550.0, 440.0)], ids=["reversed", "others"]
)
def test_four_other_wavelengths_make_no_colour(wavelength_nm: tuple[float, ...]) -> None:
    """Other wavelengths, or another order, are refused; the sentence names the right ones."""
    with pytest.raises(ValueError, match="unless they are 635, 570, 520, 445 nm"):
        rgb_from_spectrum(np.ones(4), wavelength_nm)


def test_the_order_of_wavelengths_does_not_matter() -> None:
    """A spectrum from red to blue has the colour that it has from blue to red."""
    wavelength = np.linspace(400.0, 700.0, 12)
    spectrum = 1.0 + 0.5 * np.sin(wavelength / 60.0)
    rgb = rgb_from_spectrum(spectrum, wavelength)
    assert (rgb > 0.0).all()
    assert rgb_from_spectrum(spectrum[::-1], wavelength[::-1]) == pytest.approx(rgb, rel=1e-14)
