"""Several scans of one day in one npz.

Its arrays: `time` (n,) as 11:45:00, of 27 May 2013, or as 2014-06-03T11:45:00; `file_azimuth_deg`
and `elevation_deg` (81,) of the samples, `wavelength_nm` (w,) and `radiance` (n, 81, w) in
W m^-2 sr^-1 nm^-1.
"""

from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite.npz_arrays import read_npz as read_arrays
from vrut_lite_lab.study.framework.directions import COUNT
from vrut_lite_lab.study.framework.scan_files import RawScan
from vrut_lite_lab.study.framework.scan_order import scan_directions
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM

_NUMBERS = ("file_azimuth_deg", "elevation_deg", "wavelength_nm", "radiance")
# Hundreds of a day's scans at every nanometre.
_MOST_BYTES = 1 << 30
_DAY = datetime(2013, 5, 27)


def read_npz(path: Path) -> list[RawScan]:
    """The scans in an npz.

    Raises:
        UserError: an array is missing or damaged.
    """
    arrays = _arrays(path)
    _check_wavelengths(path, arrays["wavelength_nm"])
    _check_directions(path, arrays)
    _check_radiance(path, arrays)
    wavelength = arrays["wavelength_nm"].astype(float)
    pairs = zip(arrays["time"], arrays["radiance"].astype(float), strict=True)
    return [RawScan(_time(path, str(text)), wavelength, radiance) for text, radiance in pairs]


def _arrays(path: Path) -> dict[str, NDArray[Any]]:
    try:
        with path.open("rb") as stream:
            arrays = read_arrays(stream, _MOST_BYTES)
    except (OSError, ValueError) as error:
        raise UserError(f"{path}: is no whole npz of measurements ({error})") from None
    for name in ("time", *_NUMBERS):
        if name not in arrays:
            raise UserError(f"{path}: holds no array {name}")
    for name in _NUMBERS:
        if arrays[name].dtype.kind not in "iuf":
            raise UserError(f"{path}: {name} must hold numbers")
    return arrays


def _check_wavelengths(path: Path, wavelength: NDArray[Any]) -> None:
    if wavelength.ndim != 1 or wavelength.size < 2 or not np.all(np.diff(wavelength) == 1):
        raise UserError(f"{path}: wavelength_nm must rise by 1 nm throughout")
    if wavelength[0] > WAVELENGTHS_NM[0] or wavelength[-1] < WAVELENGTHS_NM[-1]:
        first, last = WAVELENGTHS_NM[[0, -1]]
        raise UserError(f"{path}: wavelength_nm must span {first:g} to {last:g} nm")


def _check_directions(path: Path, arrays: dict[str, NDArray[Any]]) -> None:
    columns = np.array(scan_directions(), dtype=float).T
    for name, right in zip(("file_azimuth_deg", "elevation_deg"), columns, strict=True):
        if not np.array_equal(arrays[name], right):
            raise UserError(f"{path}: {name} is not that of the samples 0 to {COUNT - 1}")


def _check_radiance(path: Path, arrays: dict[str, NDArray[Any]]) -> None:
    radiance, times, wavelength = (arrays[name] for name in ("radiance", "time", "wavelength_nm"))
    if times.ndim != 1 or radiance.shape != (times.size, COUNT, wavelength.size):
        raise UserError(f"{path}: radiance must be of the shape (times, {COUNT}, wavelengths)")
    bad = np.argwhere(~np.isfinite(radiance))
    if bad.size:
        time, sample, band = bad[0]
        raise UserError(
            f"{path}: radiance at {times[time]}, sample {sample}, {wavelength[band]} nm must be "
            "finite"
        )


def _time(path: Path, text: str) -> datetime:
    try:
        if "T" in text:
            return datetime.strptime(text, "%Y-%m-%dT%H:%M:%S")
        return datetime.combine(_DAY, datetime.strptime(text, "%H:%M:%S").time())
    except ValueError:
        raise UserError(f"{path}: {text!r} among the times is no hour as 11:45:00") from None
