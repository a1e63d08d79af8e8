"""Cut-out maps whose mip levels preserve coverage.

Alpha that is averaged before the alpha test loses thin lines in the distance: a wire that covers a
tenth of a texel is below any cut-off. Here the alpha of a smaller level is the mean coverage, and
its colour the mean of covered texels; mesh.frag covers that share of a pixel's samples. In the full
map the cut-off lies at one half.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import Float32Array


def cut_out_levels(texels: NDArray[np.uint8], cut_off: float) -> list[NDArray[np.uint8]]:
    """Mip levels, down to one texel, of a map (h, w, 4) in sRGB and alpha."""
    alpha = texels[..., 3].astype(np.float32) / 255.0
    left = (alpha >= cut_off).astype(np.float32)
    # The offset lets a level's texel without coverage take the plain mean colour.
    weight = left + np.float32(1e-4)
    colour = _DECODED[texels[..., :3]]
    levels = [_encoded(colour, _around_one_half(alpha, cut_off))]
    while max(left.shape) > 1:
        halved = _halved(weight[..., None])
        colour = _halved(colour * weight[..., None]) / halved
        weight, left = halved[..., 0], _halved(left[..., None])[..., 0]
        levels.append(_encoded(colour, left))
    return levels


def _around_one_half(alpha: Float32Array, cut_off: float) -> Float32Array:
    """Alpha stretched so that the cut-off is one half."""
    below = 0.5 * alpha / max(cut_off, 1e-6)
    above = 0.5 + 0.5 * (alpha - cut_off) / max(1.0 - cut_off, 1e-6)
    return np.asarray(np.where(alpha < cut_off, below, above), np.float32)


def _halved(values: Float32Array) -> Float32Array:
    """Means (h / 2, w / 2, c), rounded down as OpenGL does, of values (h, w, c)."""
    rows, columns = (max(n // 2, 1) for n in values.shape[:2])
    if values.shape[0] > 1:
        values = 0.5 * (values[: 2 * rows : 2] + values[1 : 2 * rows : 2])
    if values.shape[1] > 1:
        values = 0.5 * (values[:, : 2 * columns : 2] + values[:, 1 : 2 * columns : 2])
    return values


def _encoded(colour: Float32Array, alpha: Float32Array) -> NDArray[np.uint8]:
    low, high = 12.92 * colour, 1.055 * np.maximum(colour, 1e-9) ** (1 / 2.4) - 0.055
    srgb = np.where(colour <= 0.0031308, low, high)
    both = np.concatenate([srgb, alpha[..., None]], axis=-1)
    return np.asarray(np.clip(both * 255.0 + 0.5, 0.0, 255.0), np.uint8)


def _decoding_table() -> Float32Array:
    encoded = np.arange(256) / 255.0
    low, high = encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, low, high).astype(np.float32)


_DECODED = _decoding_table()
