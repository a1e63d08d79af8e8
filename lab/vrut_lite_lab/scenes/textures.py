"""Textures made by rule, and a PNG encoder whose bytes are the same everywhere.

zlib's output differs between its versions; uncompressed blocks do not.
"""

import struct
import zlib

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.geometry.colour import srgb_encode
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.scenes.noise import gradient_pull

SIZE_PX = 256
_LEVELS = 64


def brick() -> bytes:
    """Running bond, 2 m x 2 m: bricks of 25 cm x 8.3 cm in three reds, pale mortar."""
    rng = np.random.default_rng(7)
    y, x = np.mgrid[0:SIZE_PX, 0:SIZE_PX] / SIZE_PX
    course = np.floor(y * 24).astype(int)
    along = x * 8 + 0.5 * (course % 2)
    number = np.floor(along).astype(int) % 8
    mortar = (np.mod(along, 1) < 0.05) | (np.mod(y * 24, 1) < 0.14)
    hue = 1 + np.floor(rng.random((24, 8)) * 3).astype(int)[course, number]
    tone = 0.5 + 0.35 * (rng.random((24, 8))[course, number] - 0.5) + 0.3 * _noise(rng, 64)
    albedo = [(0.46, 0.43, 0.38), (0.36, 0.13, 0.085), (0.30, 0.11, 0.08), (0.40, 0.18, 0.12)]
    return _png(np.where(mortar, 0, hue), tone, albedo)


def paving() -> bytes:
    """Granite setts in rows, 2 m x 2 m, two greys with dark joints."""
    rng = np.random.default_rng(11)
    y, x = np.mgrid[0:SIZE_PX, 0:SIZE_PX] / SIZE_PX
    row = np.floor(y * 12).astype(int)
    along = x * 10 + 0.5 * (row % 2)
    number = np.floor(along).astype(int) % 10
    edge = np.minimum(_to_edge(np.mod(along, 1)), _to_edge(np.mod(y * 12, 1)))
    hue = 1 + (rng.random((12, 10)) < 0.35)[row, number].astype(int)
    tone = 0.5 + 0.3 * (rng.random((12, 10))[row, number] - 0.5) + 0.4 * _noise(rng, 96)
    tone -= 0.25 * (edge < 0.14)
    albedo = [(0.10, 0.095, 0.085), (0.32, 0.31, 0.30), (0.24, 0.235, 0.24)]
    return _png(np.where(edge < 0.07, 0, hue), tone, albedo)


def checker() -> bytes:
    """Two by two marble slabs of 60 cm, cream and grey-green, with thin joints."""
    rng = np.random.default_rng(5)
    y, x = np.mgrid[0:SIZE_PX, 0:SIZE_PX] / SIZE_PX
    slab = (np.floor(x * 2) + np.floor(y * 2)).astype(int) % 2
    joint = np.minimum(_to_edge(np.mod(x * 2, 1)), _to_edge(np.mod(y * 2, 1))) < 0.012
    vein = np.abs(_noise(rng, 4) + 0.6 * _noise(rng, 8) + 0.3 * _noise(rng, 16)) < 0.035
    tone = 0.55 + 0.22 * _noise(rng, 6) + 0.12 * _noise(rng, 48) - 0.2 * vein
    albedo = [(0.62, 0.58, 0.50), (0.20, 0.24, 0.21), (0.30, 0.28, 0.25)]
    return _png(np.where(joint, 2, slab), tone, albedo)


def ground_grain() -> bytes:
    """A texture for the unevenness of open land, 512 x 512: greys about a mean of two thirds."""
    size = 2 * SIZE_PX
    at = np.arange(size) / size
    x, y = np.meshgrid(at, at)
    tone = np.full((size, size), 0.5)
    for octave, height in enumerate((0.10, 0.14, 0.18, 0.2, 0.2, 0.16)):
        tone += height * _wrapped_noise(x, y, 8 * 2**octave, 101 + octave)
    return _png(np.zeros((size, size), dtype=np.int64), tone, [(2 / 3, 2 / 3, 2 / 3)])


def ground_bumps() -> bytes:
    """Normals of the same land, 256 x 256: two metres of relief in a tile of 256 m."""
    at = np.arange(SIZE_PX) / SIZE_PX
    x, y = np.meshgrid(at, at)
    height_m = np.zeros((SIZE_PX, SIZE_PX))
    for octave, height in enumerate((1.6, 1.1, 0.7, 0.42, 0.22)):
        height_m += height * (0.5 - np.abs(_wrapped_noise(x, y, 8 * 2**octave, 101 + octave)))
    east = np.roll(height_m, -1, axis=1) - np.roll(height_m, 1, axis=1)
    south = np.roll(height_m, -1, axis=0) - np.roll(height_m, 1, axis=0)
    # A texel is a metre; the texture's second axis runs up the picture, to the north.
    normal = np.stack([-0.5 * east, 0.5 * south, np.ones_like(east)], axis=-1)
    normal /= np.sqrt(np.sum(normal * normal, axis=-1, keepdims=True))
    return _png_of(np.round(255.0 * (0.5 + 0.5 * normal)).astype(np.uint8), 2, [])


def _wrapped_noise(x: FloatArray, y: FloatArray, cells: int, seed: int) -> FloatArray:
    """Gradient noise of so many cells a side that goes on across the borders."""
    across, along = x * cells, y * cells
    left, top = np.floor(across), np.floor(along)
    u, v = across - left, along - top
    pull = [
        gradient_pull((left + i) % cells, (top + j) % cells, u - i, v - j, seed)
        for j in (0, 1) for i in (0, 1)
    ]  # fmt: skip
    s, t = (w * w * w * (w * (w * 6.0 - 15.0) + 10.0) for w in (u, v))
    upper = pull[0] + s * (pull[1] - pull[0])
    return np.asarray(1.5 * (upper + t * (pull[2] + s * (pull[3] - pull[2]) - upper)))


def _to_edge(fraction: FloatArray) -> FloatArray:
    return np.minimum(fraction, 1.0 - fraction)


def _noise(rng: np.random.Generator, cells: int) -> FloatArray:
    """Smooth noise (SIZE_PX, SIZE_PX) in [-0.5, 0.5] that repeats at the borders."""
    lattice = rng.random((cells, cells)) - 0.5
    at = np.arange(SIZE_PX) * cells / SIZE_PX
    low = np.floor(at).astype(int)
    weight = at - low
    weight = weight * weight * (3.0 - 2.0 * weight)
    high = (low + 1) % cells
    rows = lattice[low] * (1 - weight[:, None]) + lattice[high] * weight[:, None]
    return rows[:, low] * (1 - weight) + rows[:, high] * weight


def _png(kind: NDArray[np.int64], tone: FloatArray, albedo: ArrayLike) -> bytes:
    """A palette PNG: for each kind (at most four) a linear albedo in 64 tones, 0.5 to 1.5 times."""
    level = np.clip(np.floor(tone * _LEVELS), 0, _LEVELS - 1).astype(int)
    shades = np.asarray(albedo)[:, None, :] * np.linspace(0.5, 1.5, _LEVELS)[:, None]
    palette = np.round(255 * srgb_encode(shades.reshape(-1, 3))).astype(np.uint8)
    rows = (kind * _LEVELS + level).astype(np.uint8)
    return _png_of(rows, 3, [(b"sRGB", b"\0"), (b"PLTE", palette.tobytes())])


def _png_of(rows: NDArray[np.uint8], colour_type: int, told: list[tuple[bytes, bytes]]) -> bytes:
    """A PNG of 8-bit rows (h, w) or (h, w, 3), with what is told before them."""
    raw = b"".join(b"\0" + row.tobytes() for row in rows)
    header = struct.pack(">IIBBBBB", rows.shape[1], rows.shape[0], 8, colour_type, 0, 0, 0)
    chunks = [(b"IHDR", header), *told, (b"IDAT", _stored(raw)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _stored(data: bytes) -> bytes:
    """A zlib stream (RFC 1950) of stored blocks (RFC 1951, section 3.2.4)."""
    out, most = b"\x78\x01", 65535
    for start in range(0, len(data), most):
        piece = data[start : start + most]
        last = start + most >= len(data)
        out += struct.pack("<BHH", last, len(piece), 65535 - len(piece)) + piece
    return out + struct.pack(">I", zlib.adler32(data))
