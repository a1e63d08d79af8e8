"""The laboratory's own molecules and profile, against the numbers that were published for them."""

import numpy as np
import pytest

from vrut_lite.atmosphere.gases import ozone_absorption, rayleigh_optical_depth
from vrut_lite_lab.polarised_truth.gases import (
    depolarisation,
    ozone_depth,
    rayleigh_depth,
    standard_density,
)

NM = np.array([300.0, 350.0, 400.0, 450.0, 500.0, 550.0, 600.0, 700.0, 800.0])


def test_molecules_are_bodhaines():
    """Within 2e-4 of the fit to their own table that the paper prints, equation 30, sea level."""
    um = NM / 1000.0
    printed = 0.0021520 * (1.0455996 - 341.29061 * um**-2 - 0.90230850 * um**2)
    printed /= 1.0 + 0.0027059889 * um**-2 - 85.968563 * um**2
    np.testing.assert_allclose(rayleigh_depth(NM), printed, rtol=2e-4)


@pytest.mark.parametrize("pressure_hpa", [1013.25, 680.0])
def test_the_products_molecules_are_these(pressure_hpa):
    """0.2 % from 300 to 800 nm at two pressures; two programs of one paper."""
    ours = rayleigh_optical_depth(NM, 100.0 * pressure_hpa)
    np.testing.assert_allclose(ours, rayleigh_depth(NM, pressure_hpa), rtol=2e-3)


def test_air_depolarises_as_bates_found():
    """King's factor 1.0480 at 550 nm is a depolarisation of 0.0283; it falls with wavelength."""
    assert depolarisation(550.0) == pytest.approx(0.0283, abs=1e-4)
    assert np.all(np.diff(depolarisation(NM)) < 0.0)


def test_density_is_the_standard_atmospheres():
    """Number densities over that of the ground, U.S. Standard Atmosphere 1976, table I."""
    kilometres = [1.0, 5.0, 11.0, 20.0, 32.0, 50.0, 70.0, 80.0]
    printed = [
        2.3113e25,
        1.5312e25,
        7.5853e24,
        1.8486e24,
        2.8174e23,
        2.1351e22,
        1.7218e21,
        3.8379e20,
    ]
    density = standard_density(1000.0 * np.array(kilometres))
    np.testing.assert_allclose(density, np.array(printed) / 2.5470e25, rtol=1e-3)


def test_the_products_ozone_is_andersons():
    """Cross sections of two laboratories: 2 % of the sum, and no shift by 5 nm (12 % at 635 nm).

    The product's are means of 10 nm.
    """
    nm = np.arange(450.0, 680.0, 5.0)
    ours = ozone_absorption(nm, 300.0, 1.0)
    theirs = ozone_depth(nm + np.array([[-5.0], [0.0], [5.0]]), 300.0)
    theirs = np.array([0.25, 0.5, 0.25]) @ theirs
    assert ours.sum() == pytest.approx(theirs.sum(), rel=0.02)
    assert np.sqrt(np.mean((ours - theirs) ** 2)) < 0.03 * theirs.mean()
