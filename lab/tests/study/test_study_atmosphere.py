"""The common atmosphere: its spectra against the published ones, and against their sources."""

from dataclasses import replace

import numpy as np
import pytest

from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.spectra import BIN_NM, WAVELENGTHS_NM
from vrut_lite_lab.study.framework.tables import table_spectra

# The published program keeps its tables in single precision: half a unit of 24 bits.
SINGLE = 2.0**-24


@pytest.mark.parametrize(
    ("ours", "published"),
    [
        ("solar_irradiance", "solar_spectrum"),
        ("rayleigh_scattering", "rayleigh_scattering"),
        ("mie_extinction", "mie_extinction"),
        ("mie_scattering", "mie_scattering"),
        ("ground_albedo", "ground_albedo"),
    ],
)
def test_spectra_are_the_published_ones(reference, ours, published):
    """All five, to the rounding of the published program's tables."""
    np.testing.assert_allclose(getattr(STUDY, ours), reference[published], rtol=SINGLE)


def test_the_components_of_daylight_are_the_published_ones(reference):
    """CIE 15:2004, table T.2; the published program has it in double precision."""
    np.testing.assert_allclose(
        table_spectra("daylight_cie"), reference["daylight_S012"], atol=1e-12
    )


def test_the_sun_is_that_of_the_standard():
    """The means of ASTM G-173's own values over each bin, as pvlib carries them, to six digits."""
    import pvlib

    standard = pvlib.spectrum.get_reference_spectra()["extraterrestrial"]
    nm = standard.index.to_numpy()
    bins = [(nm >= start) & (nm < start + BIN_NM) for start in WAVELENGTHS_NM]
    means = [standard.to_numpy()[some].mean() for some in bins]
    np.testing.assert_allclose(STUDY.solar_irradiance, means, atol=5.1e-6)


def test_rayleigh_scattering_is_near_its_law():
    """Penndorf's table falls as wavelength^-4.08, a little steeper than the fourth power."""
    slope = np.polyfit(np.log(WAVELENGTHS_NM), np.log(STUDY.rayleigh_scattering), 1)[0]
    assert -4.15 < slope < -4.05


def test_the_other_modules_see_the_same_air():
    """Coefficients, heights and radii go over unchanged; nothing absorbs."""
    planet = replace(STUDY, ground_radius_m=3e6, top_radius_m=3.1e6, mie_g=0.3)
    air = planet.bruneton_atmosphere()
    assert air.top_altitude_m == 1e5
    assert air.ground_radius_m == 3e6
    assert air.mie_g == 0.3
    np.testing.assert_array_equal(air.wavelength_nm, WAVELENGTHS_NM)
    np.testing.assert_array_equal(air.mie_scattering, STUDY.mie_scattering)
    np.testing.assert_array_equal(air.rayleigh_scattering, STUDY.rayleigh_scattering)
    assert not any(air.absorption_extinction)
