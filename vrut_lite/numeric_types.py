"""Types of numbers and arrays in signatures, and the tuple of a vector."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
Vector = tuple[float, float, float]
Matrix = tuple[tuple[float, float, float, float], ...]
Number = float | int


def vector(values: ArrayLike) -> Vector:
    """Three numbers as a tuple, for messages."""
    x, y, z = np.asarray(values, dtype=float).tolist()
    return x, y, z
