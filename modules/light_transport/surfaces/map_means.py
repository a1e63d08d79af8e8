"""Means of a material's maps over each triangle, in linear light.

A triangle that covers many texels of a map is sampled in a smaller version of it, whose texels are
means; so sixteen samples suffice for any size.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.scene_content import MaterialMap, Mesh, Sampler, Wrap
from vrut_lite.numeric_types import Float32Array

_SAMPLES = 16


def triangle_means(
    found: MaterialMap, mesh: Mesh, decode: Callable[[Float32Array], Float32Array]
) -> Float32Array | None:
    """The mean (F, C) of a map over each triangle of a mesh; None if it has no coordinates.

    `decode` makes values (h, w, C) of texels (h, w, 3 or 4) in [0, 1]: linear light, a cut-out.
    Beyond its edges a map goes on as its sampler says.
    """
    coordinates = mesh.second_uv if found.uv_layer == 1 else mesh.uv
    if coordinates is None:
        return None
    levels = _smaller_and_smaller(decode(found.texels.astype(np.float32) / np.float32(255.0)))
    uv = coordinates[mesh.triangles]
    level = _level_of(uv, levels[0].shape)
    means = np.empty((len(uv), levels[0].shape[2]), np.float32)
    for number in np.unique(level):
        at = level == number
        means[at] = _means(levels[number], uv[at], found.sampler)
    return means


def linear(encoded: Float32Array) -> Float32Array:
    """Linear values of sRGB-encoded ones (IEC 61966-2-1)."""
    low, high = encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, low, high).astype(np.float32)


def _smaller_and_smaller(texels: Float32Array) -> list[Float32Array]:
    """The map, and maps of half the edges each, down to one texel."""
    levels = [texels]
    while max(levels[-1].shape[:2]) > 1:
        last = levels[-1]
        # An odd row or column is doubled, not left out.
        last = np.pad(last, [(0, n % 2 if n > 1 else 0) for n in last.shape[:2]] + [(0, 0)], "edge")
        rows = last[::2] if len(last) == 1 else 0.5 * (last[::2] + last[1::2])
        half = rows if rows.shape[1] == 1 else 0.5 * (rows[:, ::2] + rows[:, 1::2])
        levels.append(np.asarray(half, np.float32))
    return levels


def _level_of(uv: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.intp]:
    """The level (F,) of which a triangle covers about as many texels as there are samples."""
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    texels = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) * shape[0] * shape[1]
    level = np.floor(0.5 * np.log2(np.maximum(np.nan_to_num(texels) / _SAMPLES, 1.0)))
    last = int(np.ceil(np.log2(max(shape[:2]))))
    return np.asarray(np.minimum(level, last), np.intp)


def _means(texels: Float32Array, uv: NDArray[np.float64], sampler: Sampler) -> Float32Array:
    height, width = texels.shape[:2]
    total = np.zeros((len(uv), texels.shape[2]), np.float32)
    for weights in _even_points():
        at = np.nan_to_num(np.einsum("k,fkc->fc", weights, uv))
        # Row 0 lies at v = 1.
        column = _texel(at[:, 0], width, sampler.wrap_u)
        row = _texel(1.0 - at[:, 1], height, sampler.wrap_v)
        total += texels[row, column]
    return total / np.float32(_SAMPLES)


def _texel(along: NDArray[np.float64], count: int, wrap: Wrap) -> NDArray[np.intp]:
    """The texel (F,) of `count` at places along a map, which spans 0 to 1."""
    if wrap == "clamp":
        inside = np.clip(along, 0.0, 1.0)
    elif wrap == "mirror":
        inside = 1.0 - np.abs(1.0 - along % 2.0)
    else:
        inside = along % 1.0
    return np.asarray(np.minimum(np.floor(inside * count), count - 1), np.intp)


def _even_points() -> NDArray[np.float64]:
    """Barycentric coordinates (samples, 3) spread over a triangle: the middles of 4 x 4 parts."""
    n = int(np.sqrt(_SAMPLES))
    points = []
    for i in range(n):
        for j in range(n - i):
            points.append(((i + 1 / 3) / n, (j + 1 / 3) / n))
            if j < n - i - 1:
                points.append(((i + 2 / 3) / n, (j + 2 / 3) / n))
    first = np.array(points)
    return np.column_stack([1.0 - first.sum(axis=1), first])
