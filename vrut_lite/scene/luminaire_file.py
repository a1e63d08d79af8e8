"""Files of luminaires: IES, or EULUMDAT (.ldt), told apart by what they hold.

EULUMDAT (A. Stockmar 1990, "Eulumdat - ein Leuchtendatenformat für den europäischen
Beleuchtungsplaner", Licht '90) has a quantity a line: 26 lines of the luminaire, six for each of
its sets of lamps, ten direct ratios, the angles of the C-planes and in each plane, and candela for
1000 lm of the lamps.
"""

import numpy as np

from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.ies_file import is_ies, read_ies
from vrut_lite.scene.photometry import (
    MOST_ANGLES,
    NEARLY_DEG,
    Photometry,
    check_candela,
    cut_short,
    finite_numbers,
    table_of_planes,
)
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.text_files import decoded, plain_text

_KIND = "an EULUMDAT file"
# Numbers of lines, counted from 0.
_SYMMETRY, _PLANES, _ANGLES, _FACTOR, _SETS = 2, 3, 5, 23, 25
_HEAD_LINES, _LINES_A_SET, _FLUX_OF_SET, _MOST_SETS = 26, 6, 2, 20
_DIRECT_RATIOS = 10


def read_luminaire(data: bytes) -> Photometry:
    """The photometry of an IES or EULUMDAT file.

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
    symmetry, planes, angles, factor, sets = (_number(lines[number]) for number in head)
    if not (symmetry in range(5) and planes in range(1, MOST_ANGLES) and sets in range(_MOST_SETS)):
        raise SceneFileError(
            f"an EULUMDAT file of it has symmetry {symmetry:g}, {planes:g} planes and {sets:g} "
            "sets of lamps in lines 3, 4 and 26; mend that file"
        )
    if angles not in range(1, MOST_ANGLES):
        raise SceneFileError(f"an EULUMDAT file of it has {angles:g} angles; mend that file")
    body = _HEAD_LINES + _LINES_A_SET * int(sets)
    lamps = lines[_HEAD_LINES:body]
    flux_lm = _number(lamps[_FLUX_OF_SET]) if len(lamps) > _FLUX_OF_SET else 0.0
    if not (flux_lm > 0.0 and factor > 0.0):
        raise SceneFileError(
            "an EULUMDAT file of it has no conversion factor or no luminous flux of lamps, in "
            "lines 24 and 29; mend that file"
        )
    gamma, c, intensity = _parts(lines[body:], int(symmetry), int(planes), int(angles))
    candela = intensity * factor * flux_lm / 1000.0
    check_candela(candela, _KIND)
    return Photometry.of(_turned(table_of_planes(gamma, c, candela)))


def _turned(table: FloatArray) -> FloatArray:
    """Candela (V, H) counted from C90, which lies along a luminaire's length, as an IES's angle 0.

    C0 is across the lamps' axis (CIE 121-1996; EN 13032-1), the plane of 0 and 180 degrees along it
    (IESNA LM-63-95); both count in one sense.
    """
    once = np.roll(table[:, :-1], -(table.shape[1] - 1) // 4, axis=1)
    return np.append(once, once[:, :1], axis=1)


def _number(line: str) -> float:
    """The number with which a line begins; 0 of an empty one."""
    return _numbers(line.split()[:1] or ["0"])[0]


def _numbers(words: list[str]) -> list[float]:
    """Numbers with a point, or the decimal comma of Germany's programs."""
    return finite_numbers([word.replace(",", ".") for word in words], _KIND)


def _parts(
    lines: list[str], symmetry: int, planes: int, angles: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Angles (G,) from the nadir, of stored planes (C,), and intensities (G, C).

    Symmetry 3 is that of C90 and C270: planes from C270 by C0 to C90 are those from 90 to 270
    degrees, mirrored and in the other order.
    """
    quarter = planes // 4
    stored = {
        0: range(planes), 1: range(1), 2: range(planes // 2 + 1),
        3: range(3 * quarter, 3 * quarter + planes // 2 + 1), 4: range(quarter + 1),
    }[symmetry]  # fmt: skip
    values = _numbers(" ".join(lines).split())[_DIRECT_RATIOS:]
    needed = planes + angles + len(stored) * angles
    if len(values) < needed:
        raise cut_short(_KIND)
    c = np.array(values[:planes])[np.array(stored) % planes]
    gamma = np.array(values[planes : planes + angles])
    intensity = np.array(values[planes + angles : needed]).reshape(len(stored), angles).T
    if symmetry == 3:
        c, intensity = (180.0 - c[::-1]) % 360.0, intensity[:, ::-1]
    ends = {2: (0.0, 180.0), 3: (90.0, 270.0), 4: (0.0, 90.0)}.get(symmetry, (c[0], c[-1]))
    rising = np.all(np.diff(gamma) > 0.0) and np.all(np.diff(c) > 0.0)
    inside = min(gamma[0], c[0]) >= 0.0 and gamma[-1] <= 180.0 and c[-1] <= 360.0
    if not (rising and inside and np.allclose((c[0], c[-1]), ends, atol=NEARLY_DEG)):
        raise SceneFileError(
            "angles in an EULUMDAT file of it do not rise, or do not fit its symmetry; mend that "
            "file"
        )
    return gamma, c, intensity
