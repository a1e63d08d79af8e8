"""Eye responses of spectra against CIE's published figures and other implementations.

colour-science knows CIE's illuminants and Ohno's colour temperature; the alpha-opic figures are
those of luxpy 1.12.5 (CIE S 026, table 2) for 1,000 lx of each illuminant.
"""

import colour
import numpy as np
import pytest
from daylight_numbers.spectra.colour_temperature import colour_temperature
from daylight_numbers.spectra.daylight import d65, daylight_of_rgb
from daylight_numbers.spectra.eye_responses import (
    RECEPTORS,
    action_spectra,
    alpha_opic_efficacy_of_d65,
    eye_responses,
)
from daylight_numbers.spectra.reflectances import reflectances_of

from vrut_lite.geometry.colour import rgb_from_spectrum

# EDI in lx by `RECEPTORS`, of 1,000 lx.
LUXPY = {
    "A": (311.02, 806.57, 1017.07, 573.06, 495.78),
    "D50": (746.88, 949.95, 1000.33, 876.30, 847.36),
    "D65": (1000.00, 1000.00, 1000.00, 1000.00, 1000.00),
    "D75": (1132.59, 1023.15, 1000.86, 1060.80, 1076.17),
    "E": (925.50, 959.43, 1006.14, 917.46, 905.82),
    "FL2": (621.92, 880.17, 992.05, 638.04, 569.90),
    "FL11": (591.32, 869.91, 991.03, 647.92, 563.60),
    "LED-B3": (617.64, 884.12, 997.76, 698.54, 632.57),
}
NM = np.arange(380.0, 781.0, 10.0)


def illuminant(name):
    found = colour.SDS_ILLUMINANTS[name]
    return found.values, found.wavelengths


def test_action_spectra_peak_where_the_standard_says():
    """CIE S 026: cones at 448, 541 and 569 nm, rods at 507 nm, melanopsin at 490 nm."""
    nm, *curves = action_spectra().T
    peaks = [nm[curve.argmax()] for curve in curves]
    np.testing.assert_allclose(peaks, [448.0, 541.0, 569.0, 507.0, 490.0], atol=1.0)
    np.testing.assert_allclose([curve.max() for curve in curves], 1.0, atol=1e-4)


def test_d65_has_the_published_efficacies():
    """CIE S 026, table 2: alpha-opic efficacies of D65 in mW/lm."""
    published = [0.8173, 1.4558, 1.6289, 1.4497, 1.3262]
    np.testing.assert_allclose(1e3 * alpha_opic_efficacy_of_d65(), published, atol=6e-5)


@pytest.mark.parametrize("name", LUXPY)
def test_daylight_illuminances_are_those_of_luxpy(name):
    """Another implementation, from other tables of the same standard: within 0.1 %."""
    values, nm = illuminant(name)
    found = eye_responses(values, nm)
    edi = 1000.0 * found.edi_lx / found.illuminance_lx
    np.testing.assert_allclose(edi, LUXPY[name], rtol=1e-3)


@pytest.mark.parametrize("name", LUXPY)
def test_colour_temperature_is_ohnos(name):
    """colour-science sums each nm and follows Ohno 2013: CCT within 1 K, Duv within 1e-5."""
    values, nm = illuminant(name)
    found = colour_temperature(eye_responses(values, nm).xyz)
    each_nm = np.arange(360.0, 831.0)
    known = np.interp(each_nm, nm, values, left=0.0, right=0.0)
    spectrum = colour.SpectralDistribution(known, each_nm)
    xyz = colour.sd_to_XYZ(spectrum, method="Integration", shape=spectrum.shape)
    uv = colour.UCS_to_uv(colour.XYZ_to_UCS(xyz))
    kelvin, duv = colour.temperature.uv_to_CCT_Ohno2013(uv)
    assert found.cct_k == pytest.approx(kelvin, abs=1.0)
    assert found.duv == pytest.approx(duv, abs=1e-5)


@pytest.mark.parametrize("kelvin", [1500.0, 3000.0, 6500.0, 20_000.0])
def test_planck_has_its_own_temperature(kelvin):
    """A black body lies on the locus: its temperature within 0.5 K, no distance."""
    nm = np.arange(360.0, 831.0)
    planck = nm**-5.0 / np.expm1(1.4388e7 / (nm * kelvin))
    found = colour_temperature(eye_responses(planck, nm).xyz)
    assert found.cct_k == pytest.approx(kelvin, abs=0.5)
    assert abs(found.duv) < 1e-6


def test_no_light_and_green_light_have_no_colour_temperature():
    """CIE 15 defines none farther than 0.05 from the locus."""
    xyz = [[0.0, 0.0, 0.0], [0.1, 1.0, 0.1]]
    assert np.isnan(colour_temperature(xyz).cct_k).all()


def test_light_with_a_colour_alone_is_a_daylight():
    """White is D65; the colour of a D illuminant becomes that illuminant, as CIE 15 has it."""
    white = daylight_of_rgb([1.0, 1.0, 1.0], NM)
    np.testing.assert_allclose(white / white[18], d65(NM) / 100.0, atol=1e-3)
    for name in ("D50", "D75"):
        values, nm = illuminant(name)
        inside = (nm >= 380.0) & (nm <= 780.0)
        found = daylight_of_rgb(rgb_from_spectrum(values, nm), nm[inside])
        np.testing.assert_allclose(found, values[inside], rtol=5e-3)


def test_a_colour_keeps_its_colour_as_a_spectrum():
    """Reflectances by colours lie from 0 to 1 and have the colour again under D65; grey is flat."""
    nm = np.arange(380.0, 781.0, 5.0)
    colours = np.random.default_rng(1).uniform(0.02, 0.95, (300, 3))
    found = reflectances_of(colours, nm)
    assert found.min() > 0.0
    assert found.max() < 1.0
    light = d65(nm)
    white = rgb_from_spectrum(light, nm)
    np.testing.assert_allclose(rgb_from_spectrum(found * light, nm) / white, colours, atol=1e-3)
    edges = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]])
    seen = rgb_from_spectrum(reflectances_of(edges, nm) * light, nm) / white
    np.testing.assert_allclose(seen, edges, atol=5e-3)
    assert (reflectances_of([[0.4, 0.4, 0.4]], nm) == 0.4).all()


def test_ten_nanometres_are_enough_for_daylight():
    """Skies are solved each 10 nm: daylight so sampled errs by less than 0.1 %, 5 K."""
    fine = np.arange(360.0, 831.0, 5.0)
    for name in ("D50", "D65", "D75"):
        values, nm = illuminant(name)
        exact = eye_responses(np.interp(fine, nm, values), fine)
        coarse = eye_responses(np.interp(NM, nm, values), NM)
        np.testing.assert_allclose(coarse.edi_lx, exact.edi_lx, rtol=1e-3)
        np.testing.assert_allclose(coarse.illuminance_lx, exact.illuminance_lx, rtol=1e-3)
        kelvin = colour_temperature(exact.xyz).cct_k
        assert colour_temperature(coarse.xyz).cct_k == pytest.approx(kelvin, abs=5.0)
    assert len(RECEPTORS) == exact.edi_lx.shape[-1]
