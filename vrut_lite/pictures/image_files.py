"""Picture files: the formats and their writers.

A command asks `picture_format` and `check_writable` first, then works, then writes.
"""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite.pictures.picture_array import Metadata
from vrut_lite.pictures.write_exr import write_exr
from vrut_lite.pictures.write_hdr import write_hdr
from vrut_lite.pictures.write_jpeg import write_jpeg
from vrut_lite.pictures.write_json import write_json
from vrut_lite.pictures.write_npz import write_npz
from vrut_lite.pictures.write_png import write_png
from vrut_lite.write_atomic import atomic_output, check_all_writable, check_writable

__all__ = [
    "DISPLAY_FORMATS",
    "PICTURE_FORMATS",
    "Metadata",
    "atomic_output",
    "check_all_writable",
    "check_writable",
    "picture_format",
    "write_exr",
    "write_hdr",
    "write_jpeg",
    "write_json",
    "write_npz",
    "write_picture",
    "write_png",
]

PICTURE_FORMATS = (".exr", ".hdr", ".npz", ".png")
# Pictures of scenes: display values, or radiance in EXR.
DISPLAY_FORMATS = (".png", ".jpg", ".exr")


def picture_format(path: str | os.PathLike[str], known: tuple[str, ...] = PICTURE_FORMATS) -> str:
    """The suffix of the path in lower case, one of `known`.

    Raises:
        UserError: another suffix or none.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in known:
        given = f"'{suffix}' is no picture format" if suffix else "it has no suffix"
        raise UserError(f"cannot write {path}: {given}; known are {', '.join(known)}")
    return suffix


def write_picture(
    path: str | os.PathLike[str],
    radiance: NDArray[np.floating],
    display: NDArray[np.integer],
    metadata: Metadata | None = None,
    xmp: bytes = b"",
) -> None:
    """Write a picture in the format of its suffix, one of DISPLAY_FORMATS.

    Args:
        path: the file.
        radiance: (h, w, 3) linear sRGB, W m^-2 sr^-1, for EXR.
        display: (h, w, 3) display values of 8 bits, or for PNG of 16.
        metadata: texts and numbers by name.
        xmp: an XMP packet, which EXR lacks; empty for none.

    Raises:
        UserError: another suffix, or the file cannot be written.
    """
    suffix = picture_format(path, DISPLAY_FORMATS)
    if suffix == ".exr":
        write_exr(path, radiance, metadata or {})
    else:
        (write_jpeg if suffix == ".jpg" else write_png)(path, display, metadata or {}, xmp)
