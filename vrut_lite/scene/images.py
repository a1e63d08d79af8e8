"""Decodes textures; checks each header before any pixel."""

import warnings
from io import BytesIO

import numpy as np
from PIL import Image

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.ktx2_images import decode_ktx2, is_ktx2, ktx2_size
from vrut_lite.scene.scene_file_error import SceneFileError

MAX_IMAGE_PIXELS = 64 * 2**20
MAX_TOTAL_PIXELS = 256 * 2**20
# Pillow keeps RGB and RGBA alike in four bytes.
_PIXEL_BYTES, _IMAGE_BYTES = 4, 4096
# Each scan of a JPEG, however short, is a pass over all pixels; usual files have up to 10.
_JPEG_SCAN = b"\xff\xda"
_MOST_SCANNED_PIXELS = 16 * MAX_TOTAL_PIXELS
_BAND_ROWS = 256
# A fixed list: Pillow also opens formats that run other programs (EPS) or nest files.
_FORMATS = ("PNG", "JPEG", "WEBP", "BMP", "TGA", "GIF", "TIFF")

Encoded = bytes | memoryview


class PixelBudget:
    """Admits the images of one scene, by their headers, up to a total of pixels."""

    def __init__(self, memory: SceneBudget) -> None:
        self._memory = memory
        self._pixels = 0
        self._scanned_pixels = 0

    def admit(self, data: Encoded, name: str) -> None:
        """Count an encoded image; errors mention `name`.

        Raises:
            SceneFileError: if it is not an image, has too many pixels, or exceeds the budget.
        """
        image = None if is_ktx2(data) else _open(data, name)
        width, height = ktx2_size(data, name) if image is None else image.size
        self._pixels += width * height
        if width * height > MAX_IMAGE_PIXELS:
            raise _too_large(name, f"{width} x {height} pixels")
        if self._pixels > MAX_TOTAL_PIXELS:
            raise SceneFileError(
                f"its images together have more than {MAX_TOTAL_PIXELS >> 20} megapixels; "
                "scale the textures down"
            )
        if image is not None and image.format in ("JPEG", "MPO"):
            scans = bytes(data).count(_JPEG_SCAN)
            self._scanned_pixels += scans * width * height
            if self._scanned_pixels > _MOST_SCANNED_PIXELS:
                raise SceneFileError(
                    f"the image {name} is a JPEG of {scans} scans, too many for its size; "
                    "save it anew"
                )
        self._memory.take(width * height * _PIXEL_BYTES + _IMAGE_BYTES, f"the image {name}")


def decode_image(data: Encoded, name: str) -> Image.Image:
    """Decode admitted bytes to an RGB or RGBA image with 8 bits per channel.

    Raises:
        SceneFileError: if it is damaged.
    """
    if is_ktx2(data):
        return decode_ktx2(data, name)
    image = _open(data, name)
    try:
        return _eight_bit(image)
    except (OSError, ValueError, SyntaxError, EOFError, IndexError, TypeError) as fault:
        raise SceneFileError(f"the image {name} is damaged ({fault}); export it again") from fault


def _open(data: Encoded, name: str) -> Image.Image:
    """Open an image and read its header; Pillow itself refuses more than twice its own limit."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return Image.open(BytesIO(data), formats=_FORMATS)
    except Image.DecompressionBombError as fault:
        raise _too_large(name, "an absurd size") from fault
    except Exception as fault:
        # Pillow's readers raise various exceptions for a damaged header.
        raise SceneFileError(
            f"the image {name} is in none of the formats {', '.join(_FORMATS)}; convert it to PNG"
        ) from fault


def _too_large(name: str, claim: str) -> SceneFileError:
    return SceneFileError(
        f"the image {name} claims {claim}, above the limit of {MAX_IMAGE_PIXELS >> 20} megapixels; "
        "scale it down"
    )


def _eight_bit(image: Image.Image) -> Image.Image:
    if image.mode.startswith("I"):
        return _eight_bit_grey(image).convert("RGB")
    return image.convert("RGBA" if image.has_transparency_data else "RGB")


def _eight_bit_grey(image: Image.Image) -> Image.Image:
    """16-bit grey scaled to 8 bits, where Pillow would clip; in bands, to limit float memory."""
    width, height = image.size
    grey = np.empty((height, width), np.uint8)
    for top in range(0, height, _BAND_ROWS):
        bottom = min(top + _BAND_ROWS, height)
        values = np.asarray(image.crop((0, top, width, bottom)), dtype=np.float64) / 257.0
        grey[top:bottom] = np.clip(values, 0, 255).round()
    return Image.fromarray(grey)
