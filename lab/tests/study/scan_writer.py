"""Scans of an invented sky in the published files' form, to read and to damage."""

import py7zr

from vrut_lite_lab.study.framework.scan_order import scan_directions

STAMP = "2013-05-27___11.45.00"
FIRST_NM, LAST_NM = 359, 820


def file_name(sample, stamp=STAMP, azimuth=None, elevation=None):
    """The name of a sample's file."""
    right_azimuth, right_elevation = scan_directions()[sample]
    azimuth, elevation = azimuth or right_azimuth, elevation or right_elevation
    return f"{stamp}_-_{sample}____{azimuth}___{elevation}.asd.rad.txt"


def file_lines(sample, stamp=STAMP):
    """Radiance sample + nm / 1000, so that each number says where it comes from."""
    title = "Wavelength\t" + file_name(sample, stamp).removesuffix(".txt")
    nm = range(FIRST_NM, LAST_NM + 1)
    return [title, *(f"{each}\t  {sample + each / 1000.0:.6E}  " for each in nm)]


def file_content(lines):
    """A file of these lines, with the published line ends."""
    return "".join(line + "\r\n" for line in lines).encode()


def scan_files(stamp=STAMP):
    """A whole scan as contents by file name."""
    return {file_name(s, stamp): file_content(file_lines(s, stamp)) for s in range(81)}


def write_scan(folder, stamp=STAMP):
    """A whole scan in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, inside in scan_files(stamp).items():
        (folder / name).write_bytes(inside)
    return folder


def pack(folder, archive):
    """A scan's folder as an archive, stored: to compress it takes half a second."""
    with py7zr.SevenZipFile(archive, "w", filters=[{"id": py7zr.FILTER_COPY}]) as packed:
        packed.writeall(folder, STAMP)
