"""The noise of clouds is periodic without a seam, and determined by its seed."""

import numpy as np
import pytest
from clouds.noise import detail_volume, shape_volume, weather_map
from clouds.noise_kernels import perlin, worley
from hypothesis import given
from hypothesis import strategies as st

places = st.lists(
    st.tuples(*[st.floats(-2.0, 3.0)] * 3), min_size=1, max_size=4
).map(np.array)  # fmt: skip


@given(places, st.integers(1, 9), st.integers(0, 10**6), st.tuples(*[st.integers(-3, 3)] * 3))
def test_noise_repeats(at, cells, seed, shift):
    """Places a whole period apart have equal noise, so that textures have no seams."""
    for noise in (perlin, worley):
        there = noise(at + np.array(shift, float), cells, seed)
        np.testing.assert_allclose(there, noise(at, cells, seed), atol=1e-9)


def test_worley_is_the_nearest_point():
    """1 - distance to the nearest point, compared with brute force over three periods."""
    from clouds.noise_kernels import feature_points

    cells, seed = 4, 7
    points = feature_points(cells, seed).reshape(-1, 3)
    shifts = cells * np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 1, 3)
    every = (points + shifts).reshape(-1, 3)
    at = np.random.default_rng(3).random((50, 3))
    nearest = np.linalg.norm(cells * at[:, None] - every, axis=-1).min(axis=1)
    np.testing.assert_allclose(worley(at, cells, seed), np.maximum(1.0 - nearest, 0.0), atol=1e-12)


def test_weather_is_spread_evenly():
    """Weather is uniformly distributed, so a threshold is a share of the sky."""
    values = weather_map(5, size=64)
    assert np.histogram(values, 4, (0, 65536))[0] == pytest.approx(64 * 64 / 4, rel=2e-3)


@pytest.mark.parametrize("volume", [shape_volume, detail_volume, weather_map])
def test_each_seed_gives_its_own_noise(volume):
    """The same seed gives the same bytes, another seed others."""
    assert np.array_equal(volume(1, size=16), volume(1, size=16))
    assert not np.array_equal(volume(1, size=16), volume(2, size=16))
    assert volume(1, size=16).std() > 20
