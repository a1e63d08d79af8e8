"""IES files (ANSI/IES LM-63, all editions): candela that a luminaire sends in each direction."""

import math
import re
from typing import NamedTuple

import numpy as np

from vrut_lite.daylight.lamps import TABLE_SHAPE
from vrut_lite.numeric_types import Float32Array, FloatArray
from vrut_lite.scene.scene_file_error import SceneFileError

_MOST_ANGLES = 721
_SEPARATORS = re.compile(r"[\s,]+")
_TYPE_C = 1
_TYPES = {2.0: "B", 3.0: "A"}
# Angles that files round.
_NEARLY_DEG = 0.1
_MOST_CANDELA = 1e12


class Photometry(NamedTuple):
    """A luminaire's light: `table` (181, 73) in [0, 1], and the candela where it is 1.

    Rows go from the luminaire's axis (its nadir) to its opposite, columns once around it.
    """

    candela: float
    table: Float32Array


def read_ies(data: bytes) -> Photometry:
    """The photometry of an IES file, tilt and ballast factor included.

    Raises:
        SceneFileError: it is no IES file of type C photometry, or its numbers do not hold.
    """
    head, _, rest = data.decode("latin-1").partition("TILT=")
    tilt, _, body = rest.partition("\n")
    if not rest or not head.strip():
        raise SceneFileError("an IES file of it has no line TILT=; fetch that file again")
    values = _numbers(body)
    if tilt.strip() == "INCLUDE":
        # Lamp outputs by tilt angle: at the angle 0, as it is drawn here, the factor is 1.
        if len(values) < 2:
            raise _cut_short()
        values = values[2 + 2 * int(values[1]) :]
    if len(values) < 13:
        raise _cut_short()
    multiplier, rows, columns, kind = values[2], values[3], values[4], values[5]
    if kind != _TYPE_C:
        raise SceneFileError(
            f"an IES file of it has photometry of type {_TYPES.get(kind, kind)}, and only type C "
            "is read; convert that file"
        )
    if not (1 <= rows <= _MOST_ANGLES and 1 <= columns <= _MOST_ANGLES):
        raise SceneFileError(f"an IES file of it has {rows:g} x {columns:g} angles; mend that file")
    vertical, horizontal, candela = _parts(values[13:], int(rows), int(columns))
    candela = candela * multiplier * values[10]
    if not (np.all(candela >= 0.0) and np.all(candela <= _MOST_CANDELA)):
        raise SceneFileError("an IES file of it has impossible candela; mend that file")
    table = _table(vertical, horizontal, candela)
    most = float(table.max())
    return Photometry(most, (table / max(most, 1e-30)).astype(np.float32))


def _numbers(text: str) -> list[float]:
    try:
        values = [float(word) for word in _SEPARATORS.split(text) if word]
    except ValueError as fault:
        raise SceneFileError(f"an IES file of it is damaged ({fault}); fetch it again") from None
    if not all(map(math.isfinite, values)):
        raise SceneFileError("an IES file of it holds numbers that are not finite; fetch it again")
    return values


def _parts(values: list[float], rows: int, columns: int) -> tuple[FloatArray, ...]:
    """Vertical angles (V,), horizontal ones (H,), degrees, and candela (V, H)."""
    if len(values) < rows + columns + rows * columns:
        raise _cut_short()
    vertical = np.array(values[:rows])
    horizontal = np.array(values[rows : rows + columns])
    first = rows + columns
    candela = np.array(values[first : first + rows * columns]).reshape(columns, rows).T
    rising = np.all(np.diff(vertical) > 0.0) and np.all(np.diff(horizontal) > 0.0)
    if not rising or vertical[0] < 0.0 or vertical[-1] > 180.0 or horizontal[-1] > 360.0:
        raise SceneFileError("angles in an IES file of it do not rise; mend that file")
    return vertical, horizontal, candela


def _table(vertical: FloatArray, horizontal: FloatArray, candela: FloatArray) -> FloatArray:
    """Candela at the nodes of our table; dark beyond the file's vertical angles."""
    rows, columns = TABLE_SHAPE
    theta, phi = np.linspace(0.0, 180.0, rows), np.linspace(0.0, 360.0, columns)
    by_column = np.array(
        [np.interp(theta, vertical, column, left=0.0, right=0.0) for column in candela.T]
    )
    folded = _folded(phi, horizontal)
    return np.array([np.interp(folded, horizontal, row) for row in by_column.T])


def _folded(phi: FloatArray, horizontal: FloatArray) -> FloatArray:
    """Angles around the axis, brought by symmetry into the range that the file has."""
    last = float(horizontal[-1])
    if len(horizontal) == 1:
        return np.full_like(phi, horizontal[0])
    if abs(last - 90.0) < _NEARLY_DEG:
        half = np.abs((phi + 180.0) % 360.0 - 180.0)
        return np.minimum(half, 180.0 - half)
    if abs(last - 180.0) < _NEARLY_DEG:
        return np.abs((phi + 180.0) % 360.0 - 180.0)
    if abs(last - 270.0) < _NEARLY_DEG and abs(float(horizontal[0]) - 90.0) < _NEARLY_DEG:
        return np.where((phi < 90.0) | (phi > 270.0), (180.0 - phi) % 360.0, phi)
    return phi


def _cut_short() -> SceneFileError:
    return SceneFileError("an IES file of it is cut short; fetch that file again")
