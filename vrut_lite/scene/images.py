"""Textures: the header is judged before a pixel is decoded."""

import warnings
from io import BytesIO

import numpy as np
from PIL import Image

from vrut_lite.scene.file_checks import SceneFileError

MAX_IMAGE_PIXELS = 64 * 2**20
MAX_TOTAL_PIXELS = 256 * 2**20
# A fixed list: Pillow also opens formats that run other programs (EPS) or nest files.
_FORMATS = ("PNG", "JPEG", "WEBP", "BMP", "TGA", "GIF", "TIFF")


class PixelBudget:
    """Admits the images of one scene, by their headers, up to a total of pixels."""

    def __init__(self) -> None:
        self._pixels = 0

    def admit(self, data: bytes, name: str) -> None:
        """Count an encoded image; `name` is told in errors.

        Raises:
            SceneFileError: if it is no image or claims too many pixels.
        """
        width, height = _open(data, name).size
        self._pixels += width * height
        if width * height > MAX_IMAGE_PIXELS:
            raise _too_large(name, f"{width} x {height} pixels")
        if self._pixels > MAX_TOTAL_PIXELS:
            raise SceneFileError(
                f"its images together have more than {MAX_TOTAL_PIXELS >> 20} megapixels; "
                "scale the textures down"
            )


def decode_image(data: bytes, name: str) -> Image.Image:
    """An RGB or RGBA image with 8 bits per channel, of bytes that were admitted.

    Raises:
        SceneFileError: if it is damaged.
    """
    image = _open(data, name)
    try:
        return _eight_bit(image)
    except (OSError, ValueError, SyntaxError, EOFError, IndexError, TypeError) as fault:
        raise SceneFileError(f"the image {name} is damaged ({fault}); export it again") from fault


def _open(data: bytes, name: str) -> Image.Image:
    """The image with its header read; Pillow itself balks at more than twice its own limit."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return Image.open(BytesIO(data), formats=_FORMATS)
    except Image.DecompressionBombError as fault:
        raise _too_large(name, "an absurd size") from fault
    except Exception as fault:
        # Pillow's readers meet a damaged header with whatever their parsing raises.
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
        # Pillow clips 16-bit greys at 255 where it should scale them.
        values = np.asarray(image, dtype=np.float64) / 257.0
        return Image.fromarray(np.clip(values, 0, 255).round().astype(np.uint8)).convert("RGB")
    return image.convert("RGBA" if image.has_transparency_data else "RGB")
