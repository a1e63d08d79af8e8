"""How unsteady a film is: what is smooth does not count, what jumps does."""

import numpy as np

from vrut_lite_lab.path_traced.light_film import Unsteadiness

FRAMES, SEEN = 61, np.ones((2, 2), bool)


def film(light):
    """Grey frames (T, 2, 2, 3) of a light (T,), steady but for the first pixel."""
    frames = np.full((len(light), 2, 2, 3), 5.0, np.float32)
    frames[:, 0, 0] = np.asarray(light)[:, None]
    return frames


def test_light_that_grows_evenly_is_steady():
    """A straight line has steps and no second difference; a slow bow is smooth."""
    times = np.linspace(0.0, 1.0, FRAMES)
    line = Unsteadiness(film(5.0 + times), SEEN)
    assert line.step[0, 0] > 2e-3
    assert line.second.max() < 1e-6
    bow = Unsteadiness(film(5.0 + times**2), SEEN)
    np.testing.assert_allclose(bow.second, bow.smooth, atol=1e-6)
    assert bow.left.max() < 1e-6


def test_a_jump_is_found_where_it_is():
    """One frame that is a tenth brighter: its pixel is unsteady, the others are not."""
    light = np.full(FRAMES, 5.0)
    light[30] *= 1.1
    found = Unsteadiness(film(light), SEEN)
    share = 0.5 / (light.mean() + 0.5)
    expected = share * np.sqrt(6.0 / (FRAMES - 2))
    np.testing.assert_allclose(found.second[0, 0], expected, rtol=0.02)
    assert found.second.ravel()[1:].max() == 0.0
    assert found.left[0, 0] > 5.0 * found.smooth[0, 0]
