"""The rungs of the air's reach, and the transmittance of three channels."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.atmosphere.air_colour import lost_and_depth, shares_of_white
from vrut_lite.geometry.colour import (
    SKYLIGHT_NM,
    colour_table,
    integration_matrix,
    solar_irradiance,
)
from vrut_lite.sky.air_reach import rung_m


@given(needed=st.floats(1.0, 1e9), shown=st.sampled_from([0.0, 10.0, 640.0, 1e5, 1e12]))
def test_a_rung_holds_what_is_needed(needed: float, shown: float) -> None:
    """The reach is at least what is needed and, above the first rung, at most 1.1 * sqrt(2)
    times as far."""
    reach = rung_m(needed, shown)
    assert needed * (1.0 - 1e-9) <= reach <= max(needed * 1.1 * np.sqrt(2.0) * (1.0 + 1e-9), 1.0)


def test_rungs_do_not_flicker() -> None:
    """A need that varies by 5 % about a rung's edge keeps the reach; no need gives 0."""
    edge = rung_m(1000.0)
    reach, seen = 0.0, []
    for factor in (0.98, 1.02, 0.97, 1.03, 0.98, 1.0):
        reach = rung_m(edge * factor, reach)
        seen.append(reach)
    assert len(set(seen[1:])) == 1
    assert rung_m(edge * 0.8, reach) < reach
    assert rung_m(0.0, reach) == 0.0


def test_channels_follow_the_spectrum() -> None:
    """Sunlight off a grey surface, seen through molecules and haze of any depth, must have the
    transmittance of its red, green and blue by 95 wavelengths: within 0.004, and within 1.5 %
    where it is 0.1 or more. In deep air blue leaves the gamut and counts as zero. The
    haze's spectrum is Angstrom's, wavelength^-1.3; up to ten times the molecules at 550 nm."""
    nm = colour_table()[:, 0]
    sun = solar_irradiance(nm)
    colour = integration_matrix(tuple(nm))
    shares = shares_of_white(SKYLIGHT_NM, solar_irradiance(SKYLIGHT_NM))
    for haze in (0.0, 1.0, 10.0):
        for depth_at_550 in np.geomspace(1e-6, 5.0, 30):

            def depth(w: np.ndarray, haze: float = haze, d: float = depth_at_550) -> np.ndarray:
                return d * ((w / 550.0) ** -4 + haze * (w / 550.0) ** -1.3) / (1.0 + haze)

            truth = (sun * np.exp(-depth(nm))) @ colour / (sun @ colour)
            lost, found = lost_and_depth(-np.expm1(-depth(np.array(SKYLIGHT_NM))), shares)
            assert np.exp(-found) == pytest.approx(np.maximum(truth, 0.0), abs=4e-3)
            clear = truth > 0.1
            assert np.exp(-found)[clear] == pytest.approx(truth[clear], rel=1.5e-2)
            assert lost == pytest.approx(-np.expm1(-found), rel=1e-6)


def test_channels_stay_finite_in_opaque_and_precise_in_thin_air() -> None:
    """In opaque air negative weights must not give a negative transmittance or an infinite
    depth; thin air keeps its relative precision."""
    shares = shares_of_white(SKYLIGHT_NM, solar_irradiance(SKYLIGHT_NM))
    _, depth = lost_and_depth(
        np.array([[0.5, 0.9, 0.999, 1.0], [1.0] * 4, [1.0 - 1e-9] * 4]), shares
    )
    assert np.all(np.isfinite(depth))
    assert np.all(depth > 0.0)
    _, thin = lost_and_depth(np.full(4, 1e-9), shares)
    assert thin == pytest.approx(1e-9, rel=1e-6)
