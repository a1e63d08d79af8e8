"""Compiled look-up of a sky-view table for every texel of a cube map.

Importing this module imports numba: do it only where the first cube is filled.
"""

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def fill_faces(  # type: ignore[no-untyped-def]
    table, sun, phase, axes, centres, ground, cube
):
    """Fill cube (6, n, n, 3) from a table (rows, columns, 2, 3); see `sky_view.fill_cube`.

    A row of texels is all sky or all ground: no face has a vertical s axis.
    """
    for face in range(6):
        for i in range(centres.size):
            row = axes[0, face] + centres[i] * axes[2, face]
            for j in range(centres.size):
                if row[1] < 0.0:
                    cube[face, i, j, :] = ground
                else:
                    x = row[0] + centres[j] * axes[1, face, 0]
                    z = row[2] + centres[j] * axes[1, face, 2]
                    _look_up(table, sun, phase, x, row[1], z, cube[face, i, j])


@njit(cache=True, nogil=True, error_model="numpy")
def _look_up(table, sun, phase, x, y, z, out):  # type: ignore[no-untyped-def]
    """Radiance in the direction (x, y, z), which need not have unit length."""
    across = x * sun[0] + z * sun[2]
    level_squared = x * x + z * z
    inverse = 1.0 / math.sqrt(level_squared + y * y)
    nu = (across + y * sun[1]) * inverse
    width = math.sqrt(level_squared * (sun[0] * sun[0] + sun[2] * sun[2]))
    # At the zenith, or under a sun there, no azimuth matters.
    cos_phi = across / width if width > 1e-12 else 1.0
    row, u = _place(math.sqrt(y * inverse), table.shape[0])
    column, v = _place(math.sqrt(max(0.5 - 0.5 * cos_phi, 0.0)), table.shape[1])
    mie_g, mie_factor = phase
    spread = (1.0 - mie_g) ** 2 + 2.0 * mie_g * (1.0 - nu)
    mie_phase = mie_factor * (1.0 + nu * nu) / (spread * math.sqrt(spread))
    for c in range(3):
        rayleigh = _blend(table, 0, c, row, u, column, v)
        mie = _blend(table, 1, c, row, u, column, v)
        out[c] = rayleigh**4 + mie_phase * mie**4


@njit(cache=True, nogil=True, error_model="numpy")
def _place(coordinate, count):  # type: ignore[no-untyped-def]
    """Index of the node at or before a coordinate in [0, 1], and the fraction after it."""
    position = coordinate * (count - 1)
    index = min(int(position), count - 2)
    return np.uintp(index), min(position - index, 1.0)


@njit(cache=True, nogil=True, error_model="numpy")
def _blend(table, part, c, i, u, j, v):  # type: ignore[no-untyped-def]
    one = np.uintp(1)
    near = table[i, j, part, c] * (1.0 - v) + table[i, j + one, part, c] * v
    far = table[i + one, j, part, c] * (1.0 - v) + table[i + one, j + one, part, c] * v
    return near * (1.0 - u) + far * u
