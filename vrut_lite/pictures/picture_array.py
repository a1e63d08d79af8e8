"""Types of the picture writers: an array of pixels, and its metadata."""

from collections.abc import Mapping

from numpy.typing import NDArray

Metadata = Mapping[str, str | float]


def require_picture(pixels: NDArray, types: tuple[str, ...]) -> None:
    """Raise ValueError unless the pixels are (h, w, 3), not empty and of one of the types."""
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.size == 0:
        raise ValueError(f"a picture has the shape (height, width, 3), not {pixels.shape}")
    if pixels.dtype.name not in types:
        raise ValueError(f"this picture must be of type {' or '.join(types)}, not {pixels.dtype}")
