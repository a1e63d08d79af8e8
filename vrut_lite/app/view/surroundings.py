"""Where a scene's surfaces lie, coarsely: what a camera that turns must not pass through."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import FloatArray

# Cells along the scene's longest side.
_CELLS = 160
# A triangle is sampled at so many points a cell's edge, at most so many along its own.
_SAMPLES_A_CELL, _MOST_SAMPLES = 2.0, 512
_CHUNK_POINTS = 1 << 20
_HEADINGS = 16
_ARC_RAD, _ARC_STEPS = np.radians(20.0), 24
_MOST_STEPS = 2000
# Least height of the eye above the ground, as a share of the scene's size, and in metres.
_CLEARANCE, _LEAST_CLEARANCE_M = 0.003, 0.02


class OccupiedCells:
    """Cells of one size, each with or without a surface in it; lengths in metres, world axes."""

    def __init__(self, scene: SceneOpened):
        lower, upper = np.array(scene.lower_m), np.array(scene.upper_m)
        self._origin_m: FloatArray = lower
        longest_m = float(np.max(upper - lower))
        self._cell_m = max(longest_m / _CELLS, 1e-6)
        shape = np.floor((upper - lower) / self._cell_m).astype(int) + 1
        self._filled = np.zeros(shape, bool)
        ground = scene.ground
        floor_m = min(0.0, float(lower[1])) if ground is None else ground.height_m
        self.lowest_m = floor_m + max(_CLEARANCE * longest_m, _LEAST_CLEARANCE_M)
        geometry = scene.geometry
        for part in range(len(geometry.part_mesh.values)):
            self._fill(np.asarray(geometry.world_triangles(part), float))

    def is_filled(self, points_m: FloatArray) -> NDArray[np.bool_]:
        """Whether there is a surface in the cells of points (n, 3); none outside the scene."""
        cells = np.floor((points_m - self._origin_m) / self._cell_m).astype(int)
        inside = np.all((cells >= 0) & (cells < self._filled.shape), axis=-1)
        found = np.zeros(len(cells), bool)
        found[inside] = self._filled[tuple(cells[inside].T)]
        return found

    def is_free(self, start_m: FloatArray, end_m: FloatArray) -> bool:
        """Whether no surface is in the cells between two points, the start's cell left out."""
        way = end_m - start_m
        length_m = float(np.linalg.norm(way))
        steps = min(int(2.0 * length_m / self._cell_m) + 1, _MOST_STEPS)
        shares = np.arange(1, steps + 1)[:, None] / steps
        points = start_m + shares * way
        own = np.floor((start_m - self._origin_m) / self._cell_m)
        same = np.all(np.floor((points - self._origin_m) / self._cell_m) == own, axis=-1)
        return not bool(np.any(self.is_filled(points[~same])))

    def encloses(self, eye_m: FloatArray, target_m: FloatArray) -> bool:
        """Whether an eye stands among surfaces, so that it cannot go around its target.

        It does where it touches one, below a roof, where half of the horizon is closed nearer than
        the target, and where the way around the target is closed to the left or to the right.
        """
        x, _, z = eye_m - self._origin_m
        width, _, depth = self._cell_m * np.array(self._filled.shape)
        if not (0.0 <= x <= width and 0.0 <= z <= depth):
            return False
        if bool(self.is_filled(eye_m[None])[0]):
            return True
        reach_m = float(np.linalg.norm(target_m - eye_m))
        top_m = self._origin_m[1] + self._cell_m * self._filled.shape[1]
        if eye_m[1] < top_m and not self.is_free(eye_m, np.array([eye_m[0], top_m, eye_m[2]])):
            return True
        angles = np.arange(_HEADINGS) * (2.0 * np.pi / _HEADINGS)
        ways = np.stack([np.sin(angles), np.zeros(_HEADINGS), -np.cos(angles)], axis=-1)
        closed = [not self.is_free(eye_m, eye_m + reach_m * way) for way in ways]
        if 2 * sum(closed) >= _HEADINGS:
            return True
        return not all(self._is_arc_free(eye_m, target_m, side) for side in (-1.0, 1.0))

    def _is_arc_free(self, eye_m: FloatArray, target_m: FloatArray, side: float) -> bool:
        angles = side * np.linspace(0.0, _ARC_RAD, _ARC_STEPS)
        x, _, z = eye_m - target_m
        points = np.stack(
            [
                target_m[0] + x * np.cos(angles) - z * np.sin(angles),
                np.full(_ARC_STEPS, eye_m[1]),
                target_m[2] + x * np.sin(angles) + z * np.cos(angles),
            ],
            axis=-1,
        )
        return all(self.is_free(*pair) for pair in pairwise(points))

    def _fill(self, triangles: FloatArray) -> None:
        """Mark the cells of triangles (n, 3, 3), by points that lie closer than cells."""
        edges = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=-1)
        wanted = np.ceil(_SAMPLES_A_CELL * edges.max(axis=-1, initial=0.0) / self._cell_m)
        # Powers of two, so that few sizes are gone through.
        samples = np.exp2(np.ceil(np.log2(np.clip(wanted, 1, _MOST_SAMPLES)))).astype(int)
        in_cells = (triangles - self._origin_m) / self._cell_m
        filled, (_, rows, columns) = self._filled.reshape(-1), self._filled.shape
        last = np.array(self._filled.shape) - 1
        for count in np.unique(samples):
            i, j = np.meshgrid(np.arange(count + 1), np.arange(count + 1), indexing="ij")
            inside = i + j <= count
            u, v = i[inside] / count, j[inside] / count
            weights = np.stack([1.0 - u - v, u, v], axis=-1)
            chosen = in_cells[samples == count]
            a_chunk = max(1, _CHUNK_POINTS // len(weights))
            for start in range(0, len(chosen), a_chunk):
                # Coordinate by coordinate: no array of points by three.
                x, y, z = (
                    np.clip((corners @ weights.T).astype(np.int32), 0, most)
                    for corners, most in zip(
                        np.moveaxis(chosen[start : start + a_chunk], 2, 0), last, strict=True
                    )
                )
                filled[(x * rows + y) * columns + z] = True
