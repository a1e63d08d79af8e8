"""The measures of error by their definitions."""

import numpy as np

from vrut_lite_lab.study.framework import errors
from vrut_lite_lab.study.framework.colour import approximate_spectrum
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM


def test_rmse_counts_31_wavelengths_in_81_directions():
    """Up to 712.5 nm: what differs beyond is not seen; one value of 3 among zeros is 3 / sqrt."""
    assert WAVELENGTHS_NM[errors.IN_COMMON][-1] == 712.5
    sky = np.zeros((81, 40))
    sky[:, 31:] = 7.0
    assert errors.rmse(sky, np.zeros_like(sky)) == 0.0
    sky[40, 30] = 3.0
    np.testing.assert_allclose(errors.rmse(sky, np.zeros_like(sky)), 3.0 / np.sqrt(81 * 31))


def test_total_rmse_is_over_all_times_at_once(reference):
    """It is the RMSE of all skies taken as one."""
    model, other = reference["nishita93_radiance"], reference["oneal_radiance"]
    each = errors.rmse(model, other)
    difference = (model - other)[..., :31]
    np.testing.assert_allclose(errors.total_rmse(each), np.sqrt((difference**2).mean()))


def test_relative_error_is_of_the_visible_radiance():
    """20 % more everywhere is 0.2, whatever is beyond 720 nm's bin."""
    sky = 1.0 + np.random.default_rng(3).random((81, 40))
    other = 1.2 * sky
    other[:, 31:] = 9.0
    np.testing.assert_allclose(errors.relative_error(other, sky), 0.2, rtol=1e-12)
    np.testing.assert_allclose(errors.relative_rmse(1.2 * sky, sky), 0.2, rtol=1e-12)


def test_error_of_rebuilt_spectra(reference):
    """As RMSE, of the spectrum rebuilt from three samples."""
    model, other = reference["nishita93_radiance"][0], reference["oneal_radiance"][0]
    direct = errors.rmse(approximate_spectrum(model), other)
    np.testing.assert_allclose(errors.approximate_spectrum_rmse(model, other), direct)
