"""The map of the night's glow (see `NightLightChanged`) as a cube map."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.night_kernels import fill_glow


class _LookUp(NamedTuple):
    """The upper texels (m,) of a cube; indices of four nodes (m, 4) of each, and their weights."""

    upper: NDArray[np.int32]
    nodes: NDArray[np.int32]
    weights: NDArray[np.float32]


def map_directions(rows: int, columns: int) -> FloatArray:
    """Directions (rows, columns, 3) of the map's nodes, world axes."""
    elevation = (np.arange(rows)[:, None] + 0.5) * (0.5 * np.pi / rows)
    azimuth = (np.arange(columns) + 0.5) * (2.0 * np.pi / columns)
    level, turn = np.cos(elevation), np.broadcast_to(azimuth, (rows, columns))
    up = np.broadcast_to(np.sin(elevation), turn.shape)
    return np.stack([level * np.sin(turn), up, -level * np.cos(turn)], axis=-1)


@lru_cache(maxsize=4)
def glow_cube(
    glow: Array, size: int, ground_rgb: Vector, horizon_rad: float = 0.0
) -> NDArray[np.float32]:
    """Radiance (6, size, size, 3), read-only: the map above the horizon, the ground's below it.

    Between the level and the horizon of an eye aloft, at the elevation `horizon_rad`, the map's
    lowest row continues.

    A map is used for minutes: the cubes of the last ones are cached.
    """
    values = glow.values
    found = _look_up(size, *values.shape[:2], horizon_rad)
    cube = np.empty((6, size, size, 3), np.float32)
    flat = np.ascontiguousarray(values.reshape(-1, 3), np.float32)
    ground = np.array(ground_rgb, np.float32)
    fill_glow(cube.reshape(-1, 3), found.upper, found.nodes, found.weights, flat, ground)
    cube.flags.writeable = False
    return cube


@lru_cache(maxsize=4)
def _look_up(size: int, rows: int, columns: int, horizon_rad: float) -> _LookUp:
    direction = texel_directions(size)
    upper = direction[..., 1] > np.sin(horizon_rad)
    x, y, z = direction[upper].T
    row = np.clip(np.arcsin(np.minimum(y, 1.0)) * (2.0 * rows / np.pi) - 0.5, 0.0, rows - 1.0)
    column = np.mod(np.arctan2(x, -z) / (2.0 * np.pi), 1.0) * columns - 0.5
    r, c = np.minimum(row.astype(int), rows - 2), np.floor(column).astype(int)
    v, u = row - r, column - c
    near, far = c % columns, (c + 1) % columns
    nodes = np.stack([r * columns + near, r * columns + far])
    weights = np.stack([(1 - v) * (1 - u), (1 - v) * u, v * (1 - u), v * u])
    nodes = np.concatenate([nodes, nodes + columns])
    return _LookUp(
        np.flatnonzero(upper).astype(np.int32),
        np.ascontiguousarray(nodes.T, np.int32),
        np.ascontiguousarray(weights.T, np.float32),
    )
