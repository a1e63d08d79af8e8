"""IES files (ANSI/IES LM-63, all editions): candela that a luminaire sends in each direction."""

import re

import numpy as np

from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.luminaire import (
    Luminaire,
    LuminousOpening,
    Word,
    around_by_symmetry,
    check_candela,
    check_rising,
    cut_short,
    finite_numbers,
    words_of,
)
from vrut_lite.scene.photometry import MOST_ANGLES
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.text_files import decoded, plain_text

_KIND = "the IES file"
_TILT = re.compile(r"^[ \t]*TILT[ \t]*=(.*)$", re.MULTILINE | re.IGNORECASE)
# The first line of the editions since 1995; that of 1991 is IESNA91, that of 1986 has none.
_LATER_EDITION = re.compile(r"\s*IES(NA)?\s*:\s*LM-63-(?!1986|1991)", re.IGNORECASE)
_TYPE_C, _TYPE_B, _TYPE_A = 1, 2, 3
_METRES_OF_UNIT = {1: 0.3048, 2: 1.0}
_HEAD = 13
# Nodes to which types A and B are brought: every half degree from the axis, 2.5 degrees around it.
_AIMED_SHAPE = (361, 145)


def is_ies(text: str) -> bool:
    """Whether a text has the line that every IES file has."""
    return _TILT.search(text) is not None


def read_ies(data: bytes) -> Luminaire:
    """The luminaire of an IES file, tilt and factors of ballast and lamp included.

    Candela of types A and B are interpolated at every half degree from the axis.

    Raises:
        SceneFileError: it is no IES file, or its numbers do not hold.
    """
    text = decoded(plain_text(data))
    tilt = _TILT.search(text)
    if tilt is None:
        raise SceneFileError(f"{_KIND} has no line TILT=; fetch that file again")
    first_line = text.count("\n", 0, tilt.end()) + 1
    words = words_of(text[tilt.end() :].replace(",", " "), first_line)
    if tilt[1].strip().upper() == "INCLUDE":
        # Lamp outputs by tilt angle: at the angle 0, as it is drawn here, the factor is 1.
        if len(words) < 2:
            raise cut_short(_KIND)
        words = words[2 + 2 * int(finite_numbers(words[1:2], _KIND)[0]) :]
    if len(words) < _HEAD:
        raise cut_short(_KIND)
    head = finite_numbers(words[:_HEAD], _KIND)
    lamps, lumens, multiplier, rows, columns, kind, unit = head[:7]
    ballast, ballast_lamp, watts = head[10:13]
    if _LATER_EDITION.match(text):
        # Since 1995 the number is kept for future use, and since 2019 it names who measured.
        ballast_lamp = 1.0
    if kind not in (_TYPE_A, _TYPE_B, _TYPE_C):
        raise SceneFileError(
            f"{_KIND} has photometry of type {kind:g} in line {words[5].line}, and there are 1, 2 "
            "and 3 (C, B and A); mend that file"
        )
    if not (1 <= rows <= MOST_ANGLES and 1 <= columns <= MOST_ANGLES):
        raise SceneFileError(
            f"{_KIND} has {rows:g} x {columns:g} angles in line {words[3].line}; mend that file"
        )
    lowest = 0.0 if kind == _TYPE_C else -180.0
    vertical, horizontal, candela = _parts(words[_HEAD:], int(rows), int(columns), lowest)
    factor = multiplier * ballast * ballast_lamp
    check_candela(factor * candela.T.ravel(), words[_HEAD + int(rows) + int(columns) :], _KIND)
    candela = factor * candela
    if kind == _TYPE_C:
        gamma = vertical
        c, candela = around_by_symmetry(horizontal, candela)
    else:
        gamma, c = (
            np.linspace(0.0, end, n) for end, n in zip((180.0, 360.0), _AIMED_SHAPE, strict=True)
        )
        candela = _aimed(gamma, c, (vertical, horizontal, candela), is_type_a=kind == _TYPE_A)
    # Lumens of -1 are absolute photometry: candela are those of the luminaire as it is.
    return Luminaire(
        gamma, c, candela, lamps * lumens if lumens >= 0.0 else None, max(float(watts), 0.0),
        _opening(*(head[7:10] * _METRES_OF_UNIT.get(unit, 1.0))),
    )  # fmt: skip


def _opening(width: float, length: float, height: float) -> LuminousOpening:
    """The luminous opening of all editions (table 1 of LM-63-02): negative dimensions are curved.

    In the editions to 1995 a circle has its diameter as width, and a horizontal cylinder as height.
    """
    is_round = width < 0.0 or length < 0.0
    across, along, high = abs(width), abs(length), abs(height)
    if is_round:
        across, along = across or along, along or across
    if height < 0.0 and (width > 0.0 or length > 0.0):
        # A cylinder that lies: its outline from below is a rectangle.
        return LuminousOpening(across or high, along or high, high, False)
    return LuminousOpening(across, along, high, is_round)


def _parts(words: list[Word], rows: int, columns: int, lowest_deg: float) -> tuple[FloatArray, ...]:
    """Vertical angles (V,), horizontal ones (H,), degrees, and candela (V, H)."""
    first = rows + columns
    if len(words) < first + rows * columns:
        raise cut_short(_KIND)
    values = finite_numbers(words[: first + rows * columns], _KIND)
    vertical, horizontal = values[:rows], values[rows:first]
    check_rising(vertical, words[:rows], _KIND)
    check_rising(horizontal, words[rows:first], _KIND)
    inside = min(vertical[0], horizontal[0]) >= lowest_deg and vertical[-1] <= 180.0
    if not (inside and horizontal[-1] <= 360.0):
        raise SceneFileError(
            f"{_KIND} has angles beyond {lowest_deg:g} to 180 and 360 degrees from line "
            f"{words[0].line} on; mend that file"
        )
    return vertical, horizontal, values[first:].reshape(columns, rows).T


def _aimed(
    gamma_deg: FloatArray, c_deg: FloatArray, file: tuple[FloatArray, ...], *, is_type_a: bool
) -> FloatArray:
    """Candela (G, C) of types A and B, whose angles (0, 0) point where the lamp is aimed.

    In type A planes turn around the vertical axis, in type B around the horizontal one (IES LM-75).
    Angles that begin at 0 are symmetric; the lamp is dark beyond the file's angles.
    """
    vertical, horizontal, candela = file
    theta, phi = np.meshgrid(np.radians(gamma_deg), np.radians(c_deg), indexing="ij")
    ahead, aside = np.cos(theta), np.sin(theta)
    right, up = aside * np.cos(phi), aside * np.sin(phi)
    turned, leaning = (right, up) if is_type_a else (up, right)
    turn_deg = np.degrees(np.arctan2(turned, ahead))
    lean_deg = np.degrees(np.arcsin(np.clip(leaning, -1.0, 1.0)))
    level, rise = (turn_deg, lean_deg) if is_type_a else (lean_deg, turn_deg)
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
    return np.asarray(found.reshape(theta.shape))
