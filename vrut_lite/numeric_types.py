"""Types of numbers and arrays in signatures."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
Vector = tuple[float, float, float]
Matrix = tuple[tuple[float, float, float, float], ...]
Number = float | int
