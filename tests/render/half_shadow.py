"""The light across the edge of a shadow, beside that of the sun's disc."""

import numpy as np

# From 10 to 90 % of an even disc's light, in half widths of the penumbra.
DISC_WIDTH = 2.0 * 0.687


def half_shadow(picture, t, within):
    """Shares of the light (31,) from -1.5 to 1.5 half widths, and the width from 10 to 90 %.

    `t` (h, w) is how far each pixel lies from the edge, in half widths; those `within` count for a
    share. Beyond two half widths all is even: dark on one side, lit on the other.
    """
    lit, shaded = picture[t > 2.0], picture[t < -2.0]
    if lit.mean() < shaded.mean():
        t, lit, shaded = -t, shaded, lit
    np.testing.assert_array_equal(shaded, 0.0)
    np.testing.assert_allclose(lit, lit.mean(), rtol=2e-3)
    rows = np.linspace(-1.5, 1.5, 31)
    share = np.array([picture[abs(t - row) < within].mean() for row in rows]) / lit.mean()
    return share, np.ptp(np.interp([0.1, 0.9], share, rows))
