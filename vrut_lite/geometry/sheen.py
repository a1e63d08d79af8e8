"""Reflectance of fibres under an even sky: KHR_materials_sheen.

Charlie's distribution (Estevez and Kulla 2017, "Production friendly microfacet sheen BRDF") with
Neubelt's visibility (Neubelt and Pettineo 2013): shares of light that shaders look up.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry import reflection
from vrut_lite.geometry.cached_table import kept_table
from vrut_lite.geometry.reflection import TABLE_SIZE

_ANGLES, _TURNS = 96, 48
_LEAST_ALPHA = 1e-3


@lru_cache(maxsize=1)
def sheen_table() -> NDArray[np.float32]:
    """Reflectance (TABLE_SIZE, TABLE_SIZE) of white fibres: rows are roughness.

    Both axes run as those of `reflection.reflectance_table`.
    """
    return kept_table("sheen", _sheen_table, __file__, reflection.__file__)


def _sheen_table() -> NDArray[np.float32]:
    steps = np.linspace(0.0, 1.0, TABLE_SIZE)
    nv = np.maximum(steps**2, 1e-3)[:, None, None]
    nl = ((np.arange(_ANGLES) + 0.5) / _ANGLES)[None, :, None]
    turn = (np.pi * (np.arange(_TURNS) + 0.5) / _TURNS)[None, None, :]
    view = np.stack(np.broadcast_arrays(np.sqrt(1.0 - nv * nv), 0.0 * turn, nv), axis=-1)
    sine = np.sqrt(1.0 - nl * nl)
    light = np.stack(np.broadcast_arrays(sine * np.cos(turn), sine * np.sin(turn), nl), axis=-1)
    half = view + light
    nh = half[..., 2] / np.linalg.norm(half, axis=-1)
    log_sine = 0.5 * np.log(np.maximum(1.0 - nh * nh, 1e-30)).astype(np.float32)
    weight = (nl / (4.0 * (nl + nv - nl * nv))).astype(np.float32)
    table = np.empty((TABLE_SIZE, TABLE_SIZE), np.float32)
    for row, roughness in enumerate(steps):
        inverse = 1.0 / max(roughness**2, _LEAST_ALPHA)
        spread = (2.0 + inverse) * np.exp(np.float32(inverse) * log_sine)
        # Over the half turn and its mirror image, and over the cosine; the two pi cancel.
        table[row] = (spread * weight).mean(axis=(1, 2))
    np.clip(table, 0.0, 1.0, out=table)
    return table
