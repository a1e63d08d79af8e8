"""A luminaire: its luminous intensity in all directions, power and luminous opening."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.messages.lamps import TABLE_SHAPE
from vrut_lite.numeric_types import FloatArray
from vrut_lite.scene.photometry import NEARLY_DEG, Photometry
from vrut_lite.scene.scene_file_error import SceneFileError

_MOST_CANDELA = 1e12
# Planes closer than this are one.
_SAME_DEG = 1e-6


class LuminousOpening(NamedTuple):
    """The luminous area around the photometric centre, in metres: `length_m` along the luminaire's
    +X, `width_m` along +Y, `height_m` along its axis; `is_round`: an ellipse, not a rectangle."""

    width_m: float
    length_m: float
    height_m: float
    is_round: bool


@dataclass(frozen=True, eq=False)
class Luminaire:
    """The photometric data of a luminaire.

    Directions count from its axis (the nadir of type C) and around it from its +X, its length, by
    +Y: IES's angle 0, EULUMDAT's C90. Intensity is linear between angles and 0 beyond those of
    `gamma_deg`.

    Attributes:
        gamma_deg: (G,) angles from the axis, rising.
        c_deg: (C,) angles around it, rising from 0 to 360.
        candela: (G, C) luminous intensity, cd, all factors of the file included.
        lamp_lm: luminous flux of its lamps, lm; None where photometry is absolute.
        watts: input power with ballasts, W; 0 where the file does not say it.
        opening: the luminous area.
    """

    gamma_deg: FloatArray
    c_deg: FloatArray
    candela: FloatArray
    lamp_lm: float | None
    watts: float
    opening: LuminousOpening

    @property
    def flux_lm(self) -> float:
        """Luminous flux of the luminaire, lm: the integral of its intensity over all directions.

        It is exact for intensities that are linear between the angles.
        """
        steps = np.diff(np.radians(self.c_deg))
        around = 0.5 * (self.candela[:, :-1] + self.candela[:, 1:]) @ steps
        gamma = np.radians(self.gamma_deg)
        if len(gamma) == 1:
            return 0.0
        slope = np.diff(around) / np.diff(gamma)
        cosine, sine = np.cos(gamma), np.sin(gamma)
        parts = around[:-1] * cosine[:-1] - around[1:] * cosine[1:] + slope * np.diff(sine)
        return float(parts.sum())

    def candela_at(self, gamma_deg: ArrayLike, c_deg: ArrayLike) -> FloatArray:
        """Luminous intensity, cd, at angles that are broadcast together."""
        gamma, c = np.broadcast_arrays(np.asarray(gamma_deg, float), np.asarray(c_deg, float))
        row, v = _between(self.gamma_deg, gamma)
        column, u = _between(self.c_deg, c % 360.0)
        row_after = np.minimum(row + 1, len(self.gamma_deg) - 1)
        near = self.candela[row, column] * (1.0 - u) + self.candela[row, column + 1] * u
        far = self.candela[row_after, column] * (1.0 - u) + self.candela[row_after, column + 1] * u
        inside = (gamma >= self.gamma_deg[0]) & (gamma <= self.gamma_deg[-1])
        return np.where(inside, near * (1.0 - v) + far * v, 0.0)

    def intensity_cd(self, local: ArrayLike) -> FloatArray:
        """Luminous intensity (...), cd, into unit vectors (..., 3) along axis, +X and +Y."""
        along, across, aside = np.moveaxis(np.asarray(local, float), -1, 0)
        # The arc tangent keeps small angles that a cosine near 1 would lose.
        gamma = np.degrees(np.arctan2(np.hypot(across, aside), along))
        return self.candela_at(gamma, np.degrees(np.arctan2(aside, across)))

    def photometry(self) -> Photometry:
        """Its intensity at the nodes of a scene's table."""
        rows, columns = TABLE_SHAPE
        theta, phi = np.linspace(0.0, 180.0, rows), np.linspace(0.0, 360.0, columns)
        return Photometry.of(self.candela_at(theta[:, None], phi[None]))


def _between(nodes: FloatArray, values: FloatArray) -> tuple[np.ndarray, FloatArray]:
    """The node before each value, and the share of the way to the next one."""
    before = np.clip(np.searchsorted(nodes, values, side="right") - 1, 0, max(len(nodes) - 2, 0))
    if len(nodes) == 1:
        return before, np.zeros(values.shape)
    share = (values - nodes[before]) / (nodes[before + 1] - nodes[before])
    return before, np.clip(share, 0.0, 1.0)


def around_by_symmetry(
    planes_deg: FloatArray, candela: FloatArray, first_deg: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Planes (C,) all around, from 0 to 360 degrees, and their candela (V, C).

    Planes that end at 90 or 180 degrees, or go from 90 to 270, repeat by symmetry; others close the
    circle.

    Args:
        planes_deg: (H,) rising, of the file.
        candela: (V, H).
        first_deg: the file's plane that becomes 0.
    """
    if planes_deg[-1] - planes_deg[0] > 360.0 - NEARLY_DEG:
        planes_deg, candela = planes_deg[:-1], candela[:, :-1]
    mirrored = [planes_deg, 180.0 - planes_deg, 180.0 + planes_deg, -planes_deg]
    last = float(planes_deg[-1])
    if abs(last - 180.0) < NEARLY_DEG:
        mirrored = [planes_deg, -planes_deg]
    elif abs(last - 270.0) < NEARLY_DEG and abs(float(planes_deg[0]) - 90.0) < NEARLY_DEG:
        mirrored = [planes_deg, 180.0 - planes_deg]
    elif abs(last - 90.0) >= NEARLY_DEG:
        mirrored = [planes_deg]
    nodes = np.unique(np.concatenate([(np.concatenate(mirrored) - first_deg) % 360.0, [0.0]]))
    nodes = nodes[np.append(np.diff(nodes) > _SAME_DEG, 360.0 - nodes[-1] > _SAME_DEG)]
    nodes = np.append(nodes if nodes[0] == 0.0 else np.append(0.0, nodes[1:]), 360.0)
    folded = _folded((nodes + first_deg) % 360.0, planes_deg)
    found = np.array([np.interp(folded, planes_deg, row, period=360.0) for row in candela])
    found[:, -1] = found[:, 0]
    return nodes, found


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


class Word(NamedTuple):
    """A word of a file, and its line, counted from 1."""

    text: str
    line: int


def words_of(text: str, first_line: int) -> list[Word]:
    """The words of a text, which spaces and line ends separate."""
    return [
        Word(word, number)
        for number, line in enumerate(text.split("\n"), first_line)
        for word in line.split()
    ]


def finite_numbers(words: list[Word], kind: str) -> FloatArray:
    """The numbers of a luminaire's file; `kind` names its format.

    Raises:
        SceneFileError: one is no finite number.
    """
    values = np.empty(len(words))
    for n, word in enumerate(words):
        try:
            values[n] = float(word.text)
        except ValueError:
            raise SceneFileError(
                f"{kind} is damaged in line {word.line}: {ascii(word.text)[:40]} is no number; "
                "fetch it again"
            ) from None
    bad = np.flatnonzero(~np.isfinite(values))
    if len(bad):
        raise SceneFileError(
            f"{kind} holds a number that is not finite in line {words[bad[0]].line}; fetch it again"
        )
    return values


def check_candela(candela: FloatArray, words: list[Word], kind: str) -> None:
    """Raise SceneFileError unless the candela (N,) of so many words are possible."""
    bad = np.flatnonzero(~((candela >= 0.0) & (candela <= _MOST_CANDELA)))
    if len(bad):
        raise SceneFileError(
            f"{kind} has impossible candela in line {words[bad[0]].line}; mend that file"
        )


def check_rising(angles: FloatArray, words: list[Word], kind: str) -> None:
    """Raise SceneFileError unless the angles (N,) of so many words rise."""
    bad = np.flatnonzero(~(np.diff(angles) > 0.0))
    if len(bad):
        raise SceneFileError(
            f"angles of {kind} do not rise in line {words[bad[0] + 1].line}; mend that file"
        )


def cut_short(kind: str) -> SceneFileError:
    """The error of a file with too few numbers."""
    return SceneFileError(f"{kind} is cut short; fetch that file again")
