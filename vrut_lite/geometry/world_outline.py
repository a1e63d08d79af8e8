"""Land on maps of the world."""

from functools import lru_cache
from importlib.resources import as_file, files

import numpy as np
from numpy.typing import NDArray

_PER_DEGREE = 100.0


@lru_cache(maxsize=1)
def world_outline() -> list[NDArray[np.float64]]:
    """Rings (n, 2) of longitude and latitude in degrees (Natural Earth, 1:110 million)."""
    with as_file(files("vrut_lite.geometry").joinpath("data/world_outline.npz")) as path:
        stored = np.load(path)
        points, lengths = stored["points"] / _PER_DEGREE, stored["lengths"]
    return np.split(points, np.cumsum(lengths)[:-1])
