"""Gradient noise made of whole numbers and plain arithmetic: the same bits on every machine."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.numeric_types import FloatArray

# Eight gradients of equal length; sines and cosines differ in their last bit between machines.
_DIAGONAL = np.sqrt(0.5)
_GRADIENTS = np.array(
    [(1, 0), (-1, 0), (0, 1), (0, -1)]
    + [(i * _DIAGONAL, j * _DIAGONAL) for i in (1, -1) for j in (1, -1)]
)


def lattice_hash(column: ArrayLike, row: ArrayLike, seed: int) -> NDArray[np.uint32]:
    """Well mixed 32-bit numbers (...,) of whole coordinates (Wang's and Murmur's finishers)."""
    x, y = (np.asarray(part).astype(np.int64).astype(np.uint32) for part in (column, row))
    with np.errstate(over="ignore"):
        return _mixed_bits(x, y, seed)


def _mixed_bits(x: NDArray[np.uint32], y: NDArray[np.uint32], seed: int) -> NDArray[np.uint32]:
    mixed = (
        x * np.uint32(0x8DA6B343)
        ^ y * np.uint32(0xD8163841)
        ^ np.uint32(seed * 0x1B873593 & 0xFFFFFFFF)
    )
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35)):
        mixed = (mixed ^ (mixed >> np.uint32(shift))) * np.uint32(factor)
    return np.asarray(mixed ^ (mixed >> np.uint32(16)))


def uniform_hash(column: ArrayLike, row: ArrayLike, seed: int) -> FloatArray:
    """Numbers (...,) in [0, 1) of whole coordinates."""
    return lattice_hash(column, row, seed) / 2.0**32


def gradient_noise(x: ArrayLike, y: ArrayLike, seed: int) -> FloatArray:
    """Perlin's improved noise (2002) in the plane: about [-1, 1], zero at whole coordinates."""
    across, along = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    left, top = np.floor(across), np.floor(along)
    u, v = across - left, along - top
    corners = [gradient_pull(left + i, top + j, u - i, v - j, seed) for j in (0, 1) for i in (0, 1)]
    s, t = (w * w * w * (w * (w * 6.0 - 15.0) + 10.0) for w in (u, v))
    upper = corners[0] + s * (corners[1] - corners[0])
    lower = corners[2] + s * (corners[3] - corners[2])
    return np.asarray(1.5 * (upper + t * (lower - upper)))


def fractal_noise(
    x: ArrayLike, y: ArrayLike, seed: int, octaves: int, gain: float = 0.5
) -> FloatArray:
    """Octaves of noise (...,), each of twice the frequency and `gain` of the height."""
    across, along = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    total, height = np.zeros(np.broadcast(across, along).shape), 1.0
    for octave in range(octaves):
        total += height * gradient_noise(across * 2.0**octave, along * 2.0**octave, seed + octave)
        height *= gain
    return total


def ridged_noise(
    x: ArrayLike, y: ArrayLike, seed: int, octaves: int, gain: float = 0.5
) -> FloatArray:
    """Ridges where noise changes its sign, each octave strong where the last one rose.

    Musgrave's ridged multifractal (Texturing and Modeling, 2003, chapter 16): 0 to about 2.
    """
    across, along = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    total, height = np.zeros(np.broadcast(across, along).shape), 1.0
    weight = np.ones_like(total)
    for octave in range(octaves):
        noise = gradient_noise(across * 2.0**octave, along * 2.0**octave, seed + octave)
        ridge = (1.0 - np.minimum(np.abs(noise), 1.0)) ** 2 * weight
        total += height * ridge
        weight, height = np.minimum(2.0 * ridge, 1.0), height * gain
    return total


def gradient_pull(
    column: FloatArray, row: FloatArray, u: FloatArray, v: FloatArray, seed: int
) -> FloatArray:
    """What the lattice point (column, row) adds at (u, v) from it."""
    gradient = _GRADIENTS[lattice_hash(column, row, seed) >> np.uint32(29)]
    return np.asarray(gradient[..., 0] * u + gradient[..., 1] * v)
