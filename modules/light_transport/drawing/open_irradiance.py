"""The open sky's irradiance as a table by direction: a look-up costs less than 25 harmonics.

The table is the surface of an octahedron, unfolded into a square (Praun and Hoppe 2003, "Spherical
Parametrization and Remeshing"). Its outermost nodes lie on the folds themselves, each direction
there twice, so that linear look-ups are continuous everywhere.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.numeric_types import Float32Array, FloatArray

# Linear interpolation errs by 0.3 % of the harmonics of band 4, which are a few percent of all.
NODES = 65


def open_irradiance(irradiance_sh: NDArray) -> Float32Array:
    """Irradiance (n, n, 3) of planes by harmonics (25, 3).

    Columns run along x of the plane's normal, rows along z; y is up, in the middle.
    """
    return evaluate_irradiance(irradiance_sh, _normals()).astype(np.float32)


@lru_cache(maxsize=1)
def _normals() -> FloatArray:
    """Unit vectors (n, n, 3) of the nodes."""
    x, z = np.meshgrid(*2 * [np.linspace(-1.0, 1.0, NODES)])
    y = 1.0 - np.abs(x) - np.abs(z)
    # Below the middle the corners are folded in.
    folded_x = (1.0 - np.abs(z)) * np.where(x < 0.0, -1.0, 1.0)
    folded_z = (1.0 - np.abs(x)) * np.where(z < 0.0, -1.0, 1.0)
    normals = np.stack([np.where(y < 0.0, folded_x, x), y, np.where(y < 0.0, folded_z, z)], axis=-1)
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)
