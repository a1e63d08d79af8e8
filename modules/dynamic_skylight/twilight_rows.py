"""Adds twilight's map of directions to a cube map, in single precision.

Two square roots and a division give a texel's coordinates in the map; a bilinear look-up of four
numbers follows. Importing this module imports numba.
"""

import math
from typing import Any

import numpy as np

from vrut_lite.geometry.cube_map import FACE_NORMALS, FACE_S_AXES, FACE_T_AXES, texel_centres
from vrut_lite.njit import SUMS_IN_ORDER, njit
from vrut_lite.numeric_types import Float32Array, FloatArray

_TOP, _BOTTOM = 2, 3
_AXES = np.stack([FACE_NORMALS, FACE_S_AXES, FACE_T_AXES], axis=1).astype(np.float32)
_ONE, _HALF = np.float32(1.0), np.float32(0.5)
_SMALLEST = np.float32(1e-30)
_COMPILE: dict[str, Any] = {
    "cache": True,
    "error_model": "numpy",
    "fastmath": SUMS_IN_ORDER,
}


def lay_over(
    cube: Float32Array, faces: tuple[int, ...], directions: FloatArray, sun_azimuth_rad: float
) -> None:
    """Apply a map of directions (V, A, 4) to a cube map (6, n, n, 3) above the horizon.

    Each texel is multiplied by the map's fourth number, then the first three are added. The map
    has the coordinates of `twilight_table`; the azimuth is the world's (from -Z, clockwise seen
    from above).
    """
    size = cube.shape[1]
    centres = texel_centres(size).astype(np.float32)
    sun = (np.float32(np.sin(sun_azimuth_rad)), np.float32(-np.cos(sun_azimuth_rad)))
    small = directions.astype(np.float32)
    for face in set(faces) - {_BOTTOM}:
        rows = size if face == _TOP else size // 2
        _lay_over_face(cube[face, :rows], _AXES[face], centres, small, sun)


@njit(**_COMPILE)
def _lay_over_face(face, axes, centres, directions, sun):  # type: ignore[no-untyped-def]
    places = np.empty((2, centres.size), np.float32)
    for i in range(face.shape[0]):
        _find_places(places, axes, centres, centres[i], directions.shape, sun)
        _lay_over_row(face[i], places, directions)


@njit(**_COMPILE)
def _find_places(places, axes, centres, t, shape, sun):  # type: ignore[no-untyped-def]
    """The coordinates of a row of texels, in units of the map's nodes; this loop vectorises."""
    last_v, last_a = np.float32(shape[0] - 1), np.float32(shape[1] - 1)
    x0, y0, z0 = (
        axes[0, 0] + t * axes[2, 0],
        axes[0, 1] + t * axes[2, 1],
        axes[0, 2] + t * axes[2, 2],
    )
    dx, dy, dz = axes[1, 0], axes[1, 1], axes[1, 2]
    of_v, of_a = places[0], places[1]
    for j in range(centres.size):
        s = centres[j]
        x, y, z = x0 + s * dx, y0 + s * dy, z0 + s * dz
        level = x * x + z * z
        # 1 - up without cancellation at the zenith: level / (length (length + y)).
        length = math.sqrt(level + y * y)
        from_zenith = level / (length * (length + y))
        of_v[j] = math.sqrt((y / length) / (_ONE + math.sqrt(from_zenith))) * last_v
        # Half the chord between horizontal unit vectors is the sine of half the azimuth.
        scale = _ONE / math.sqrt(max(level, _SMALLEST))
        along, across = x * scale - sun[0], z * scale - sun[1]
        of_a[j] = _HALF * math.sqrt(along * along + across * across) * last_a


@njit(**_COMPILE)
def _lay_over_row(row, places, directions):  # type: ignore[no-untyped-def]
    last_v, last_a = directions.shape[0] - 2, directions.shape[1] - 2
    found = np.empty(4, np.float32)
    for j in range(row.shape[0]):
        v, a = places[0, j], places[1, j]
        i, k = min(int(v), last_v), min(int(a), last_a)
        dv, da = v - np.float32(i), a - np.float32(k)
        for c in range(4):
            near = directions[i, k, c]
            near += da * (directions[i, k + 1, c] - near)
            far = directions[i + 1, k, c]
            far += da * (directions[i + 1, k + 1, c] - far)
            found[c] = near + dv * (far - near)
        for c in range(3):
            row[j, c] = row[j, c] * found[3] + found[c]
