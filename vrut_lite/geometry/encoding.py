"""Half-precision cube maps with a power-of-two scale.

Night skies lie below half precision's normal range and bright ones near its top, so the
scale moves the largest value to [2^14, 2^15): every value down to 2^-28 of it keeps 11 bits.
"""

import numpy as np
from numpy.typing import NDArray

_TOP_EXPONENT = 15


def encode_float16(radiance: NDArray[np.floating]) -> tuple[NDArray[np.float16], float]:
    """Values as float16 and the scale that brings them back: radiance = values * scale."""
    largest = float(radiance.max())
    exponent = int(np.frexp(largest)[1]) - _TOP_EXPONENT if largest > 0 else 0
    scale = float(2.0**exponent)
    return (radiance * (1.0 / scale)).astype(np.float16), scale


def decode_float16(values: NDArray[np.float16], scale: float) -> NDArray[np.float32]:
    """Radiance (float32) of encoded values."""
    return values.astype(np.float32) * np.float32(scale)
