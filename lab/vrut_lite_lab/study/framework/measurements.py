"""Measured skies: those of Kider et al. 2014 over Ithaca, New York, or another day's.

"A Framework for the Experimental Comparison of Solar and Skydome Illumination", ACM TOG 33(6).
`day.toml` beside the scans says what is known of another day. They are read from the folders or 7z
archives in which they were published, or from one npz that holds several times; what comes out is
the same.
"""

from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite_lab.study.framework.day import KIDER, MeasuredDay, day_of
from vrut_lite_lab.study.framework.npz_file import read_npz
from vrut_lite_lab.study.framework.scan_files import RawScan, read_archive, read_folder
from vrut_lite_lab.study.framework.scan_order import sample_of_direction
from vrut_lite_lab.study.framework.spectra import resampled
from vrut_lite_lab.study.framework.sun_azimuth import estimated_sun_azimuth
from vrut_lite_lab.study.framework.sun_coordinates import sun_coordinates

# In every scan the first sample, north and 12 deg up, is far from its neighbours.
_FAULTY, _NEIGHBOURS = 0, (1, 31)


@dataclass(frozen=True, eq=False)
class MeasuredSky:
    """The sky at one time.

    Attributes:
        time: aware.
        radiance: (81, 40) in the `directions`, W m^-2 sr^-1 nm^-1.
        day: with the place.
    """

    time: datetime
    radiance: NDArray[np.float64]
    day: MeasuredDay = KIDER

    @cached_property
    def _sun(self) -> tuple[float, float]:
        return sun_coordinates(self.time, self.day.latitude_deg, self.day.longitude_deg)

    @property
    def sun_zenith_rad(self) -> float:
        """Computed zenith angle of the sun."""
        return self._sun[0]

    @property
    def expected_sun_azimuth_rad(self) -> float:
        """Computed azimuth of the sun."""
        return self._sun[1]

    @cached_property
    def sun_azimuth_rad(self) -> float:
        """The sun's azimuth in the instrument's own frame, estimated from the scan."""
        return estimated_sun_azimuth(self.radiance, self.expected_sun_azimuth_rad)


def read_measurements(path: Path) -> list[MeasuredSky]:
    """The skies at a path, in the order of time.

    Args:
        path: a scan's folder, a folder of such folders and archives, a 7z archive, or an npz.

    Raises:
        UserError: nothing is there, or something is damaged; the sentence names file and line.
    """
    if path.is_dir():
        return _read_directory(path)
    if not path.is_file():
        raise UserError(f"{path}: there are no measurements: give a folder, a .7z or an .npz")
    if path.suffix == ".7z":
        return _of_one_day([read_archive(path)], path.parent)
    if path.suffix == ".npz":
        return _of_one_day(read_npz(path), path.parent)
    raise UserError(f"{path}: measurements come as a folder, a .7z or an .npz")


def _of_one_day(scans: list[RawScan], folder: Path) -> list[MeasuredSky]:
    """The skies in the order of time.

    Raises:
        UserError: the scans are of several days, or nothing is known of theirs.
    """
    dates = sorted({scan.time.date() for scan in scans})
    if len(dates) != 1:
        raise UserError(f"{folder}: holds skies of {dates[0]} and {dates[-1]}: keep one day")
    day = day_of(folder, dates[0])
    return sorted((from_raw(scan, day) for scan in scans), key=lambda sky: sky.time)


def from_raw(scan: RawScan, day: MeasuredDay = KIDER) -> MeasuredSky:
    """A scan as the evaluation takes it: resampled, faulty sample replaced, in usual order."""
    radiance = resampled(scan.wavelength_nm, scan.radiance)
    radiance[_FAULTY] = radiance[list(_NEIGHBOURS)].mean(axis=0)
    time = scan.time.replace(tzinfo=day.zone)
    return MeasuredSky(time, radiance[sample_of_direction()], day)


def _read_directory(path: Path) -> list[MeasuredSky]:
    if any(path.glob("*.txt")):
        return _of_one_day([read_folder(path)], path)
    scans = [each for each in sorted(path.iterdir()) if each.is_dir() and any(each.glob("*.txt"))]
    folders = [read_folder(each) for each in scans]
    archives = [read_archive(each) for each in sorted(path.glob("*.7z"))]
    if not folders and not archives:
        raise UserError(f"{path}: holds no scans: neither .txt files nor folders or .7z of them")
    return _of_one_day(folders + archives, path)
