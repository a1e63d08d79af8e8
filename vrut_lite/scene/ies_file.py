"""IES files (ANSI/IES LM-63, all editions): candela that a luminaire sends in each direction."""

import re

import numpy as np

from vrut_lite.messages.lamps import TABLE_SHAPE
from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.photometry import (
    MOST_ANGLES,
    Photometry,
    check_candela,
    cut_short,
    finite_numbers,
    table_of_planes,
)
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.text_files import decoded, plain_text

_KIND = "an IES file"
_TILT = re.compile(r"^[ \t]*TILT[ \t]*=(.*)$", re.MULTILINE | re.IGNORECASE)
# The first line of the editions since 1995; that of 1991 is IESNA91, that of 1986 has none.
_LATER_EDITION = re.compile(r"\s*IES(NA)?\s*:\s*LM-63-(?!1986|1991)", re.IGNORECASE)
_SEPARATORS = re.compile(r"[\s,]+")
_TYPE_C, _TYPE_B, _TYPE_A = 1, 2, 3


def is_ies(text: str) -> bool:
    """Whether a text has the line that every IES file has."""
    return _TILT.search(text) is not None


def read_ies(data: bytes) -> Photometry:
    """The photometry of an IES file, tilt and factors of ballast and lamp included.

    Raises:
        SceneFileError: it is no IES file, or its numbers do not hold.
    """
    text = decoded(plain_text(data))
    tilt = _TILT.search(text)
    if tilt is None:
        raise SceneFileError("an IES file of it has no line TILT=; fetch that file again")
    words = [word for word in _SEPARATORS.split(text[tilt.end() :]) if word]
    if tilt[1].strip().upper() == "INCLUDE":
        # Lamp outputs by tilt angle: at the angle 0, as it is drawn here, the factor is 1.
        if len(words) < 2:
            raise cut_short(_KIND)
        words = words[2 + 2 * int(finite_numbers(words[1:2], _KIND)[0]) :]
    if len(words) < 13:
        raise cut_short(_KIND)
    head = finite_numbers(words[:13], _KIND)
    multiplier, rows, columns, kind = head[2:6]
    ballast, ballast_lamp = head[10:12]
    if _LATER_EDITION.match(text):
        # Since 1995 the number is kept for future use, and since 2019 it names who measured.
        ballast_lamp = 1.0
    if kind not in (_TYPE_A, _TYPE_B, _TYPE_C):
        raise SceneFileError(
            f"an IES file of it has photometry of type {kind:g}, and there are 1, 2 and 3 (C, B "
            "and A); mend that file"
        )
    if not (1 <= rows <= MOST_ANGLES and 1 <= columns <= MOST_ANGLES):
        raise SceneFileError(f"an IES file of it has {rows:g} x {columns:g} angles; mend that file")
    lowest = 0.0 if kind == _TYPE_C else -180.0
    vertical, horizontal, candela = _parts(words[13:], int(rows), int(columns), lowest)
    candela = candela * multiplier * ballast * ballast_lamp
    check_candela(candela, _KIND)
    if kind == _TYPE_C:
        return Photometry.of(table_of_planes(vertical, horizontal, candela))
    return Photometry.of(
        _aimed_table(vertical, horizontal, candela, around_vertical=kind == _TYPE_A)
    )


def _parts(words: list[str], rows: int, columns: int, lowest_deg: float) -> tuple[FloatArray, ...]:
    """Vertical angles (V,), horizontal ones (H,), degrees, and candela (V, H)."""
    first = rows + columns
    if len(words) < first + rows * columns:
        raise cut_short(_KIND)
    values = finite_numbers(words[: first + rows * columns], _KIND)
    vertical = np.array(values[:rows])
    horizontal = np.array(values[rows:first])
    candela = np.array(values[first:]).reshape(columns, rows).T
    rising = np.all(np.diff(vertical) > 0.0) and np.all(np.diff(horizontal) > 0.0)
    inside = min(vertical[0], horizontal[0]) >= lowest_deg and vertical[-1] <= 180.0
    if not (rising and inside and horizontal[-1] <= 360.0):
        raise SceneFileError("angles in an IES file of it do not rise; mend that file")
    return vertical, horizontal, candela


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
