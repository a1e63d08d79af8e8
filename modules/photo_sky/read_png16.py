"""Reads PNG pictures of 16-bit colour, which Pillow cuts down to 8 bits (ISO/IEC 15948)."""

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_CHANNELS = {2: 3, 6: 4}
_BYTES_PER_SAMPLE = 2


def is_png16(data: bytes) -> bool:
    """Whether the bytes are a PNG of 16-bit RGB or RGBA, not interlaced."""
    if len(data) < 33 or data[:8] != _SIGNATURE or data[12:16] != b"IHDR":
        return False
    depth, kind, _, _, interlace = struct.unpack_from(">BBBBB", data, 24)
    return depth == 16 and kind in _CHANNELS and interlace == 0


def png16_size(data: bytes) -> tuple[int, int]:
    """Width and height of a picture that `is_png16`."""
    width, height = struct.unpack_from(">II", data, 16)
    return width, height


def read_png16(data: bytes) -> NDArray[np.uint16]:
    """The pixels (h, w, 3) of a picture that `is_png16`; alpha is dropped.

    Raises:
        ValueError: the picture is damaged.
    """
    width, height = png16_size(data)
    step = _CHANNELS[data[25]] * _BYTES_PER_SAMPLE
    size = height * (1 + width * step)
    try:
        packed = zlib.decompressobj()
        flat = packed.decompress(b"".join(_chunks(data)), size)
    except zlib.error as fault:
        raise ValueError(f"its pixels are damaged ({fault})") from None
    if len(flat) != size:
        raise ValueError("its pixels are cut short")
    rows = np.frombuffer(flat, np.uint8).reshape(height, 1 + width * step)
    pixels = _unfiltered(rows[:, 0], rows[:, 1:].reshape(height, width, step))
    samples = np.ascontiguousarray(pixels).view(">u2").astype(np.uint16)
    return samples[..., :3]


def _chunks(data: bytes) -> list[bytes]:
    """The contents of all chunks of pixels."""
    found, at = [], len(_SIGNATURE)
    while at + 8 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IDAT":
            found.append(data[at + 8 : at + 8 + length])
        at += 12 + length
    return found


def _unfiltered(filters: NDArray[np.uint8], stored: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Undo the filters (h,) of rows: None, Sub, Up, Average, Paeth (section 9.2).

    A pixel needs those left, above and left above it: pixels of one diagonal, x + y, are computed
    together.
    """
    if filters.max(initial=0) > 4:
        raise ValueError("it has a filter that PNG does not know")
    height, width, step = stored.shape
    # A row above and a column on the left hold zeros.
    known = np.zeros((height + 1, width + 1, step), np.int32)
    for diagonal in range(height + width - 1):
        y = np.arange(max(0, diagonal - width + 1), min(height, diagonal + 1))
        x = diagonal - y
        left, above, corner = known[y + 1, x], known[y, x + 1], known[y, x]
        guess = left + above - corner
        to_left, to_above, to_corner = (np.abs(guess - part) for part in (left, above, corner))
        paeth = np.where(
            (to_left <= to_above) & (to_left <= to_corner),
            left,
            np.where(to_above <= to_corner, above, corner),
        )
        predicted = np.choose(
            filters[y][:, None], (np.zeros_like(left), left, above, (left + above) // 2, paeth)
        )
        known[y + 1, x + 1] = (stored[y, x] + predicted) & 0xFF
    return known[1:, 1:].astype(np.uint8)
