"""A scan of the sky in its original files: 81 texts in a folder, or packed as 7z.

A file `<day>___<hour>_-_<sample>____<azimuth>___<elevation>.asd.rad.txt` holds a line of title
and then lines of wavelength (whole nm) and radiance (W m^-2 sr^-1 nm^-1). Whatever a damaged
file has instead is refused by its name and line.
"""

import re
from collections.abc import Mapping
from datetime import datetime
from itertools import pairwise
from math import isfinite
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite_lab.study.framework.directions import COUNT
from vrut_lite_lab.study.framework.scan_order import scan_directions
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM

_NAME = re.compile(
    r"(?P<time>\d{4}-\d\d-\d\d___\d\d\.\d\d\.\d\d)"
    r"_-_(?P<sample>\d+)____(?P<azimuth>[^_]+)___(?P<elevation>[^_]+)\.asd\.rad\.txt"
)
_TIME = "%Y-%m-%d___%H.%M.%S"
_FIRST_NM, _LAST_NM = int(WAVELENGTHS_NM[0]), int(np.ceil(WAVELENGTHS_NM[-1]))
# One file of the published scans has 60 kB.
_LARGEST_FILE_BYTES = 1_000_000


class RawScan(NamedTuple):
    """The content of one scan's files: local time, wavelengths (n,) in nm, radiance (81, n)."""

    time: datetime
    wavelength_nm: NDArray[np.float64]
    radiance: NDArray[np.float64]


def read_folder(folder: Path) -> RawScan:
    """The scan in a folder.

    Raises:
        UserError: a file is missing or damaged.
    """
    try:
        texts = {path.name: path.read_bytes() for path in sorted(folder.glob("*.txt"))}
    except OSError as error:
        raise UserError(f"{folder}: cannot be read: {error.strerror}") from None
    return parse_scan(texts, str(folder))


def read_archive(archive: Path) -> RawScan:
    """The scan in a 7z archive.

    Raises:
        UserError: the archive, or a file in it, is damaged, or py7zr is not installed.
    """
    return parse_scan(_unpacked(archive), str(archive))


def parse_scan(files: Mapping[str, bytes], place: str) -> RawScan:
    """The scan in files by name; `place` says in errors where they are.

    Raises:
        UserError: a file is missing or damaged.
    """
    named = _by_sample(files, place)
    first_name, time = named[0]
    for name, stamp in named:
        if stamp != time:
            raise UserError(f"{place}: {name} is of another time than {first_name}: keep one scan")
    spectra = [parse_spectrum(files[name], name) for name, _ in named]
    wavelength = spectra[0][:, 0]
    for (name, _), spectrum in zip(named, spectra, strict=True):
        if not np.array_equal(spectrum[:, 0], wavelength):
            raise UserError(
                f"{name}: has wavelengths {_span(spectrum[:, 0])}, but {first_name} has "
                f"{_span(wavelength)}: take both from the same measurement"
            )
    return RawScan(time, wavelength, np.stack([spectrum[:, 1] for spectrum in spectra]))


def parse_spectrum(content: bytes, name: str) -> NDArray[np.float64]:
    """Wavelengths in nm and radiances (n, 2) of one file.

    Raises:
        UserError: the file is invalid; the sentence names it and the line.
    """
    lines = _lines(content, name)
    rows = [_row(line, name, number) for number, line in enumerate(lines[1:], start=2)]
    for number, (before, after) in enumerate(pairwise(rows), start=3):
        if after[0] != before[0] + 1:
            raise UserError(
                f"{name}, line {number}: wavelength {after[0]} follows {before[0]}, but they "
                "must rise by 1 nm"
            )
    if not rows or rows[0][0] > _FIRST_NM or rows[-1][0] < _LAST_NM:
        span = f"{rows[0][0]} to {rows[-1][0]} nm" if rows else "none"
        raise UserError(
            f"{name}, line {len(lines)}: the wavelengths end here and are {span}, but "
            f"{_FIRST_NM} to {_LAST_NM} nm are needed"
        )
    return np.array(rows, dtype=float)


def _lines(content: bytes, name: str) -> list[str]:
    try:
        lines = content.decode("ascii").splitlines()
    except UnicodeDecodeError as error:
        number = content[: error.start].count(b"\n") + 1
        raise UserError(f"{name}, line {number}: is not plain text") from None
    if not lines or not lines[0].startswith("Wavelength"):
        raise UserError(f"{name}, line 1: must begin with 'Wavelength', as the published files do")
    return lines


def _row(line: str, name: str, number: int) -> tuple[int, float]:
    columns = line.split()
    if len(columns) != 2:
        raise UserError(
            f"{name}, line {number}: must hold a wavelength and a radiance, "
            f"but has {len(columns)} columns"
        )
    if not re.fullmatch(r"\d{1,5}", columns[0]):
        raise UserError(f"{name}, line {number}: {columns[0]!r} is not a whole number of nm")
    try:
        radiance = float(columns[1])
    except ValueError:
        raise UserError(f"{name}, line {number}: {columns[1]!r} is not a number") from None
    # Noise makes some radiances negative where the air is opaque, beyond 1300 nm.
    if not isfinite(radiance):
        raise UserError(f"{name}, line {number}: the radiance {columns[1]} must be finite")
    return int(columns[0]), radiance


def _by_sample(files: Mapping[str, bytes], place: str) -> list[tuple[str, datetime]]:
    """Name and time of each of the samples 0 to 80, none missing."""
    named: dict[int, tuple[str, datetime]] = {}
    for name in files:
        sample, time = _sample_and_time(name)
        if sample in named:
            raise UserError(f"{place}: {name} and {named[sample][0]} are both sample {sample}")
        named[sample] = name, time
    for sample, (azimuth, elevation) in enumerate(scan_directions()):
        if sample not in named:
            raise UserError(
                f"{place}: sample {sample} of 0 to {COUNT - 1} (file azimuth {azimuth}, elevation "
                f"{elevation} deg) is missing: unpack the scan anew"
            )
    return [named[sample] for sample in range(COUNT)]


def _sample_and_time(name: str) -> tuple[int, datetime]:
    parts = _NAME.fullmatch(name)
    if parts is None:
        raise UserError(
            f"{name}: is not named as a scan's files are, "
            "<day>___<hour>_-_<sample>____<azimuth>___<elevation>.asd.rad.txt"
        )
    sample = int(parts["sample"])
    if sample >= COUNT:
        raise UserError(f"{name}: sample {sample} is beyond the last one, {COUNT - 1}")
    expected = scan_directions()[sample]
    for what, given, right in zip(
        ("azimuth", "elevation"), (parts["azimuth"], parts["elevation"]), expected, strict=True
    ):
        if given != right:
            raise UserError(f"{name}: sample {sample} must have {what} {right} deg, not {given}")
    try:
        return sample, datetime.strptime(parts["time"], _TIME)
    except ValueError:
        raise UserError(f"{name}: {parts['time']} is no day and hour") from None


def _unpacked(archive: Path) -> dict[str, bytes]:
    try:
        import py7zr
        from py7zr.io import BytesIOFactory
    except ImportError:
        raise UserError(
            f"{archive}: reading 7z needs the extra `studies`: pip install 'vrut-lite-lab[studies]'"
        ) from None
    into = BytesIOFactory(_LARGEST_FILE_BYTES)
    try:
        with py7zr.SevenZipFile(archive) as packed:
            packed.extractall(factory=into)
    except OSError as error:
        raise UserError(f"{archive}: cannot be read: {error.strerror or error}") from None
    except (py7zr.exceptions.ArchiveError, EOFError, ValueError) as error:
        raise UserError(f"{archive}: is no whole 7z archive ({error})") from None
    files = {}
    for path, product in into.products.items():
        product.seek(0)
        files[Path(path).name] = product.read()
    return files


def _span(wavelength_nm: NDArray[np.float64]) -> str:
    return f"{wavelength_nm[0]:g} to {wavelength_nm[-1]:g} nm"
