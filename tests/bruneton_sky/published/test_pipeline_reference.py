"""The twin of the thesis's pipeline against Bruneton's own run: every array of every order."""

import numpy as np
import pytest
from bruneton_reference import STEPS, reference, twin_run


def assert_same(ours, truth) -> None:
    """1e-6 of each value, or 1e-12 of the largest; quicker than `pytest.approx` of large arrays."""
    assert np.all(np.abs(ours - truth) <= np.maximum(1e-6 * np.abs(truth), 1e-12 * truth.max()))


@pytest.mark.long
@pytest.mark.parametrize(("name", "order", "entry"), STEPS)
def test_every_step_is_brunetons(name: str, order: int, entry: str) -> None:
    """1e-6 of each value, and 1e-12 of the largest: bruneton_reference_small.npz.

    The second lets pass what his subtraction of radii leaves of nothing: light from above the
    top, and twelve cells of the second order fourteen orders of magnitude below the brightest.
    """
    assert_same(twin_run()[1][name, order], reference()[entry])


@pytest.mark.parametrize("name", ["transmittance", "irradiance", "scattering", "single_mie"])
def test_the_tables_are_brunetons(name: str) -> None:
    """The four tables that are kept, to the same tolerance."""
    assert_same(getattr(twin_run()[0], name), reference()[name])


def test_the_observer_hears_every_step_once() -> None:
    """All steps, in the order in which they are made, and nothing else."""
    assert list(twin_run()[1]) == [(name, order) for name, order, _ in STEPS]


def test_nothing_is_negative() -> None:
    """Light adds up: no step may make a value below zero."""
    assert all(np.all(array >= 0) for array in twin_run()[1].values())
