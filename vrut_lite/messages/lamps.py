"""The lamps of a scene: points that shine, with the light that each sends in any direction.

A lamp is a point: its irradiance falls with the square of the distance, without an end.
"""

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite import checks
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import FloatArray

NONE = -1
# Cosines of the cone of a lamp that shines all around: the ramp between them is 1 everywhere.
ALL_AROUND = (-2.0, -2.0)
# Nodes of a luminaire's table: every degree from its axis, every 5 degrees around it.
TABLE_SHAPE = (181, 73)
MOST_LAMPS = 4096
# Number of lamps drawn with shadow maps; the light map has the light of the others.
MOST_DRAWN = 8
_SHARPEST_RAMP = 1e-3


class SceneLamps(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Lamps (L) of a scene in world axes, the brightest first, and tables (T) of luminaires.

    Attributes:
        names: uint8, UTF-8, a line a lamp.
        position_m: (L, 3) float64.
        axes: (L, 3, 3) float64, rows of unit vectors: along which the lamp shines, towards the
            plane where a table's angle around the axis is 0, and towards that of 90 degrees.
        intensity_rgb: (L, 3) float64, W sr^-1 where cone and table are 1; times 683 lm/W: cd.
        cone_cos: (L, 2) float64, cosines of the angles at which a spot begins to darken and is
            dark; `ALL_AROUND` for others.
        table: (L,) int32, which table shapes the light, or NONE.
        tables: (T, 181, 73) float32 in [0, 1]: from the axis to its opposite, and once around it.
    """

    names: Array
    position_m: Array
    axes: Array
    intensity_rgb: Array
    cone_cos: Array
    table: Array
    tables: Array

    @property
    def count(self) -> int:
        """How many lamps there are."""
        return self.position_m.shape[0]

    def intensity_towards(self, lamp: int, directions: ArrayLike) -> FloatArray:
        """Intensity (..., 3), W sr^-1, of one lamp into unit directions (..., 3), world axes."""
        local = np.asarray(directions, float) @ self.axes.values[lamp].T
        inner, outer = self.cone_cos.values[lamp]
        # KHR_lights_punctual: squared, from dark to full between the two cosines.
        ramp = np.clip((local[..., 0] - outer) / max(inner - outer, _SHARPEST_RAMP), 0.0, 1.0)
        share = ramp**2
        table = int(self.table.values[lamp])
        if table != NONE:
            share = share * _looked_up(self.tables.values[table], local)
        return np.asarray(share[..., None] * self.intensity_rgb.values[lamp])

    def irradiance_at(self, lamp: int, point_m: ArrayLike, normal: ArrayLike) -> FloatArray:
        """Irradiance (3,), W m^-2, of one lamp on a plane, if nothing is in the way."""
        away = np.asarray(point_m, float) - self.position_m.values[lamp]
        squared = float(away @ away)
        if squared == 0.0:
            return np.zeros(3)
        direction = away / np.sqrt(squared)
        cosine = max(0.0, -float(np.asarray(normal, float) @ direction))
        return self.intensity_towards(lamp, direction) * (cosine / squared)

    def check(self) -> None:
        """Arrays of the types and shapes that are named above.

        Raises:
            UserError: an array is invalid.
        """
        checks.arrays(
            self,
            {
                "names": ("|u1", ("N",)),
                "position_m": ("<f8", ("L", 3)),
                "axes": ("<f8", ("L", 3, 3)),
                "intensity_rgb": ("<f8", ("L", 3)),
                "cone_cos": ("<f8", ("L", 2)),
                "table": ("<i4", ("L",)),
                "tables": ("<f4", ("T", *TABLE_SHAPE)),
            },
        )

    def check_arrays(self) -> None:
        """Tables that are there.

        Raises:
            UserError: an array is invalid.
        """
        table = self.table.values
        if np.any((table < NONE) | (table >= self.tables.shape[0])):
            raise UserError("a lamp of SceneLamps names a table that is not there")


def brightest_first(intensity_rgb: FloatArray) -> NDArray[np.intp]:
    """The order of lamps (L,) by the luminance of their intensity (L, 3), W sr^-1."""
    return np.argsort(-np.asarray(luminance(intensity_rgb)), kind="stable")


def _looked_up(table: FloatArray, local: FloatArray) -> FloatArray:
    """A table (181, 73) at directions (..., 3) in a lamp's axes, linear between its nodes."""
    rows, columns = TABLE_SHAPE
    from_axis = np.arccos(np.clip(local[..., 0], -1.0, 1.0)) / np.pi * (rows - 1)
    around = np.arctan2(local[..., 2], local[..., 1]) / (2.0 * np.pi) % 1.0 * (columns - 1)
    row = np.minimum(from_axis.astype(int), rows - 2)
    column = np.minimum(around.astype(int), columns - 2)
    v, u = from_axis - row, around - column
    near = table[row, column] * (1.0 - u) + table[row, column + 1] * u
    far = table[row + 1, column] * (1.0 - u) + table[row + 1, column + 1] * u
    return np.asarray(near * (1.0 - v) + far * v, float)
