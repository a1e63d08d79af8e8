"""Files of luminaires: IES, or EULUMDAT (.ldt), told apart by what they hold.

EULUMDAT (A. Stockmar 1990, "Eulumdat - ein Leuchtendatenformat für den europäischen
Beleuchtungsplaner", Licht '90) has a quantity a line: 26 lines of the luminaire, six for each of
its sets of lamps, ten direct ratios, the angles of the C-planes and in each plane, and candela for
1000 lm of the lamps.
"""

from pathlib import Path

import numpy as np

from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.ies_file import is_ies, read_ies
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
from vrut_lite.scene.photometry import MOST_ANGLES, NEARLY_DEG
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.text_files import decoded, plain_text

_KIND = "the EULUMDAT file"
# Numbers of lines, counted from 0.
_SYMMETRY, _PLANES, _ANGLES, _FACTOR, _SETS = 2, 3, 5, 23, 25
_LENGTH, _WIDTH, _HEIGHTS = 15, 16, slice(17, 21)
_HEAD_LINES, _LINES_A_SET, _MOST_SETS = 26, 6, 20
_LAMPS_OF_SET, _FLUX_OF_SET, _WATTS_OF_SET = 0, 2, 5
_DIRECT_RATIOS = 10
# The plane along a luminaire's length, which is an IES file's angle 0 (IESNA LM-63-95); C0 is
# across it (CIE 121-1996; EN 13032-1). Both count in one sense.
_ALONG_DEG = 90.0
_MOST_BYTES = 16 << 20


def read_luminaire_file(path: str | Path) -> Luminaire:
    """The luminaire of an IES or EULUMDAT file.

    Raises:
        UserError: the file cannot be read, or is damaged.
    """
    file = Path(path)
    try:
        if file.stat().st_size > _MOST_BYTES:
            raise UserError(f"the luminaire {file} is more than {_MOST_BYTES >> 20} MB")
        return read_luminaire(file.read_bytes())
    except OSError as error:
        reason = error.strerror or error
        raise UserError(f"cannot read the luminaire {file}: {reason}") from None
    except SceneFileError as fault:
        raise UserError(f"cannot read the luminaire {file}: {fault}") from None


def read_luminaire(data: bytes) -> Luminaire:
    """The luminaire of an IES or EULUMDAT file.

    Of an EULUMDAT file's sets of lamps, which are alternatives, the first one shines; plane C90
    is the angle 0 of an IES file.

    Raises:
        SceneFileError: it is neither, or its numbers do not hold.
    """
    text = decoded(plain_text(data))
    if is_ies(text):
        return read_ies(data)
    lines = text.split("\n")
    if len(lines) < _HEAD_LINES:
        raise SceneFileError(
            "it is neither an IES file, which has a line TILT=, nor an EULUMDAT file, which has 26 "
            "lines and more; choose another file"
        )
    head = (_SYMMETRY, _PLANES, _ANGLES, _FACTOR, _SETS)
    symmetry, planes, angles, factor, sets = (_number(lines, number) for number in head)
    if not (symmetry in range(5) and planes in range(1, MOST_ANGLES) and sets in range(_MOST_SETS)):
        raise SceneFileError(
            f"{_KIND} has symmetry {symmetry:g}, {planes:g} planes and {sets:g} sets of lamps in "
            "lines 3, 4 and 26; mend that file"
        )
    if angles not in range(1, MOST_ANGLES):
        raise SceneFileError(f"{_KIND} has {angles:g} angles in line 6; mend that file")
    body = _HEAD_LINES + _LINES_A_SET * int(sets)
    has_lamps = sets > 0 and len(lines) >= body
    flux_lm = _number(lines, _HEAD_LINES + _FLUX_OF_SET) if has_lamps else 0.0
    if not (flux_lm > 0.0 and factor > 0.0):
        raise SceneFileError(
            f"{_KIND} has no conversion factor or no luminous flux of lamps, in lines 24 and 29; "
            "mend that file"
        )
    gamma, c, candela = _parts(
        words_of("\n".join(lines[body:]), body + 1),
        int(symmetry), int(planes), int(angles), factor * flux_lm / 1000.0,
    )  # fmt: skip
    around, candela = around_by_symmetry(c, candela, _ALONG_DEG)
    # A negative number of lamps is absolute photometry: the flux is the luminaire's own.
    is_absolute = _number(lines, _HEAD_LINES + _LAMPS_OF_SET) < 0.0
    watts = max(_number(lines, _HEAD_LINES + _WATTS_OF_SET), 0.0)
    lamp_lm = None if is_absolute else float(flux_lm)
    return Luminaire(gamma, around, candela, lamp_lm, float(watts), _opening(lines))


def _opening(lines: list[str]) -> LuminousOpening:
    """The luminous area, in mm in the file; a width of 0 makes its length the diameter."""
    length_m, width_m = (max(_number(lines, n), 0.0) / 1000.0 for n in (_LENGTH, _WIDTH))
    heights = [_number(lines, n) for n in range(*_HEIGHTS.indices(_HEAD_LINES))]
    is_round = width_m == 0.0 and length_m > 0.0
    height_m = max(*heights, 0.0) / 1000.0
    return LuminousOpening(length_m if is_round else width_m, length_m, height_m, is_round)


def _number(lines: list[str], number: int) -> float:
    """The number with which a line begins, lines counted from 0; 0 of an empty one."""
    words = lines[number].split()[:1]
    return _numbers([Word(word, number + 1) for word in words] or [Word("0", number + 1)])[0]


def _numbers(words: list[Word]) -> FloatArray:
    """Numbers with a point, or the decimal comma of Germany's programs."""
    return finite_numbers([Word(text.replace(",", "."), line) for text, line in words], _KIND)


def _parts(
    words: list[Word], symmetry: int, planes: int, angles: int, factor: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Angles (G,) from the nadir, of stored planes (C,), and candela (G, C).

    Symmetry 3 is that of C90 and C270: planes from C270 by C0 to C90 are those from 90 to 270
    degrees, mirrored and in the other order.
    """
    quarter = planes // 4
    stored = {
        0: range(planes), 1: range(1), 2: range(planes // 2 + 1),
        3: range(3 * quarter, 3 * quarter + planes // 2 + 1), 4: range(quarter + 1),
    }[symmetry]  # fmt: skip
    needed = _DIRECT_RATIOS + planes + angles + len(stored) * angles
    if len(words) < needed:
        raise cut_short(_KIND)
    values, words = _numbers(words[:needed])[_DIRECT_RATIOS:], words[_DIRECT_RATIOS:]
    c = values[:planes][np.array(stored) % planes]
    gamma = values[planes : planes + angles]
    check_rising(gamma, words[planes : planes + angles], _KIND)
    candela = factor * values[planes + angles :]
    check_candela(candela, words[planes + angles :], _KIND)
    candela = candela.reshape(len(stored), angles).T
    if symmetry == 3:
        c, candela = (180.0 - c[::-1]) % 360.0, candela[:, ::-1]
    ends = {2: (0.0, 180.0), 3: (90.0, 270.0), 4: (0.0, 90.0)}.get(symmetry, (c[0], c[-1]))
    inside = min(gamma[0], c[0]) >= 0.0 and gamma[-1] <= 180.0 and c[-1] <= 360.0
    fits = np.allclose((c[0], c[-1]), ends, atol=NEARLY_DEG)
    if not (np.all(np.diff(c) > 0.0) and inside and fits):
        raise SceneFileError(
            f"angles of {_KIND} do not rise, or do not fit its symmetry, from line {words[0].line} "
            "on; mend that file"
        )
    return gamma, c, candela
