"""8-bit sRGB pictures as PNG (ISO/IEC 15948)."""

import os

from numpy.typing import NDArray
from PIL import Image, PngImagePlugin

from vrut_lite.render.picture_array import Metadata, require_picture
from vrut_lite.render.write_atomic import atomic_output

_PERCEPTUAL_INTENT = b"\x00"


def write_png(
    path: str | os.PathLike[str], rgb8: NDArray, metadata: Metadata | None = None
) -> None:
    """Write (h, w, 3) uint8, sRGB encoded; metadata as text chunks, the sRGB chunk set.

    Raises:
        ValueError: another shape or type.
        UserError: the file cannot be written.
    """
    require_picture(rgb8, ("uint8",))
    chunks = PngImagePlugin.PngInfo()
    chunks.add(b"sRGB", _PERCEPTUAL_INTENT)
    for key, value in (metadata or {}).items():
        chunks.add_text(key, str(value))
    with atomic_output(path) as beside:
        Image.fromarray(rgb8).save(beside, format="PNG", pnginfo=chunks)
