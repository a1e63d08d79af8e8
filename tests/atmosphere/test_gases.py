"""The gases of the air: molecules as measured, weak absorbers, water vapour."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.atmosphere.gases import (
    depolarisation,
    king_factor,
    nitrogen_dioxide_optical_depth,
    oxygen_pair_section_m5,
    ozone_absorption,
    rayleigh_optical_depth,
    water_optical_depth,
)

NM = np.array([300.0, 350.0, 400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0, 750.0, 800.0])


def test_molecules_have_the_published_optical_depth():
    """Bodhaine et al. 1999, equation 30: their own fit to their table for 1013.25 hPa."""
    square = (NM / 1000.0) ** 2
    upper = 1.0455996 - 341.29061 / square - 0.90230850 * square
    published = 0.0021520 * upper / (1.0 + 0.0027059889 / square - 85.968563 * square)
    assert rayleigh_optical_depth(NM) == pytest.approx(published, rel=2e-4)


def test_molecules_thin_in_proportion_to_the_pressure():
    """Mauna Loa's 680 hPa against sea level: gravity aside, a column is a pressure."""
    ratio = rayleigh_optical_depth(NM, 68_000.0) / rayleigh_optical_depth(NM)
    assert ratio == pytest.approx(np.full(NM.size, 680.0 / 1013.25))


def test_molecules_are_those_of_an_independent_program():
    """colour-science's own reading of the same paper, by its own constants of the air."""
    phenomena = pytest.importorskip("colour.phenomena.rayleigh")
    theirs = phenomena.rayleigh_optical_depth(NM * 1e-7, latitude=45.0)
    assert rayleigh_optical_depth(NM) == pytest.approx(theirs, rel=2e-3)
    kings = phenomena.F_air_Bodhaine1999(NM / 1000.0, 360.0)
    assert king_factor(NM) == pytest.approx(kings, rel=1e-5)


def test_the_depolarisation_is_that_of_kings_factor():
    """(6 + 3 rho) / (6 - 7 rho), and near the 0.0279 that Young 1980 gives for white light."""
    rho = depolarisation(NM)
    assert (6.0 + 3.0 * rho) / (6.0 - 7.0 * rho) == pytest.approx(king_factor(NM))
    assert depolarisation(550.0) == pytest.approx(0.0279, abs=1e-3)


def test_ozone_absorbs_most_at_its_published_maximum():
    """Chappuis' band peaks at 603 nm with 5.1e-25 m^2 (Serdyuchenko et al. 2014): means of 10 nm
    must stand at their middles."""
    nm = np.arange(560.0, 650.0, 1.0)
    depth = ozone_absorption(nm, 1.0, 1.0) / 2.687e20
    assert nm[depth.argmax()] == pytest.approx(603.0, abs=3.0)
    assert depth.max() == pytest.approx(5.1e-25, rel=0.03)


def test_a_wide_band_of_oxygen_pairs_absorbs_as_much_as_a_narrow_one():
    """A wavelength that stands for a band has its mean: the integral stays."""
    nm = np.arange(350.0, 900.0, 0.5)
    narrow, wide = oxygen_pair_section_m5(nm), oxygen_pair_section_m5(nm, 50.0)
    assert wide[150:].sum() == pytest.approx(narrow[150:].sum(), rel=0.03)
    assert wide.max() < 0.3 * narrow.max()


def test_a_citys_nitrogen_dioxide_takes_blue():
    """1 DU: 1.4 % at 440 nm, nothing to speak of in red."""
    blue, red = nitrogen_dioxide_optical_depth([440.0, 650.0], 1.0)
    assert blue == pytest.approx(0.0137, rel=0.02)
    assert red < 0.05 * blue


def test_water_lies_where_its_bands_are_and_saturates():
    nm = np.array([430.0, 550.0, 590.0, 723.0])
    once, twice = water_optical_depth(nm, [1.0, 2.0])
    assert once[0] == 0.0
    assert once[1] < 1e-3 < once[2] < once[3]
    assert 1.0 < twice[3] / once[3] < 2.0


@given(st.floats(360.0, 830.0), st.floats(0.0, 1000.0), st.floats(0.0, 20.0))
def test_gases_only_take_light(nm, water_cm, dobson_units):
    depths = [
        rayleigh_optical_depth(nm),
        nitrogen_dioxide_optical_depth(nm, dobson_units),
        oxygen_pair_section_m5(nm),
        water_optical_depth([nm], water_cm),
    ]
    for depth in depths:
        assert np.isfinite(depth).all()
        assert np.min(depth) >= 0.0
