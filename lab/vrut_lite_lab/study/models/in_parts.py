"""Functions of many directions, evaluated in parts to bound the memory of a picture."""

from collections.abc import Callable

import numpy as np

from vrut_lite.numeric_types import FloatArray

_DIRECTIONS_EACH = 2048


def in_parts(function: Callable[..., FloatArray], *directions: FloatArray) -> FloatArray:
    """A function's values (n, C) for arrays of directions (n, ...), computed part by part."""
    parts = -(-len(directions[0]) // _DIRECTIONS_EACH)
    pieces = zip(*(np.array_split(each, max(parts, 1)) for each in directions), strict=True)
    return np.concatenate([function(*piece) for piece in pieces])
