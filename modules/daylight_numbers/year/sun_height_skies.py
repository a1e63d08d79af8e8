"""The skies of a year from those of some heights of the sun.

A clear sky depends on the sun's height, and turns with its azimuth. Skies of some hours, whose suns
stand at close heights, are sampled over azimuths from the sun and heights; another hour's sky lies
between those of the two nearest heights: shares of their level linearly, the level itself by its
logarithm, since light falls by a factor of ten within three degrees of dusk.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from light_transport.public import GROUND_NODE
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from daylight_numbers.sky_cells import cell_directions, cell_solid_angles, node_of_cell
from vrut_lite.geometry.cube_map import sample_cube
from vrut_lite.numeric_types import FloatArray, IntArray

# Azimuths from the sun, all around, and heights from the horizon to the zenith.
_AZIMUTHS, _HEIGHTS = 96, 32
# Steps between heights of the sun (degrees) up to a height.
_STEPS_DEG = ((1.0, 0.25), (10.0, 0.5), (91.0, 1.0))
_LEAST = 1e-12


@dataclass(frozen=True, eq=False)
class HeightSkies:
    """Skies (K) by rising height of the sun; linear sRGB.

    Attributes:
        height_rad: (K,) apparent heights.
        level_rgb: (K, 3), mean radiance by which the others are divided.
        sky: (K, _HEIGHTS, _AZIMUTHS, 3), from the horizon up, azimuths from the sun clockwise.
        ground, sun: (K, 3), radiance of open ground and irradiance of the sun.
    """

    height_rad: FloatArray
    level_rgb: FloatArray
    sky: FloatArray
    ground: FloatArray
    sun: FloatArray

    def between(self, height_rad: float, azimuth_rad: float) -> tuple[FloatArray, FloatArray]:
        """Radiances (GROUND_NODE + 1, 3) of the ray table's cells and of open ground, and the sun's
        irradiance (3,), for a sun whose azimuth is counted from -Z clockwise."""
        at = np.interp(height_rad, self.height_rad, np.arange(len(self.height_rad)))
        low = min(int(at), len(self.height_rad) - 2)
        share = float(at - low)

        def mixed(values: FloatArray) -> FloatArray:
            return np.asarray((1.0 - share) * values[low] + share * values[low + 1])

        logs = np.log(self.level_rgb[low : low + 2])
        level = np.exp((1.0 - share) * logs[0] + share * logs[1])
        columns = azimuth_rad / (2.0 * np.pi) * _AZIMUTHS
        first = int(np.floor(columns))
        part = columns - first
        sky = mixed(self.sky)
        turned = (1.0 - part) * np.roll(sky, first, axis=1) + part * np.roll(sky, first + 1, axis=1)
        nodes = _cells_of_places() @ turned.reshape(-1, 3)
        radiances = np.vstack([nodes, mixed(self.ground)])
        return radiances * level, mixed(self.sun) * level


def spread_heights(height_rad: FloatArray) -> IntArray:
    """Numbers of hours whose suns' heights (H,) are spread closely over all of them, rising."""
    order = np.argsort(height_rad, kind="stable")
    chosen = [int(order[0])]
    for number in order[1:-1]:
        last_deg = np.degrees(height_rad[chosen[-1]])
        step_deg = next(step for limit, step in _STEPS_DEG if last_deg < limit)
        if np.degrees(height_rad[number]) - last_deg >= step_deg:
            chosen.append(int(number))
    return np.array([*chosen, int(order[-1])], np.int64)


def height_skies(
    height_rad: FloatArray,
    azimuth_rad: FloatArray,
    cubes: list[NDArray[np.floating]],
    ground_rgb: FloatArray,
    sun_rgb: FloatArray,
) -> HeightSkies:
    """Skies by rising heights (K,) of the sun, whose azimuths (K,) are counted from -Z clockwise.

    `cubes` are maps (6, n, n, 3) of radiance; `ground_rgb` and `sun_rgb` (K, 3) see `HeightSkies`.
    """
    sky = np.stack(
        [sample_cube(cube, _places(turn)) for cube, turn in zip(cubes, azimuth_rad, strict=True)]
    )
    level = np.maximum(sky.mean(axis=(1, 2)), _LEAST)
    return HeightSkies(
        height_rad, level, sky / level[:, None, None], ground_rgb / level, sun_rgb / level
    )


def _heights_rad() -> FloatArray:
    return np.asarray(0.5 * np.pi * (np.arange(_HEIGHTS) + 0.5) / _HEIGHTS)


def _places(azimuth_rad: float) -> FloatArray:
    """Unit vectors (_HEIGHTS, _AZIMUTHS, 3) of the places of a sky whose sun has an azimuth."""
    turn = azimuth_rad + 2.0 * np.pi * np.arange(_AZIMUTHS) / _AZIMUTHS
    height = _heights_rad()[:, None]
    level = np.cos(height)
    return np.stack(
        np.broadcast_arrays(level * np.sin(turn), np.sin(height), -level * np.cos(turn)), axis=-1
    )


@lru_cache(maxsize=1)
def _cells_of_places() -> csr_matrix:
    """Matrix (GROUND_NODE, places): means of the ray table's cells over a sky whose azimuths are
    counted from -Z; linear between places."""
    directions = cell_directions()
    node = np.repeat(node_of_cell(), directions.shape[1])
    x, y, z = directions.reshape(-1, 3).T
    row = np.arcsin(np.clip(y, -1.0, 1.0)) / (0.5 * np.pi) * _HEIGHTS - 0.5
    row = np.clip(row, 0.0, _HEIGHTS - 1.0)
    column = np.arctan2(x, -z) / (2.0 * np.pi) * _AZIMUTHS % _AZIMUTHS
    r, c = np.minimum(row.astype(int), _HEIGHTS - 2), column.astype(int)
    v, u = row - r, column - c
    corners = [
        (weight, (r + down) * _AZIMUTHS + (c + right) % _AZIMUTHS)
        for down, right, weight in (
            (0, 0, (1 - v) * (1 - u)), (0, 1, (1 - v) * u), (1, 0, v * (1 - u)), (1, 1, v * u)
        )
    ]  # fmt: skip
    weight = np.concatenate([weight for weight, _ in corners])
    place = np.concatenate([place for _, place in corners])
    nodes = np.tile(node, 4)
    solid = np.repeat(cell_solid_angles(), directions.shape[1])
    weight *= np.tile(solid, 4) / np.bincount(node, solid)[nodes]
    return csr_matrix((weight, (nodes, place)), (GROUND_NODE, _HEIGHTS * _AZIMUTHS))
