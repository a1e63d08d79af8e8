"""Spherical harmonics, colour and half-precision encoding."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from vrut_lite.geometry import colour as light_colour
from vrut_lite.geometry.cube_map import texel_directions, texel_solid_angles
from vrut_lite.geometry.encoding import decode_float16, encode_float16
from vrut_lite.geometry.spherical_harmonics import (
    basis,
    evaluate_irradiance,
    horizontal_irradiance,
    irradiance_coefficients,
)

SHARED = Path(__file__).parents[3] / "shared" / "data" / "clear_sky_framework_reference.npz"


def test_the_basis_is_orthonormal():
    """25 real harmonics, integrated over the sphere pairwise: the identity within 2e-4."""
    size = 64
    values = basis(texel_directions(size))
    gram = np.einsum("fijk,fijl,ij->kl", values, values, texel_solid_angles(size))
    np.testing.assert_allclose(gram, np.eye(25), atol=2e-4)


def test_irradiance_of_a_uniform_sky_is_pi_times_its_radiance():
    """E = pi L for every normal, the analytic value."""
    coefficients = irradiance_coefficients(np.full((6, 32, 32, 3), 2.0))
    normals = np.random.default_rng(1).normal(size=(100, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    np.testing.assert_allclose(evaluate_irradiance(coefficients, normals), 2 * np.pi, rtol=1e-4)


def test_irradiance_of_a_half_lit_sphere():
    """Radiance 1 above the horizon: E(n) = pi (1 + n_y) / 2, within the bands' 1.5 %."""
    cube = np.where(texel_directions(64)[..., 1:2] > 0, 1.0, 0.0) * np.ones(3)
    normals = np.random.default_rng(2).normal(size=(500, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    expected = np.pi * (1 + normals[:, 1:2]) / 2
    found = evaluate_irradiance(irradiance_coefficients(cube), normals)
    assert np.abs(found - expected).max() < 0.015 * np.pi
    np.testing.assert_allclose(horizontal_irradiance(cube), np.pi, rtol=2e-4)


@pytest.mark.parametrize("power", [1, 2, 4])
def test_irradiance_against_the_sum_over_all_texels(power):
    """A lobe around a tilted direction: harmonics against the cosine-weighted sum, 2 % of max."""
    axis = np.array([0.48, 0.6, -0.64])
    directions = texel_directions(64)
    cube = np.maximum(directions @ axis, 0.0)[..., None] ** power * np.ones(3)
    normals = np.random.default_rng(3).normal(size=(200, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    cosine = np.maximum(np.einsum("nk,fijk->nfij", normals, directions), 0.0)
    truth = np.einsum("nfij,fijc,ij->nc", cosine, cube, texel_solid_angles(64))
    found = evaluate_irradiance(irradiance_coefficients(cube), normals)
    assert np.abs(found - truth).max() < 0.02 * truth.max()


def test_the_observer_is_the_cies():
    """Our table against colour-science's, each 5 nm, and the srgb matrix against IEC 61966-2-1."""
    # Takes longer to import than all else that is collected here.
    import colour

    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    table = light_colour.colour_table()
    np.testing.assert_allclose(table[:, 1:4], [observer[w] for w in table[:, 0]], atol=1e-9)
    theirs = colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB
    np.testing.assert_allclose(light_colour.SRGB_FROM_XYZ, theirs, atol=2e-3)


def test_an_equal_energy_spectrum_is_integrated_as_colour_science_does():
    """XYZ of S(lambda) = 1 over 360 to 830 nm is (1, 1, 1) times 106.86 nm, within 1e-3."""
    table = light_colour.colour_table()
    rgb = light_colour.rgb_from_spectrum(np.ones(95), table[:, 0])
    np.testing.assert_allclose(np.linalg.solve(light_colour.SRGB_FROM_XYZ, rgb), 106.86, rtol=1e-3)


def test_three_samples_of_skylight_make_the_colour_of_its_whole_spectrum():
    """A spectrum of the assumed shape, sun times lambda^-3, is exact; lambda^-4 within 5 %."""
    table = light_colour.colour_table()
    nm = table[:, 0]
    three = np.array([680.0, 550.0, 440.0])
    for exponent, tolerance in ((3.0, 1e-12), (4.0, 0.05)):
        whole = light_colour.rgb_from_spectrum(table[:, 4] * (nm / 550) ** -exponent, nm)
        samples = light_colour.solar_irradiance(three) * (three / 550) ** -exponent
        found = light_colour.rgb_from_spectrum(samples, three)
        np.testing.assert_allclose(found, whole, rtol=tolerance)


def test_two_wavelengths_make_no_colour():
    """Fewer than three and four to seven samples are refused."""
    with pytest.raises(ValueError, match="3 wavelengths, or 8"):
        light_colour.rgb_from_spectrum(np.ones(5), np.linspace(400, 700, 5))


@pytest.mark.skipif(not SHARED.exists(), reason="reference spectra of the evaluation framework")
def test_the_sun_is_that_of_the_evaluation_framework():
    """Both are ASTM G-173: our 5 nm means against its 11.75 nm ones, in luminance within 0.5 %."""
    reference = np.load(SHARED)
    nm, theirs = reference["wavelengths_nm"], reference["solar_spectrum"]
    ours = light_colour.solar_irradiance(nm + 5.875)
    y = light_colour.LUMINANCE_WEIGHTS
    their_y = y @ light_colour.rgb_from_spectrum(theirs, nm + 5.875)
    our_y = y @ light_colour.rgb_from_spectrum(ours, nm + 5.875)
    assert our_y == pytest.approx(their_y, rel=5e-3)


@pytest.mark.parametrize("brightness", [1e-28, 1e-34, 1e-38, 1e-42, 1e-45, 0.0])
def test_no_darkness_is_too_dark_for_half_precision(brightness):
    """Scale and inverse are float32 numbers, as in shaders; values too dark become zero."""
    radiance = np.array([brightness, 0.5 * brightness], np.float32)
    encoded, scale = encode_float16(radiance)
    assert np.isfinite(np.float32(1.0) / np.float32(scale))
    np.testing.assert_allclose(decode_float16(encoded, scale), radiance, rtol=2e-3, atol=1e-37)


def test_a_cube_is_encoded_as_numpy_rounds():
    """Cubes are converted by compiled code: bit for bit the nearest half, subnormal ones too."""
    rng = np.random.default_rng(4)
    cube = (2.0 ** rng.uniform(-45.0, 0.0, (6, 64, 64, 3))).astype(np.float32)
    cube[0, 0, :9] = 0.0
    encoded, scale = encode_float16(cube)
    exact = (cube * np.float32(1.0 / scale)).astype(np.float16)
    np.testing.assert_array_equal(encoded.view(np.uint16), exact.view(np.uint16))


@settings(deadline=None)
@given(
    arrays(np.float32, (4, 3), elements=st.floats(0, 1, width=32)),
    st.floats(-30, 30).map(lambda e: 2.0**e),
)
def test_half_precision_keeps_eleven_bits_at_any_brightness(values, brightness):
    """From the night sky to the sun: half a step of 2^-11, 2^-39 of the largest, or 2^-125."""
    radiance = values.astype(np.float64) * brightness
    encoded, scale = encode_float16(radiance)
    assert np.isfinite(encoded).all()
    assert np.frexp(scale)[0] == 0.5
    error = np.abs(decode_float16(encoded, scale) - radiance)
    step = np.maximum(radiance * 2.0**-11, radiance.max() * 2.0**-38)
    assert (error <= np.maximum(step, 2.0**-125)).all()
