"""Measured spectra of materials: a CSV file, read and checked."""

import csv
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from daylight_numbers.spectra.eye_responses import HIGHEST_NM, LOWEST_NM
from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray
from vrut_lite.plain_numbers import plain_float
from vrut_lite.text_files import read_text

_MOST_BYTES = 16 << 20
# Spectrophotometers measure from 400 to 700 nm at least; the eye has 0.5 % of daylight beyond.
_FROM_NM, _TO_NM = 400.0, 700.0


class MaterialSpectra(NamedTuple):
    """Spectra of a file: `wavelength_nm` (n,) rising, and of each material, by its name, shares
    (n,) from 0 to 1: diffuse reflectance, of glass its transmittance at right angles."""

    file: str
    wavelength_nm: FloatArray
    shares: dict[str, FloatArray]

    def at(self, name: str, wavelength_nm: ArrayLike) -> FloatArray:
        """The spectrum (W,) of a material; beyond the file's ends their values."""
        return np.interp(np.asarray(wavelength_nm, float), self.wavelength_nm, self.shares[name])

    def notices(self) -> list[str]:
        """A line where the file does not cover all light."""
        low, high = self.wavelength_nm[0], self.wavelength_nm[-1]
        if low <= LOWEST_NM and high >= HIGHEST_NM:
            return []
        return [
            f"the spectra {self.file} cover {low:g} to {high:g} nm: from {LOWEST_NM:g} to "
            f"{HIGHEST_NM:g} nm their end values are taken beyond"
        ]


NO_SPECTRA = MaterialSpectra("", np.array([LOWEST_NM, HIGHEST_NM]), {})


def read_spectra(path: str | Path) -> MaterialSpectra:
    """A heading with the wavelength's column and names of materials, then a row a wavelength (nm).

    Remarks begin with #.

    Raises:
        UserError: the file cannot be read, its wavelengths do not rise or miss light, or a value is
            no share.
    """
    file = Path(path)
    text = read_text(file, "the spectra", _MOST_BYTES)
    reader = csv.reader(text.split("\n"))
    cells = ((reader.line_num, [cell.strip() for cell in row]) for row in reader)
    rows = [(line, row) for line, row in cells if any(row) and not row[0].startswith("#")]
    names = rows[0][1][1:] if rows else []
    if not names or not all(names) or len(set(names)) < len(names):
        raise UserError(
            f"{file} has no heading of spectra: begin with wavelength_nm and a name of a material "
            "a column, each once"
        )
    numbers = np.array([_row(file, line, row, 1 + len(names)) for line, row in rows[1:]])
    if len(numbers) < 2:
        raise UserError(f"{file} has {len(numbers)} wavelengths: give a row each, at least two")
    nm = numbers[:, 0]
    for n, (before, after) in enumerate(pairwise(nm)):
        if not before < after:
            line = rows[n + 2][0]
            raise UserError(
                f"line {line} of {file}: wavelengths must rise, not from {before:g} to {after:g}"
            )
    if nm[0] > _FROM_NM or nm[-1] < _TO_NM:
        raise UserError(
            f"the spectra {file} cover {nm[0]:g} to {nm[-1]:g} nm: give at least {_FROM_NM:g} to "
            f"{_TO_NM:g} nm"
        )
    return MaterialSpectra(str(file), nm, dict(zip(names, numbers[:, 1:].T, strict=True)))


def _row(file: Path, line: int, row: list[str], count: int) -> list[float]:
    """The numbers of a row, shares after the wavelength."""
    if len(row) != count:
        raise UserError(f"line {line} of {file} has {len(row)} numbers: its heading has {count}")
    try:
        numbers = [plain_float(cell) for cell in row]
    except ValueError:
        raise UserError(f"line {line} of {file} is no numbers: {','.join(row)[:80]}") from None
    if not np.isfinite(numbers[0]) or numbers[0] <= 0.0:
        raise UserError(f"line {line} of {file}: {row[0]} is no wavelength in nm")
    for cell, share in zip(row[1:], numbers[1:], strict=True):
        if not 0.0 <= share <= 1.0:
            raise UserError(f"line {line} of {file}: {cell} is no share from 0 to 1")
    return numbers
