"""The share of the sky's light that arrives, as bytes of a few components."""

import numpy as np
import pytest
from share.sky_shares import COMPONENTS, decoded, sky_shares


def test_shares_of_windows_that_face_different_skies_are_kept():
    """A fifth of a hundred texels behind each of five windows, to 0.006 of the sky; deep ones too,
    by their own mean; texels without sky have none at any hour."""
    random = np.random.default_rng(4)
    turn = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    towards = np.repeat(np.arange(5) * 2.0 * np.pi / 5, 20)
    open_to = 10.0 ** random.uniform(-3.0, -0.2, 100)
    open_to[::10] = 0.0
    seen = open_to * (1.0 + 0.6 * np.cos(turn[:, None] - towards))
    found = sky_shares(seen.astype(np.float16), turn < np.pi)
    assert found.components.shape == (COMPONENTS, 100)
    for place in range(60):
        made = found.of(found.weights[place])
        assert made == pytest.approx(seen[place], abs=0.006)
        assert made == pytest.approx(seen[place], rel=0.05, abs=2e-4)
        assert not made[::10].any()


def test_no_steps_show_on_a_wall_deep_inside():
    """Shares of 0.2 to 1 % change evenly along it, to 1 %, though one texel is hardly lit."""
    turn = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    seen = np.geomspace(0.002, 0.01, 200) * (1.0 + 0.3 * np.cos(turn[:, None]))
    seen[:, -1], seen[3, -1] = 0.0, 0.004
    found = sky_shares(seen.astype(np.float16), turn < np.pi)
    for place in range(0, 60, 7):
        off = found.of(found.weights[place])[:-1] / seen[place, :-1]
        assert np.abs(np.diff(off)).max() < 0.01


def test_bytes_stand_for_values_finer_around_zero():
    values = decoded(np.arange(-127, 128).astype(np.int8))
    assert values[[0, 127, -1]].tolist() == [-1.0, 0.0, 1.0]
    steps = np.diff(values)
    assert np.all(steps > 0.0)
    assert steps[127] < 0.1 * steps[-1]
