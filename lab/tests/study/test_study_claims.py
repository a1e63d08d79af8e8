"""What is measured of the papers' claims, held to what is known beforehand."""

import numpy as np
import pytest

from vrut_lite_lab.study.claims.coefficients import (
    CONSTANT_INDEX,
    PENNDORF_DEPOLARISATION,
    edlen_index,
    mie_by_equation,
    rayleigh_ratio,
)
from vrut_lite_lab.study.claims.looks import look
from vrut_lite_lab.study.claims.resolution import display_difference
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.models.rules import SingleScattering, converged


def test_refractive_index_of_air() -> None:
    """Edlen 1953 gives 1.000277 at the sodium line, 589.3 nm, at 15 deg C."""
    assert edlen_index(np.array([589.3]))[0] - 1 == pytest.approx(2.7712e-4, rel=5e-4)


def test_kings_factor_makes_equation_4_the_table() -> None:
    """With Edlen's index and Penndorf's depolarisation the table comes out to 0.2 %."""
    ratio = rayleigh_ratio(edlen_index(WAVELENGTHS_NM), PENNDORF_DEPOLARISATION)
    at = np.interp([360, 440, 550, 680], WAVELENGTHS_NM, ratio)
    np.testing.assert_allclose(at, 1.0, atol=2e-3)


def test_a_constant_index_errs_more_toward_red() -> None:
    """Air refracts red light less than 1.0003 says, so equation 4 scatters too much of it."""
    ratio = rayleigh_ratio(CONSTANT_INDEX)
    assert 1.03 < ratio[0] < 1.05
    assert 1.10 < ratio[-1] < 1.13


def test_equation_5_is_no_coefficient() -> None:
    """8 pi^3 (6e-4)^2 / (3 * 2.547e25) by hand: 1.17e-30, a volume."""
    by_hand = 8 * 31.006 * (6.0009e-4) ** 2 / (3 * 2.547e25)
    assert mie_by_equation() == pytest.approx(by_hand, rel=1e-4)


def test_a_sky_looks_like_itself() -> None:
    """No difference, brightness 1; the trapezoid's coarse sky at 87 degrees is darker."""
    sky = converged()
    same = look(sky, sky, 87.0, size=16)
    assert same.brightness == pytest.approx(1.0)
    assert same.off == pytest.approx(0.0, abs=1e-12)
    assert same.relative_off == pytest.approx(0.0, abs=1e-12)
    assert sum(same.horizon) == pytest.approx(1.0)
    coarse = look(SingleScattering("trapezoid", (16, 8)), sky, 87.0, size=16)
    assert coarse.brightness < 0.8


def test_linear_look_up_errs_by_the_square_of_the_texel() -> None:
    """Halving the texels quarters the mean error of a smooth sky."""
    coarse, fine = (display_difference(size, 45.0).mean() for size in (64, 128))
    assert coarse / fine == pytest.approx(4.0, rel=0.15)
