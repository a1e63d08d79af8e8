"""Means of a material's maps over each triangle, in linear light.

A triangle that covers many texels of a map is sampled in a smaller version of it, whose texels are
means; so sixteen samples suffice for any size.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import inlined, kernel
from vrut_lite.messages.scene_content import WRAPS, MaterialMap, Mesh
from vrut_lite.numeric_types import Float32Array, FloatArray

_SAMPLES = 16
_CLAMP, _MIRROR = WRAPS.index("clamp"), WRAPS.index("mirror")
_SHARES = np.arange(256, dtype=np.float32) / np.float32(255.0)
# IEC 61966-2-1.
_LINEAR = np.where(_SHARES <= 0.04045, _SHARES / 12.92, ((_SHARES + 0.055) / 1.055) ** 2.4).astype(
    np.float32
)


def triangle_means(
    found: MaterialMap, mesh: Mesh, decode: Callable[[NDArray[np.uint8]], Float32Array]
) -> Float32Array | None:
    """The mean (F, C) of a map over each triangle of a mesh; None if it has no coordinates.

    `decode` makes values (h, w, C) of texels (h, w, 3 or 4): linear light, a cut-out.
    Beyond its edges a map goes on as its sampler says.
    """
    coordinates = mesh.second_uv if found.uv_layer == 1 else mesh.uv
    if coordinates is None:
        return None
    uv = coordinates[mesh.triangles]
    texels = decode(found.texels)
    level = _level_of(uv, texels.shape)
    wraps = WRAPS.index(found.sampler.wrap_u), WRAPS.index(found.sampler.wrap_v)
    means = np.zeros((len(uv), texels.shape[2]), np.float32)
    for number in range(int(level.max(initial=-1)) + 1):
        if number > 0:
            texels = _half(texels)
        _add_means(np.ascontiguousarray(texels), uv, level, number, _POINTS, *wraps, means)
    return means


def linear(texels: NDArray[np.uint8]) -> Float32Array:
    """Linear values of sRGB-encoded ones."""
    return _LINEAR[texels]


def shares(texels: NDArray[np.uint8]) -> Float32Array:
    """Values from 0 to 1 of texels that encode them as they are."""
    return _SHARES[texels]


def _half(texels: Float32Array) -> Float32Array:
    """The map of half the edges; one texel stays one."""
    # An odd row or column is doubled, not left out.
    odd = [(0, n % 2 if n > 1 else 0) for n in texels.shape[:2]]
    if any(more for _, more in odd):
        texels = np.pad(texels, [*odd, (0, 0)], "edge")
    rows = texels if len(texels) == 1 else 0.5 * (texels[::2] + texels[1::2])
    half = rows if rows.shape[1] == 1 else 0.5 * (rows[:, ::2] + rows[:, 1::2])
    return np.asarray(half, np.float32)


def _level_of(uv: FloatArray, shape: tuple[int, ...]) -> NDArray[np.intp]:
    """The level (F,) of which a triangle covers about as many texels as there are samples."""
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    texels = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) * shape[0] * shape[1]
    level = np.floor(0.5 * np.log2(np.maximum(np.nan_to_num(texels) / _SAMPLES, 1.0)))
    last = int(np.ceil(np.log2(max(shape[:2]))))
    return np.asarray(np.minimum(level, last), np.intp)


@kernel
def _add_means(texels, uv, level, number, points, wrap_u, wrap_v, means):  # type: ignore[no-untyped-def]
    """Fill in the means of the triangles of one level."""
    height, width, channels = texels.shape
    for f in range(len(uv)):
        if level[f] != number:
            continue
        for weights in points:
            x = weights[0] * uv[f, 0, 0] + weights[1] * uv[f, 1, 0] + weights[2] * uv[f, 2, 0]
            y = weights[0] * uv[f, 0, 1] + weights[1] * uv[f, 1, 1] + weights[2] * uv[f, 2, 1]
            # Row 0 lies at v = 1.
            row, column = _texel(1.0 - y, height, wrap_v), _texel(x, width, wrap_u)
            for channel in range(channels):
                means[f, channel] += texels[row, column, channel]
        for channel in range(channels):
            means[f, channel] /= np.float32(len(points))


@inlined
def _texel(along, count, wrap):  # type: ignore[no-untyped-def]
    """The texel of `count` at a place along a map, which spans 0 to 1."""
    if not math.isfinite(along):
        along = 0.0
    if wrap == _CLAMP:
        inside = min(max(along, 0.0), 1.0)
    elif wrap == _MIRROR:
        inside = 1.0 - abs(1.0 - along % 2.0)
    else:
        inside = along % 1.0
    return min(math.floor(inside * count), count - 1)


def _even_points() -> FloatArray:
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


_POINTS = _even_points()
