"""Writes sRGB pictures as JPEG (ITU-T T.81)."""

import json
import os

from numpy.typing import NDArray
from PIL import Image

from vrut_lite.pictures.picture_array import Metadata, require_picture
from vrut_lite.write_atomic import atomic_output

# Colour is kept in every pixel: edges of roofs against the sky would fringe.
_QUALITY, _SUBSAMPLING = 95, 0


def write_jpeg(
    path: str | os.PathLike[str], rgb: NDArray, metadata: Metadata | None = None, xmp: bytes = b""
) -> None:
    """Write (h, w, 3) uint8, sRGB encoded; metadata as JSON in the file's comment, and XMP.

    Raises:
        ValueError: another shape or type.
        UserError: the file cannot be written.
    """
    require_picture(rgb, ("uint8",))
    said = json.dumps(metadata or {}, default=str)
    with atomic_output(path) as beside:
        Image.fromarray(rgb).save(
            beside,
            format="JPEG",
            quality=_QUALITY,
            subsampling=_SUBSAMPLING,
            comment=said,
            xmp=xmp,
        )
