"""Candela that a luminaire sends in each direction, and what its files have in common."""

import math
from typing import NamedTuple

import numpy as np

from vrut_lite.messages.lamps import TABLE_SHAPE
from vrut_lite.numeric_types import Float32Array, FloatArray
from vrut_lite.scene.scene_file_error import SceneFileError

MOST_ANGLES = 721
# Angles that files round.
NEARLY_DEG = 0.1
_MOST_CANDELA = 1e12


class Photometry(NamedTuple):
    """A luminaire's light: `table` (181, 73) in [0, 1], and the candela where it is 1.

    Rows go from the luminaire's axis to its opposite, columns once around it from its own +X by
    +Y. The axis is the nadir of type C, and where lamps of types A and B are aimed.
    """

    candela: float
    table: Float32Array

    @classmethod
    def of(cls, table: FloatArray) -> "Photometry":
        """The photometry of candela (181, 73)."""
        most = float(table.max())
        return cls(most, (table / max(most, 1e-30)).astype(np.float32))


def finite_numbers(words: list[str], kind: str) -> list[float]:
    """The numbers of a luminaire's file; `kind` names its format.

    Raises:
        SceneFileError: one is no finite number.
    """
    try:
        values = [float(word) for word in words]
    except ValueError as fault:
        raise SceneFileError(f"{kind} of it is damaged ({fault}); fetch it again") from None
    if not all(map(math.isfinite, values)):
        raise SceneFileError(f"{kind} of it holds numbers that are not finite; fetch it again")
    return values


def check_candela(candela: FloatArray, kind: str) -> None:
    """Raise SceneFileError unless all candela are possible."""
    if not (np.all(candela >= 0.0) and np.all(candela <= _MOST_CANDELA)):
        raise SceneFileError(f"{kind} of it has impossible candela; mend that file")


def cut_short(kind: str) -> SceneFileError:
    """The error of a file with too few numbers."""
    return SceneFileError(f"{kind} of it is cut short; fetch that file again")


def table_of_planes(
    vertical_deg: FloatArray, horizontal_deg: FloatArray, candela: FloatArray
) -> FloatArray:
    """Candela (V, H) in planes around the axis, at the nodes of our table.

    Both angles rise; the vertical ones count from the axis, beyond them it is dark. Planes that end
    at 90 or 180 degrees, or go from 90 to 270, repeat by symmetry; others close the circle.
    """
    rows, columns = TABLE_SHAPE
    theta, phi = np.linspace(0.0, 180.0, rows), np.linspace(0.0, 360.0, columns)
    by_column = np.array(
        [np.interp(theta, vertical_deg, column, left=0.0, right=0.0) for column in candela.T]
    )
    if horizontal_deg[-1] - horizontal_deg[0] > 360.0 - NEARLY_DEG:
        horizontal_deg, by_column = horizontal_deg[:-1], by_column[:-1]
    folded = _folded(phi, horizontal_deg)
    return np.array([np.interp(folded, horizontal_deg, row, period=360.0) for row in by_column.T])


def _folded(phi: FloatArray, horizontal: FloatArray) -> FloatArray:
    """Angles around the axis, brought by symmetry into the range that the file has."""
    last = float(horizontal[-1])
    if abs(last - 90.0) < NEARLY_DEG:
        half = np.abs((phi + 180.0) % 360.0 - 180.0)
        return np.minimum(half, 180.0 - half)
    if abs(last - 180.0) < NEARLY_DEG:
        return np.abs((phi + 180.0) % 360.0 - 180.0)
    if abs(last - 270.0) < NEARLY_DEG and abs(float(horizontal[0]) - 90.0) < NEARLY_DEG:
        return np.where((phi < 90.0) | (phi > 270.0), (180.0 - phi) % 360.0, phi)
    return phi
