"""Coefficients of the sun's places in steps of two bytes."""

import numpy as np
import pytest
from share.sun_coefficients import sun_coefficients


def coefficients(places=40, clusters=5, terms=8, seed=2):
    """A first coefficient that changes little from place to place, and weak ones of either sign;
    the sign of a cluster's first map is as its eigenvector came out."""
    random = np.random.default_rng(seed)
    values = random.normal(size=(places, clusters, terms, 3)) * 0.1
    values[:, :, 0] = 2.0 + 0.2 * np.sin(np.arange(places))[:, None, None]
    values[:, ::2] *= -1.0
    return values.astype(np.float32)


def test_codes_leave_the_same_noise_in_the_light_of_each_term():
    """Half a step of a 2048th of the first term's light, so a dim cluster or term loses no more."""
    values, spread = coefficients(), np.array([1000.0, *np.geomspace(90.0, 3.0, 7)])
    values[:, 3] *= 1e-4
    error = np.abs(sun_coefficients(values, np.tile(spread, (5, 1))).decoded() - values)
    first = spread[0] * np.sqrt(np.square(values[:, :, 0]).mean(axis=(0, 2)))
    noise = error.max(axis=(0, 3)) * spread
    assert np.all(noise < 0.52 * first[:, None] / 2048.0)
    assert np.all(noise[:, 1:] > 0.3 * first[:, None] / 2048.0)


SAME = np.ones((5, 8))


def test_a_coefficient_far_above_the_others_fits_into_two_bytes():
    """Steps widen then: the largest change from place to place, to and fro, is kept."""
    values = coefficients()
    values[7, 1, 2] = 3e4
    values[8, 1, 2] = -3e4
    found = sun_coefficients(values, SAME).decoded()
    assert found[7:9, 1, 2] == pytest.approx(values[7:9, 1, 2], rel=1e-3)


def test_a_cluster_without_light_has_none():
    values = coefficients()
    values[:, 2] = 0.0
    found = sun_coefficients(values, SAME).decoded()
    assert np.all(found[:, 2] == 0.0)
    assert np.isfinite(found).all()
