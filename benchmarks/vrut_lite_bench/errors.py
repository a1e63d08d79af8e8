"""How errors are counted: one norm for every picture."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite_bench.path import Errors

FLOOR = 1e-3
PICTURE_NORM = (
    "difference over the larger of the value and a thousandth of the picture's maximum, "
    "each channel; 99th percentile over the picture"
)


def relative_errors(found: NDArray[Any], exact: NDArray[Any], floor: float = FLOOR) -> Errors:
    """Errors of a picture relative to the larger of each value and `floor` times the maximum."""
    right = np.asarray(exact, dtype=float)
    least = floor * float(right.max())
    return sizes_of(np.abs(np.asarray(found, dtype=float) - right) / np.maximum(right, least))


def sizes_of(errors: NDArray[Any]) -> Errors:
    """Mean, 99th percentile and largest."""
    return Errors(float(errors.mean()), float(np.quantile(errors, 0.99)), float(errors.max()))
