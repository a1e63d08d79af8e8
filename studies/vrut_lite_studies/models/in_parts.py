"""Many directions, a few at a time: so that a picture needs no more memory than a list."""

from collections.abc import Callable

import numpy as np

from vrut_lite.numeric_types import FloatArray

_DIRECTIONS_EACH = 2048


def in_parts(function: Callable[..., FloatArray], *directions: FloatArray) -> FloatArray:
    """What a function makes (n, C) of arrays of directions (n, ...)."""
    parts = -(-len(directions[0]) // _DIRECTIONS_EACH)
    pieces = zip(*(np.array_split(each, max(parts, 1)) for each in directions), strict=True)
    return np.concatenate([function(*piece) for piece in pieces])
