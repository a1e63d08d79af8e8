"""Spectra of 40 samples: where they sit, how they are read and integrated."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite_lab.study.framework.spectra import (
    WAVELENGTHS_NM,
    at_wavelength,
    integral,
    integral_between,
    resampled,
)

inside_nm = st.floats(360.0, 830.0)


def test_the_wavelengths_are_the_published_ones(reference):
    """40 left edges of bins of 11.75 nm from 360 nm on."""
    np.testing.assert_allclose(WAVELENGTHS_NM, reference["wavelengths_nm"], rtol=1e-15)


def test_a_table_is_linear_inside_and_constant_outside():
    """A straight table comes back straight; beyond its ends its last values hold."""
    nodes = np.array([400.0, 500.0, 700.0])
    spectrum = resampled(nodes, [nodes, 2.0 * nodes])
    expected = np.clip(WAVELENGTHS_NM, 400.0, 700.0)
    np.testing.assert_allclose(spectrum, [expected, 2.0 * expected], rtol=1e-14)


def test_a_spectrum_is_read_between_its_samples():
    """Halfway between two samples it is their mean; beyond the last one it stays."""
    spectrum = WAVELENGTHS_NM**2
    middle = at_wavelength(spectrum, [360.0 + 11.75 / 2, 829.0])
    np.testing.assert_allclose(middle, [spectrum[:2].mean(), spectrum[-1]], rtol=1e-14)


@given(a=inside_nm, b=inside_nm, c=inside_nm)
def test_integrals_add_up(a, b, c):
    """From a to b and from b to c is from a to c, and the whole is the sum over all bins."""
    low, middle, high = sorted((a, b, c))
    spectrum = 1.0 + np.cos(WAVELENGTHS_NM / 50.0)
    parts = integral_between(spectrum, low, middle) + integral_between(spectrum, middle, high)
    np.testing.assert_allclose(parts, integral_between(spectrum, low, high), atol=1e-10)
    whole = integral_between(spectrum, 360.0, 830.0)
    np.testing.assert_allclose(whole, integral(spectrum), rtol=1e-13)


def test_a_part_of_a_bin_counts_in_part():
    """From 712.5 to 720 nm there are 7.5 nm of the bin that starts at 712.5 nm."""
    only_bin = np.where(WAVELENGTHS_NM == 712.5, 2.0, 0.0)
    np.testing.assert_allclose(integral_between(only_bin, 360.0, 720.0), 15.0, rtol=1e-14)
