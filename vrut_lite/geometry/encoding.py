"""Half-precision cube maps with a power-of-two scale.

Night skies lie below half precision's normal range and bright ones near its top, so the
scale moves the largest value to [2^14, 2^15): every value down to 2^-28 of it keeps 11 bits.
Scales stay above 2^-100, so that they and their inverses are float32. Values too dark for that,
below 1e-12 of starlight, lose bits and become zero.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.encoding_kernel import to_halves

_TOP_EXPONENT, _LOWEST_EXPONENT = 15, -100
# Numbers from which on the compiled conversion is worth its import: a cube of 64.
_WORTH_COMPILING = 6 * 64 * 64 * 3


def float16_scale(largest: float) -> float:
    """The power of two by which radiance up to `largest` is divided before it becomes float16."""
    exponent = int(np.frexp(largest)[1]) - _TOP_EXPONENT if largest > 0 else 0
    return float(2.0 ** max(exponent, _LOWEST_EXPONENT))


def encode_float16(radiance: NDArray[np.floating]) -> tuple[NDArray[np.float16], float]:
    """Values as float16 and their scale: radiance = values * scale."""
    scale = float16_scale(float(radiance.max()))
    if radiance.size < _WORTH_COMPILING or radiance.dtype != np.float32 or radiance.min() < 0.0:
        return (radiance * (1.0 / scale)).astype(np.float16), scale
    halves = np.empty(radiance.shape, np.float16)
    bits = halves.reshape(-1).view(np.uint16)
    to_halves(np.ascontiguousarray(radiance).reshape(-1), np.float32(1.0 / scale), bits)
    return halves, scale


def decode_float16(values: NDArray[np.float16], scale: float) -> NDArray[np.float32]:
    """Radiance (float32) of encoded values."""
    return values.astype(np.float32) * np.float32(scale)
