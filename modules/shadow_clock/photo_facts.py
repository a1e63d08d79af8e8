"""Time and place of a photograph by its EXIF, as far as it has them."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps

from vrut_lite.errors import UserError

# EXIF 2.32, tables 8 and 15.
_EXIF_IFD, _GPS_IFD = 0x8769, 0x8825
_TAKEN, _OFFSET = 0x9003, 0x9011
_LATITUDE, _LONGITUDE = (1, 2), (3, 4)
_LONGEST_SIDE_PX = 4096


class PhotoFacts(NamedTuple):
    """A photograph's pixels (h, w, 3), sRGB and upright, reduced if they are many, and its EXIF.

    `width_px` is the file's own width. `taken` is an ISO time, with an offset if EXIF has one, or
    empty; `place` latitude and longitude in degrees, or None.
    """

    pixels: NDArray[np.uint8]
    width_px: int
    taken: str
    place: tuple[float, float] | None


def read_photo(path: Path) -> PhotoFacts:
    """A photograph and its facts; of a large one at most 4096 pixels a side.

    Raises:
        UserError: the file is missing or is no picture.
    """
    try:
        with Image.open(path) as picture:
            exif = picture.getexif()
            upright = ImageOps.exif_transpose(picture).convert("RGB")
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise UserError(f"cannot open the picture {path}: {error}") from None
    width_px = upright.width
    upright.thumbnail((_LONGEST_SIDE_PX, _LONGEST_SIDE_PX))
    taken, gps = exif.get_ifd(_EXIF_IFD), exif.get_ifd(_GPS_IFD)
    latitude, longitude = _angle(gps, *_LATITUDE, "S"), _angle(gps, *_LONGITUDE, "W")
    place = None if latitude is None or longitude is None else (latitude, longitude)
    return PhotoFacts(np.asarray(upright), width_px, _taken(taken), place)


def _taken(found: dict[int, Any]) -> str:
    """An ISO time of EXIF's "2026:06:21 18:30:05"."""
    text = str(found.get(_TAKEN, "")).strip()
    date, _, clock = text.partition(" ")
    if not (clock and date.count(":") == 2):
        return ""
    return f"{date.replace(':', '-')}T{clock}{str(found.get(_OFFSET, '')).strip()}"


def _angle(gps: dict[int, Any], side: int, parts: int, negative: str) -> float | None:
    """Degrees of degrees, minutes and seconds; None where they are missing or impossible."""
    try:
        degrees, minutes, seconds = (float(part) for part in gps[parts])
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        return None
    angle = degrees + minutes / 60.0 + seconds / 3600.0
    if not 0.0 <= angle <= 180.0:
        return None
    return -angle if str(gps.get(side, "")).upper().startswith(negative) else angle
