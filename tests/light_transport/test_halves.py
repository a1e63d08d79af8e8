"""Light as halves: the same numbers as numpy's."""

import numpy as np
from light_transport.hour.halves import halves, largest


def test_halves_are_the_nearest_ones_at_every_size():
    """From subnormal halves to the largest, ties too; RGB by a factor, openness as it is."""
    rng = np.random.default_rng(0)
    light = np.exp2(rng.uniform(-30.0, 15.9, (64, 64, 4))).astype(np.float32)
    light[0, 0] = 0.0, 1.0 + 2.0**-11, 1.0 + 3.0 * 2.0**-11, 1.0
    expected = (light * np.array([0.5, 0.5, 0.5, 1.0], np.float32)).astype(np.float16)
    found = halves(light, 0.5)
    assert found.dtype == np.float16
    np.testing.assert_array_equal(found, expected)
    assert largest(light) == light[..., :3].max()


def test_what_is_too_large_for_a_half_is_the_largest_one():
    """A single glint must not make infinities."""
    assert (halves(np.full((1, 4), 1e6, np.float32), 1.0) == 65504.0).all()
