"""Luminance, colours and rebuilt spectra against the published program's."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite_lab.study.framework import colour
from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM

MODELS = ("nishita93", "preetham", "oneal", "hosek", "trapezoidal")
# The published program's solar spectrum is in single precision, and so are its factors.
SINGLE = 2.0**-24
# The published trapezoid overflows in these directions when the sun is at 80 deg.
OVERFLOWING = (36, 45, 54)


def skies(reference, model, quantity):
    """Radiance, and what the published program made of it, in the directions without overflow."""
    whole = ~np.isin(np.arange(81), OVERFLOWING)
    return reference[f"{model}_radiance"][:, whole], reference[f"{model}_{quantity}"][:, whole]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(
    ("function", "quantity", "rtol"),
    [
        (colour.luminance, "luminance", 1e-13),
        (colour.srgb, "srgb", 1e-12),
        (colour.three_sample_srgb, "srgb_3samples", SINGLE),
    ],
)
def test_colours_are_the_published_ones(reference, model, function, quantity, rtol):
    """Five models, three suns, 78 directions."""
    radiance, published = skies(reference, model, quantity)
    np.testing.assert_allclose(function(radiance), published, rtol=rtol, atol=1e-12)


@pytest.mark.parametrize("model", MODELS)
def test_rebuilt_spectra_are_the_published_ones(reference, model):
    """To what single precision leaves of the brightest sample: far red ones nearly cancel."""
    radiance, published = skies(reference, model, "approx_spectrum")
    ours = colour.approximate_spectrum(radiance)
    np.testing.assert_allclose(ours, published, atol=4 * SINGLE * published.max())


def test_the_observer_is_the_published_one(reference):
    """The host's table of the CIE's functions, at the 40 wavelengths."""
    np.testing.assert_allclose(colour.colour_matching(), reference["cie_xyz"], atol=1e-14)


def test_colours_agree_with_the_hosts(reference):
    """Its integral follows the spectrum between samples: 1 % of a sky's luminance, no more."""
    radiance = reference["nishita93_radiance"][0]
    host = rgb_from_spectrum(radiance, WAVELENGTHS_NM) * colour.LUMENS_PER_WATT
    ours = colour.srgb(radiance)
    assert np.abs(ours - host).max() < 0.01 * host.max()


def test_three_samples_are_right_for_what_they_assume():
    """A sky that goes as the sun over wavelength^3 has its true colour.

    To 1 %: the samples are read off a straight line between two wavelengths, where the cube
    is not straight.
    """
    sky = STUDY.solar_irradiance * (WAVELENGTHS_NM / 500.0) ** -3
    np.testing.assert_allclose(colour.three_sample_srgb(sky), colour.srgb(sky), rtol=0.01)


@given(luminance=st.floats(1.0, 1e5), x=st.floats(0.25, 0.38), y=st.floats(0.26, 0.38))
def test_daylight_has_the_luminance_asked_for(luminance, x, y):
    """Whatever its chromaticity."""
    spectrum = colour.daylight_spectrum(luminance, x, y)
    np.testing.assert_allclose(colour.luminance(spectrum), luminance, rtol=1e-12)


def test_tone_map_and_chromaticity():
    """White is reached to 1 - 1/e at 3415 cd m^-2; chromaticity has a largest component of 1."""
    np.testing.assert_allclose(colour.tone_mapped([0.0, 3415.0]), [0.0, 1.0 - np.exp(-1.0)])
    np.testing.assert_allclose(colour.chromaticity([[2.0, 4.0, 1.0]]), [[0.5, 1.0, 0.25]])
    assert not colour.chromaticity(np.zeros(3)).any()
