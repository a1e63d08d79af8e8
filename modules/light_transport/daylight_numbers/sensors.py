"""Sensors: points with a direction, in planes that have a name."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite.numeric_types import BoolArray, FloatArray

_SHORTEST = 1e-9


@dataclass(frozen=True, eq=False)
class Sensors:
    """Where light is measured (P); world axes.

    Attributes:
        places_m: (P, 3).
        normals: (P, 3), unit vectors.
        plane: (P,) int, the work plane of each.
        cell: (P, 2) int, row and column in its plane's grid, rows along +z and columns along +x.
        inner: (P,) bool, not within half a metre of a wall (EN 17037).
        names: of the planes.
        step_m: edge of each plane's cells, 0 for points that are in no grid.
    """

    places_m: FloatArray
    normals: FloatArray
    plane: NDArray[np.int64]
    cell: NDArray[np.int64]
    inner: BoolArray
    names: tuple[str, ...]
    step_m: tuple[float, ...]

    def __len__(self) -> int:
        return len(self.places_m)

    def some(self, chosen: NDArray[np.integer] | BoolArray) -> "Sensors":
        """Those that are chosen, with all planes."""
        return replace(
            self,
            places_m=self.places_m[chosen],
            normals=self.normals[chosen],
            plane=self.plane[chosen],
            cell=self.cell[chosen],
            inner=self.inner[chosen],
        )


def free_sensors(places_m: FloatArray, normals: FloatArray, name: str) -> Sensors:
    """Points (P, 3) with directions (P, 3) of any length, which lie in no grid.

    Raises:
        UserError: there are none, or one is no finite number or has no direction.
    """
    places_m, normals = np.asarray(places_m, float), np.asarray(normals, float)
    if not len(places_m):
        raise UserError(f"{name} has no sensors: give at least one point")
    bad = np.flatnonzero(~np.isfinite(np.hstack([places_m, normals])).all(axis=1))
    if len(bad):
        raise UserError(f"sensor {bad[0] + 1} of {name} is no finite point and direction")
    length = np.linalg.norm(normals, axis=1)
    bad = np.flatnonzero(length < _SHORTEST)
    if len(bad):
        raise UserError(f"sensor {bad[0] + 1} of {name} has a direction of no length")
    count = len(places_m)
    return Sensors(
        places_m,
        normals / length[:, None],
        np.zeros(count, np.int64),
        np.full((count, 2), -1),
        np.ones(count, bool),
        (name,),
        (0.0,),
    )
