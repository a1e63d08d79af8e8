"""White balance: whites by colour temperature, and what becomes of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.geometry.colour import SRGB_FROM_XYZ, luminance
from vrut_lite.pictures.white_balance import white_balance_matrix, white_xyz

TEMPERATURES = st.floats(1700.0, 25000.0)


@pytest.fixture
def colour():
    """Colour-science's package, which takes long to import."""
    return pytest.importorskip("colour")


def xy(xyz):
    return xyz[:2] / xyz.sum()


@pytest.mark.parametrize("temperature_k", [4000.0, 5000.0, 6504.0, 9300.0, 20000.0])
def test_whites_lie_on_the_daylight_locus(colour, temperature_k):
    """Chromaticities of CIE 15's daylight, against colour-science: to 1e-6."""
    expected = colour.temperature.CCT_to_xy_CIE_D(temperature_k)
    np.testing.assert_allclose(xy(white_xyz(temperature_k)), expected, atol=1e-6)


def test_warm_whites_are_near_the_black_body():
    """Below 4000 K there is no daylight; a lamp of 2856 K (CIE A) is near, to 0.007 in x, y."""
    np.testing.assert_allclose(xy(white_xyz(2856.0)), [0.44758, 0.40745], atol=0.009)


def test_daylight_leaves_colours_as_they_are():
    """6504 K is the white of sRGB: the matrix is the identity."""
    np.testing.assert_allclose(white_balance_matrix(6504.0), np.eye(3), atol=1e-12)


@given(TEMPERATURES, st.floats(-0.02, 0.02))
def test_the_chosen_white_becomes_neutral_and_keeps_its_luminance(temperature_k, duv):
    """The white itself turns to equal parts, as bright as before: what the control promises."""
    white = SRGB_FROM_XYZ @ white_xyz(temperature_k, duv)
    shown = white_balance_matrix(temperature_k, duv) @ white
    neutral = SRGB_FROM_XYZ @ white_xyz(6504.0)
    np.testing.assert_allclose(shown, neutral, atol=1e-9)
    assert luminance(shown) == pytest.approx(1.0, abs=1e-6)


def test_the_locus_has_no_jump_where_daylight_begins():
    """Dragged across 4000 K, the picture must not flash."""
    np.testing.assert_allclose(white_xyz(3999.99), white_xyz(4000.01), atol=1e-5)


def test_duv_leads_towards_green_by_its_distance(colour):
    """Duv is a distance in the (u, v) of CIE 1960; a greener white leaves a pinker picture."""
    uv = [colour.xy_to_UCS_uv(xy(white_xyz(6504.0, duv))) for duv in (0.0, 0.01)]
    assert np.linalg.norm(uv[1] - uv[0]) == pytest.approx(0.01, rel=1e-6)
    shown = white_balance_matrix(6504.0, 0.01) @ np.ones(3)
    assert shown[1] < min(shown[0], shown[2])


def test_a_warmer_white_leaves_a_bluer_picture():
    """Who says that 3000 K is white wants the lamp's orange gone."""
    red, _, blue = white_balance_matrix(3000.0) @ np.ones(3)
    assert blue > 1.5 * red


def test_a_temperature_without_a_white_is_refused():
    """The formulas end there."""
    with pytest.raises(ValueError, match="1700 to 25000 K"):
        white_xyz(1000.0)
