"""Measured skies: those of Kider et al. 2014 over Ithaca, New York, on 27 May 2013.

"A Framework for the Experimental Comparison of Solar and Skydome Illumination", ACM TOG 33(6).
They are read from the folders or 7z archives in which they were published, or from one npz
that holds several times; what comes out is the same.
"""

from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite_studies.framework.npz_file import read_npz
from vrut_lite_studies.framework.scan_files import RawScan, read_archive, read_folder
from vrut_lite_studies.framework.scan_order import sample_of_direction
from vrut_lite_studies.framework.spectra import resampled
from vrut_lite_studies.framework.sun_azimuth import estimated_sun_azimuth
from vrut_lite_studies.framework.sun_coordinates import sun_coordinates

LATITUDE_DEG, LONGITUDE_DEG = 42.44337, -76.48163
EASTERN_DAYLIGHT_TIME = timezone(timedelta(hours=-4), "EDT")
# In every scan the first sample, north and 12 deg up, is far from its neighbours.
_FAULTY, _NEIGHBOURS = 0, (1, 31)


@dataclass(frozen=True, eq=False)
class MeasuredSky:
    """The sky at one time.

    Attributes:
        time: aware.
        radiance: (81, 40) in the `directions`, W m^-2 sr^-1 nm^-1.
    """

    time: datetime
    radiance: NDArray[np.float64]

    @cached_property
    def _sun(self) -> tuple[float, float]:
        return sun_coordinates(self.time, LATITUDE_DEG, LONGITUDE_DEG)

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
        return [from_raw(read_archive(path))]
    if path.suffix == ".npz":
        return sorted((from_raw(scan) for scan in read_npz(path)), key=lambda sky: sky.time)
    raise UserError(f"{path}: measurements come as a folder, a .7z or an .npz")


def from_raw(scan: RawScan) -> MeasuredSky:
    """A scan as the evaluation takes it: resampled, faulty sample replaced, in usual order."""
    radiance = resampled(scan.wavelength_nm, scan.radiance)
    radiance[_FAULTY] = radiance[list(_NEIGHBOURS)].mean(axis=0)
    time = scan.time.replace(tzinfo=EASTERN_DAYLIGHT_TIME)
    return MeasuredSky(time, radiance[sample_of_direction()])


def _read_directory(path: Path) -> list[MeasuredSky]:
    if any(path.glob("*.txt")):
        return [from_raw(read_folder(path))]
    scans = [each for each in sorted(path.iterdir()) if each.is_dir() and any(each.glob("*.txt"))]
    folders = [read_folder(each) for each in scans]
    archives = [read_archive(each) for each in sorted(path.glob("*.7z"))]
    if not folders and not archives:
        raise UserError(f"{path}: holds no scans: neither .txt files nor folders or .7z of them")
    return sorted((from_raw(scan) for scan in folders + archives), key=lambda sky: sky.time)
