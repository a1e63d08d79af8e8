"""From picture values to a display, in numpy; shaders/tone_map.frag is the twin.

A picture value of 1 is the brightest within the exposure's range.

AgX (Troy Sobotka, 2022): rotate and compress the primaries, take the logarithm, apply a
sigmoid, rotate back. It lets bright colours go to white as film does, so that a red sun
does not turn yellow. Matrices and the sixth-degree fit of the sigmoid are those published
by Benjamin Wrensch, "Minimal AgX Implementation" (2023).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.geometry.colour import LUMINANCE_WEIGHTS, srgb_encode
from vrut_lite.messages.picture import ToneMap

INSET = np.array(
    [
        [0.842479062253094, 0.0784335999999992, 0.0792237451477643],
        [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
        [0.0423756549057051, 0.0784336, 0.879142973793104],
    ]
)
OUTSET = np.array(
    [
        [1.19687900512017, -0.0980208811401368, -0.0990297440797205],
        [-0.0528968517574562, 1.15190312990417, -0.0989611768448433],
        [-0.0529716355144438, -0.0980434501171241, 1.15107367264116],
    ]
)
DARKEST_LOG2, BRIGHTEST_LOG2 = -12.47393, 4.026069
# The "punchy" look of the same source, at half strength.
CONTRAST, SATURATION = 1.15, 1.2
# 1 - exp(-k L), as the papers show their skies (Bruneton and Neyret 2008; Hvezda 2020), with a
# k that keeps middle grey.
EXPONENTIAL_RATE = -np.log1p(-0.18) / 0.18
SIGMOID = (-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5)


def tone_mapped(picture: ArrayLike, curve: ToneMap = "agx") -> NDArray[np.float64]:
    """Display-encoded sRGB (..., 3) in [0, 1] of linear picture values (..., 3).

    "agx"; "exponential", 1 - exp(-k L); "none", which clamps at 1.
    """
    if curve == "agx":
        return agx(picture)
    values = np.maximum(np.asarray(picture, dtype=float), 0.0)
    return srgb_encode(-np.expm1(-EXPONENTIAL_RATE * values) if curve == "exponential" else values)


def agx(picture: ArrayLike) -> NDArray[np.float64]:
    """Display-encoded sRGB (..., 3) in [0, 1] of linear picture values (..., 3)."""
    compressed = np.asarray(picture, dtype=float) @ INSET.T
    logarithm = np.log2(np.maximum(compressed, 2.0**DARKEST_LOG2))
    x = np.clip((logarithm - DARKEST_LOG2) / (BRIGHTEST_LOG2 - DARKEST_LOG2), 0.0, 1.0)
    curve = np.maximum(np.polynomial.polynomial.polyval(x, SIGMOID), 0.0) ** CONTRAST
    grey = (curve @ LUMINANCE_WEIGHTS)[..., None]
    return np.clip((grey + SATURATION * (curve - grey)) @ OUTSET.T, 0.0, 1.0)
