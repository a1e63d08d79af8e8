"""IES files (ANSI/IES LM-63, all editions): candela that a luminaire sends in each direction."""

import math
import re
from typing import NamedTuple

import numpy as np

from vrut_lite.messages.lamps import TABLE_SHAPE
from vrut_lite.numeric_types import Float32Array, FloatArray
from vrut_lite.scene.scene_file_error import SceneFileError

_MOST_ANGLES = 721
_SEPARATORS = re.compile(r"[\s,]+")
_TYPE_C, _TYPE_B, _TYPE_A = 1, 2, 3
# Angles that files round.
_NEARLY_DEG = 0.1
_MOST_CANDELA = 1e12


class Photometry(NamedTuple):
    """A luminaire's light: `table` (181, 73) in [0, 1], and the candela where it is 1.

    Rows go from the luminaire's axis to its opposite, columns once around it from its own +X by
    +Y. The axis is the nadir of type C, and where lamps of types A and B are aimed.
    """

    candela: float
    table: Float32Array


def read_ies(data: bytes) -> Photometry:
    """The photometry of an IES file, tilt and ballast factor included.

    Raises:
        SceneFileError: it is no IES file, or its numbers do not hold.
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
    if kind not in (_TYPE_A, _TYPE_B, _TYPE_C):
        raise SceneFileError(
            f"an IES file of it has photometry of type {kind:g}, and there are 1, 2 and 3 (C, B "
            "and A); mend that file"
        )
    if not (1 <= rows <= _MOST_ANGLES and 1 <= columns <= _MOST_ANGLES):
        raise SceneFileError(f"an IES file of it has {rows:g} x {columns:g} angles; mend that file")
    lowest = 0.0 if kind == _TYPE_C else -180.0
    vertical, horizontal, candela = _parts(values[13:], int(rows), int(columns), lowest)
    candela = candela * multiplier * values[10]
    if not (np.all(candela >= 0.0) and np.all(candela <= _MOST_CANDELA)):
        raise SceneFileError("an IES file of it has impossible candela; mend that file")
    if kind == _TYPE_C:
        table = _table(vertical, horizontal, candela)
    else:
        table = _aimed_table(vertical, horizontal, candela, around_vertical=kind == _TYPE_A)
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


def _parts(
    values: list[float], rows: int, columns: int, lowest_deg: float
) -> tuple[FloatArray, ...]:
    """Vertical angles (V,), horizontal ones (H,), degrees, and candela (V, H)."""
    if len(values) < rows + columns + rows * columns:
        raise _cut_short()
    vertical = np.array(values[:rows])
    horizontal = np.array(values[rows : rows + columns])
    first = rows + columns
    candela = np.array(values[first : first + rows * columns]).reshape(columns, rows).T
    rising = np.all(np.diff(vertical) > 0.0) and np.all(np.diff(horizontal) > 0.0)
    inside = min(vertical[0], horizontal[0]) >= lowest_deg and vertical[-1] <= 180.0
    if not (rising and inside and horizontal[-1] <= 360.0):
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


def _aimed_table(
    vertical: FloatArray, horizontal: FloatArray, candela: FloatArray, *, around_vertical: bool
) -> FloatArray:
    """The table of types A and B, whose angles (0, 0) point where the lamp is aimed.

    In type A planes turn around the vertical axis, in type B around the horizontal one (IES LM-75).
    Angles that begin at 0 are symmetric; the lamp is dark beyond the file's angles.
    """
    theta, phi = np.meshgrid(
        *(
            np.linspace(0.0, end, count)
            for end, count in zip((180.0, 360.0), TABLE_SHAPE, strict=True)
        ),
        indexing="ij",
    )
    ahead, aside = np.cos(np.radians(theta)), np.sin(np.radians(theta))
    right, up = aside * np.cos(np.radians(phi)), aside * np.sin(np.radians(phi))
    turned, leaning = (right, up) if around_vertical else (up, right)
    turn_deg = np.degrees(np.arctan2(turned, ahead))
    lean_deg = np.degrees(np.arcsin(np.clip(leaning, -1.0, 1.0)))
    level, rise = (turn_deg, lean_deg) if around_vertical else (lean_deg, turn_deg)
    shares = []
    for asked, angles in ((rise, vertical), (level, horizontal)):
        asked = np.abs(asked) if angles[0] == 0.0 else asked
        # Each angle's share, (n, angles): hats, which interpolate.
        shares.append(
            [
                np.interp(asked.ravel(), angles, unit, left=0.0, right=0.0)
                for unit in np.eye(len(angles))
            ]
        )
    found = np.einsum("vn,hn,vh->n", *shares, candela, optimize=True)
    return np.asarray(found.reshape(TABLE_SHAPE))


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
