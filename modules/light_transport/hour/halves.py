"""Values as halves, in one pass: numpy converts one by one and makes an array for each step."""

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import kernel
from vrut_lite.numeric_types import Float32Array

_LARGEST = np.float32(65504.0)
_ONE_HALF = np.float32(0.5)
# Bits of a float32: half an ulp of a half less one, the change of the exponent's bias, and the
# smallest float whose half is a normal number.
_ROUND, _REBIAS, _NORMAL = np.int32(0x0FFF), np.int32(112 << 23), np.int32(113 << 23)
_BITS_OF_ONE_HALF, _SHIFT, _ONE = np.int32(126 << 23), np.int32(13), np.int32(1)


def halves(light: Float32Array, factor: float) -> NDArray[np.float16]:
    """Light (..., 4), not negative, as halves, RGB times `factor`, at most 65504."""
    out = np.empty(light.shape, np.uint16)
    _fill(np.ascontiguousarray(light).reshape(-1), np.float32(factor), out.reshape(-1))
    return out.view(np.float16)


def largest(light: Float32Array) -> float:
    """The largest RGB of light (..., 4); 0 for an empty array."""
    return float(_largest(np.ascontiguousarray(light).reshape(-1)))


@kernel
def _fill(light, factor, out):  # type: ignore[no-untyped-def]
    """The nearest halves, ties to even."""
    for i in range(len(light)):
        x = min(light[i] * (factor if i & 3 != 3 else np.float32(1.0)), _LARGEST)
        bits = np.float32(x).view(np.int32)
        normal = (bits - _REBIAS + _ROUND + ((bits >> _SHIFT) & _ONE)) >> _SHIFT
        # 0.5 has the ulp of subnormal halves, so the sum rounds correctly.
        subnormal = np.float32(x + _ONE_HALF).view(np.int32) - _BITS_OF_ONE_HALF
        out[i] = np.uint16(normal if bits >= _NORMAL else subnormal)


@kernel
def _largest(light):  # type: ignore[no-untyped-def]
    most = np.float32(0.0)
    for i in range(0, len(light), 4):
        most = max(most, light[i], light[i + 1], light[i + 2])
    return most
