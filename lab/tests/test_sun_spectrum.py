"""Our own air's direct sunlight beside the reference spectrum ASTM G-173 and Bird's model.

G-173: air mass 1.5, the standard atmosphere, 343.8 DU of ozone, 1.42 cm of water, rural aerosol
with 0.084 at 500 nm. Its direct spectrum contains 0.3 % of circumsolar light.
"""

import numpy as np
import pytest

from vrut_lite.atmosphere.clear_air import OZONE_DU
from vrut_lite.atmosphere.gases import ozone_absorption
from vrut_lite.atmosphere.sunlight import slant_depth
from vrut_lite.geometry.colour import colour_table

pvlib = pytest.importorskip("pvlib", reason="pvlib of the laboratory's extra test is missing")

SUN_ZENITH_DEG, OZONE_G173_DU, WATER_CM, RURAL_500 = 48.19, 343.8, 1.416, 0.084


# Angstrom exponents, as polynomials in micrometres below a wavelength, of the rural aerosol of
# Shettle and Fenn 1979 in the standard atmosphere, as SMARTS 2.9.5 (Gueymard) computed G-173.
RURAL_EXPONENTS = (
    (0.550, (0.98264, 0.032539, -0.040251)),
    (0.694, (-32.0108, 151.02, -229.75, 116.83)),
    (1.060, (-1.9669, 9.576, -9.4345, 3.1621)),
)


class RuralHaze:
    """The aerosol of G-173, from 337 to 1060 nm."""

    height_m, peak_m = 1500.0, None

    def depth_at(self, wavelength_nm):
        micrometres = np.asarray(wavelength_nm, dtype=float) / 1000.0
        exponent = np.select(
            [micrometres < end for end, _ in RURAL_EXPONENTS],
            [np.polynomial.Polynomial(terms)(micrometres) for _, terms in RURAL_EXPONENTS],
        )
        return RURAL_500 * (2.0 * micrometres) ** -exponent


@pytest.fixture(scope="module")
def transmittance():
    """Wavelengths (n,) of the colour table and the direct beam's transmittance (n,) in that air."""
    nm = colour_table()[:, 0]
    sine = float(np.cos(np.radians(SUN_ZENITH_DEG)))
    depth = slant_depth(0.0, sine, nm, [RuralHaze()])
    more = ozone_absorption(nm, OZONE_G173_DU - OZONE_DU, 1.0)
    return nm, np.exp(-depth - more / sine)


def test_luminance_is_that_of_the_reference(transmittance):
    """The sun's luminance through the air within 0.7 %, with the reference's own sun."""
    nm, passed = transmittance
    table = pvlib.spectrum.get_reference_spectra()
    fine = table.index.to_numpy()
    chosen = (fine >= nm[0]) & (fine <= nm[-1])
    y_bar = np.interp(fine[chosen], nm, colour_table()[:, 2])
    direct = np.trapezoid(y_bar * table["direct"][chosen], fine[chosen])
    ours = np.interp(fine[chosen], nm, passed) * table["extraterrestrial"][chosen]
    assert np.trapezoid(y_bar * ours, fine[chosen]) == pytest.approx(direct, rel=0.007)


def test_spectrum_is_that_of_the_reference(transmittance):
    """In means of 20 nm from 400 to 620, below oxygen's lines, within 1 %."""
    nm, passed = transmittance
    table = pvlib.spectrum.get_reference_spectra()
    fine = table.index.to_numpy()
    for low in range(400, 620, 20):
        chosen = (fine >= low) & (fine <= low + 20)
        reference = np.trapezoid(table["direct"][chosen], fine[chosen])
        own = np.interp(fine[chosen], nm, passed) * table["extraterrestrial"][chosen]
        assert np.trapezoid(own, fine[chosen]) == pytest.approx(reference, rel=0.01), low


def test_spectrum_is_near_birds(transmittance):
    """Bird and Riordan's simple model of the same air: 1 % rms from 400 to 650 nm."""
    nm, passed = transmittance
    bird = pvlib.spectrum.spectrl2(
        apparent_zenith=SUN_ZENITH_DEG, aoi=0.0, surface_tilt=0.0, ground_albedo=0.2,
        surface_pressure=101_325.0, relative_airmass=1.5, precipitable_water=WATER_CM,
        ozone=0.001 * OZONE_G173_DU, aerosol_turbidity_500nm=RURAL_500, dayofyear=94,
    )  # fmt: skip
    theirs = np.ravel(bird["dni"]) / np.ravel(bird["dni_extra"])
    at = np.ravel(bird["wavelength"])
    seen = (at >= 400.0) & (at <= 650.0)
    ratio = np.interp(at[seen], nm, passed) / theirs[seen]
    assert np.sqrt(np.mean((ratio - 1.0) ** 2)) < 0.01
