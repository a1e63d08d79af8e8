"""A density whose scale height changes by layers, and the standard atmosphere by it."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from vrut_lite.atmosphere.clear_air import COLUMN_M, molecule_density
from vrut_lite.atmosphere.exponential_layers import ExponentialLayers

HEIGHTS_M = st.floats(200.0, 5e4)


@given(
    HEIGHTS_M,
    st.lists(st.tuples(st.floats(10.0, 2e4), HEIGHTS_M), max_size=6),
    st.floats(-2e3, 6e4),
)
def test_densities_are_continuous_and_their_columns_exact(ground_m, steps, raised_m):
    """At every base both layers agree, a column is its integral, and a raised ground cuts it."""
    bases_m = np.cumsum([step for step, _ in steps])
    layers = ExponentialLayers.of(ground_m, list(zip(bases_m, (h for _, h in steps), strict=True)))
    below, above = layers.density(np.nextafter(bases_m, 0.0)), layers.density(bases_m)
    np.testing.assert_allclose(below, above, rtol=1e-9)
    assert layers.density(0.0) == 1.0
    top_m = 8e4
    kinks = sorted({b for b in bases_m if b < top_m})
    edges = [0.0, *kinks, top_m]
    for power in (1.0, 2.0):
        whole = sum(
            quad(lambda h, p=power: float(layers.density(h)) ** p, a, b, epsrel=1e-10)[0]
            for a, b in pairwise(edges)
        )
        assert layers.column_m(top_m, power) == pytest.approx(whole, rel=1e-6)
    raised, there = layers.raised(raised_m)
    at_m = np.array([0.0, 100.0, 3e3, 5e4])
    np.testing.assert_allclose(
        there * raised.density(at_m), layers.density(at_m + raised_m), rtol=1e-8, atol=1e-300
    )


def test_the_standard_air_is_the_standard_atmosphere():
    """U.S. Standard Atmosphere 1976, table I: density over that on the ground, by geometric
    altitude; its column is the pressure on the ground over the mean gravity above it."""
    kg_m3 = {
        1e3: 1.1117, 2e3: 1.0066, 4e3: 0.81935, 6e3: 0.66011, 8e3: 0.52579, 10e3: 0.41351,
        12e3: 0.31194, 15e3: 0.19476, 20e3: 0.088910, 25e3: 0.040084, 30e3: 0.018410,
        40e3: 0.0039957, 50e3: 0.0010269, 60e3: 3.0968e-4, 70e3: 8.2829e-5, 80e3: 1.8458e-5,
    }  # fmt: skip
    altitude_m = np.array(list(kg_m3))
    error = molecule_density(altitude_m) * 1.225 / np.array(list(kg_m3.values())) - 1.0
    assert np.abs(error[altitude_m <= 12e3]).max() < 2.5e-3
    assert np.abs(error[altitude_m <= 50e3]).max() < 6.5e-3
    assert np.abs(error).max() < 2e-2
    # Gravity falls by 2 h / R at the mean height 7.4 km of the air.
    assert pytest.approx(101_325.0 / (1.225 * 9.80665) * (1.0 + 2.0 * 7.4 / 6357.0), rel=1e-3) == (
        COLUMN_M
    )
