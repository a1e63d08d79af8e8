"""Reads equirectangular panoramas in high dynamic range: OpenEXR, and Radiance's RGBE (.hdr)."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray

_MOST_PIXELS = 64_000_000
_SUFFIXES = (".exr", ".hdr", ".pic")


def read_panorama(path: Path) -> FloatArray:
    """Linear RGB (h, 2 h, 3), the zenith on the top row; sharpened files have values below 0.

    Raises:
        UserError: the file is missing, of another format, damaged, not twice as wide as high, or
            dark.
    """
    if not path.is_file():
        raise UserError(f"cannot open the panorama {path}: there is no such file")
    if path.suffix.lower() not in _SUFFIXES:
        raise UserError(f"{path} is no panorama: an EXR or HDR file is needed")
    try:
        pixels = _read_exr(path) if path.suffix.lower() == ".exr" else _read_hdr(path)
    # OpenEXR raises errors of several kinds.
    except (RuntimeError, OSError, KeyError, ValueError, IndexError, TypeError):
        raise UserError(
            f"cannot read the panorama {path}: it is damaged or not linear RGB"
        ) from None
    if not np.isfinite(pixels).all():
        raise UserError(f"cannot use the panorama {path}: it holds values that are not finite")
    if not pixels[: len(pixels) // 2].max() > 0.0:
        raise UserError(f"cannot use the panorama {path}: its upper half is black")
    return pixels


def _check_size(path: Path, width: int, height: int) -> None:
    if width != 2 * height or height < 8:
        raise UserError(
            f"{path} has {width} x {height} pixels: a panorama of the whole sphere is twice as "
            "wide as high"
        )
    if width * height > _MOST_PIXELS:
        raise UserError(f"the panorama {path} is too large: it has more than 64 megapixels")


def _read_exr(path: Path) -> FloatArray:
    # Imported when used: whoever lists modules needs none of it.
    import OpenEXR

    # The header tells what memory the pixels will take; the library would take it at once.
    with OpenEXR.File(str(path), header_only=True) as head:
        low, high = head.header()["dataWindow"]
    width, height = (int(side) for side in np.subtract(high, low, dtype=np.int64) + 1)
    _check_size(path, width, height)
    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        name = "RGB" if "RGB" in channels else "RGBA"
        return np.asarray(channels[name].pixels, dtype=float)[..., :3]


def _read_hdr(path: Path) -> FloatArray:
    """Radiance's format: a text head, a size, and rows of bytes, plain or in runs."""
    data = path.read_bytes()
    head, _, rest = data.partition(b"\n\n")
    if not head.startswith(b"#?"):
        raise ValueError("no head")
    size, _, body = rest.partition(b"\n")
    words = size.split()
    if len(words) != 4 or words[0] != b"-Y" or words[2] != b"+X":
        raise ValueError("another order of rows")
    height, width = int(words[1]), int(words[3])
    _check_size(path, width, height)
    encoded = np.frombuffer(body, np.uint8)
    packed = 8 <= width < 32768 and encoded[:2].tolist() == [2, 2]
    rgbe = _unpacked(encoded, height, width) if packed else encoded[: height * width * 4]
    values = rgbe.reshape(height, width, 4)
    scale = np.where(values[..., 3] > 0, np.ldexp(1.0, values[..., 3].astype(int) - 136), 0.0)
    return np.asarray((values[..., :3] + 0.5) * scale[..., None], dtype=float)


def _unpacked(encoded: NDArray[np.uint8], height: int, width: int) -> NDArray[np.uint8]:
    """Bytes (height, width, 4) of rows whose four parts are packed in runs one after another."""
    data, at = encoded.tobytes(), 0
    rows = np.empty((height, 4, width), np.uint8)
    for row in rows:
        if data[at] != 2 or data[at + 1] != 2 or data[at + 2] * 256 + data[at + 3] != width:
            raise ValueError("another row")
        at += 4
        for part in row:
            filled = 0
            while filled < width:
                count = data[at]
                run = count > 128
                count -= 128 if run else 0
                if not 0 < count <= width - filled:
                    raise ValueError("a run too long")
                taken = data[at + 1 : at + 2] * count if run else data[at + 1 : at + 1 + count]
                part[filled : filled + count] = np.frombuffer(taken, np.uint8)
                filled += count
                at += 2 if run else 1 + count
    return rows.transpose(0, 2, 1)
