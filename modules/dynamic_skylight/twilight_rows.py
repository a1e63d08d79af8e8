"""Twilight's map of directions laid onto a cube map, in single precision.

Two square roots and a division give a texel its coordinates in the map; the rest is a bilinear
look-up. Importing this module imports numba.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from vrut_lite.geometry.cube_map import FACE_NORMALS, FACE_S_AXES, FACE_T_AXES, texel_centres

FloatArray = NDArray[np.float64]
Float32Array = NDArray[np.float32]

_TOP, _BOTTOM = 2, 3
_AXES = np.stack([FACE_NORMALS, FACE_S_AXES, FACE_T_AXES], axis=1).astype(np.float32)
_ONE, _HALF = np.float32(1.0), np.float32(0.5)
_SMALLEST = np.float32(1e-30)


def add_directions(
    cube: Float32Array, faces: tuple[int, ...], directions: FloatArray, sun_azimuth_rad: float
) -> None:
    """Add a map of directions (V, A, 3) to what a cube map (6, n, n, 3) has above the horizon.

    The map's coordinates are those of `twilight_table`; the azimuth is the world's (from -Z,
    clockwise seen from above).
    """
    size = cube.shape[1]
    centres = texel_centres(size).astype(np.float32)
    sun = (np.float32(np.sin(sun_azimuth_rad)), np.float32(-np.cos(sun_azimuth_rad)))
    small = directions.astype(np.float32)
    for face in set(faces) - {_BOTTOM}:
        rows = size if face == _TOP else size // 2
        _add_to_face(cube[face, :rows], _AXES[face], centres, small, sun)


@njit(cache=True, error_model="numpy", fastmath={"nnan", "ninf", "nsz", "contract"})
def _add_to_face(face, axes, centres, directions, sun):  # type: ignore[no-untyped-def]
    last_v, last_a = directions.shape[0] - 1, directions.shape[1] - 1
    for i in range(face.shape[0]):
        for j in range(face.shape[1]):
            s, t = centres[j], centres[i]
            x = axes[0, 0] + s * axes[1, 0] + t * axes[2, 0]
            y = axes[0, 1] + s * axes[1, 1] + t * axes[2, 1]
            z = axes[0, 2] + s * axes[1, 2] + t * axes[2, 2]
            level = x * x + z * z
            # 1 - up without cancellation at the zenith: level / (length (length + y)).
            length = math.sqrt(level + y * y)
            from_zenith = level / (length * (length + y))
            v = math.sqrt((y / length) / (_ONE + math.sqrt(from_zenith))) * np.float32(last_v)
            # Half the chord between the level directions is the sine of half the azimuth.
            scale = _ONE / math.sqrt(max(level, _SMALLEST))
            along, across = x * scale - sun[0], z * scale - sun[1]
            a = _HALF * math.sqrt(along * along + across * across) * np.float32(last_a)
            row, column = min(int(v), last_v - 1), min(int(a), last_a - 1)
            dv, da = v - np.float32(row), a - np.float32(column)
            for c in range(3):
                near = directions[row, column, c]
                near += da * (directions[row, column + 1, c] - near)
                far = directions[row + 1, column, c]
                far += da * (directions[row + 1, column + 1, c] - far)
                face[i, j, c] += near + dv * (far - near)
