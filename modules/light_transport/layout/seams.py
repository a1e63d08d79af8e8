"""Texels of two charts that meet at a smooth edge.

A chart ends where its neighbour begins, also where the surface goes on smoothly. Smoothing
exchanges light between these pairs as between neighbouring texels, so that no seam is visible.
"""

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import agree, inlined, kernel
from light_transport.layout.texel_owners import UNUSED
from light_transport.layout.welding import NO_EDGE, opposite_edges, welded
from vrut_lite.numeric_types import Float32Array, FloatArray


def seam_texels(
    corners_m: FloatArray,
    normals: Float32Array,
    uv_px: Float32Array,
    chart: NDArray[np.int32],
    owner: NDArray[np.int32],
) -> NDArray[np.int32]:
    """Pairs of texels that lie at the same smooth edge, in two charts.

    Beside each place of the edge, half a texel apart, both charts have a texel within the border
    and one beyond it. The texels within are a pair, and so is each texel beyond with the other
    chart's within, which lies at about the same place: a texel that no triangle covers may take
    that one's light.

    Args:
        corners_m, normals: (F, 3, 3), of triangles in one frame.
        uv_px: (F, 3, 2), NaN where a triangle has no texels.
        chart: (F,), numbers of charts, negative without texels.
        owner: (height, width), see `texel_owners`.

    Returns:
        (S, 2) int32, texels as row * width + column, the smaller first, sorted, each pair once.
    """
    mapped = np.flatnonzero(chart >= 0)
    if not len(mapped):
        return np.empty((0, 2), np.int32)
    places = welded(corners_m[mapped].reshape(-1, 3)).reshape(-1, 3)
    pairs = _pairs(
        opposite_edges(places),
        normals[mapped],
        uv_px[mapped].astype(np.float64),
        chart[mapped],
        np.append(chart, UNUSED)[owner],
    )
    pairs.sort(axis=1)
    key = np.unique(pairs[:, 0] * owner.size + pairs[:, 1])
    return np.stack([key // owner.size, key % owner.size], axis=1).astype(np.int32)


@kernel
def _pairs(opposite, normals, uv, chart, texel_chart):  # type: ignore[no-untyped-def]
    """Pairs (n, 2) of texels at smooth edges, each as often as it is met."""
    found = np.empty((1024, 2), np.int64)
    count = 0
    own, across = np.empty((2, 2)), np.empty((2, 2))
    for f in range(len(chart)):
        for e in range(3):
            g, d = divmod(opposite[f, e], 3)
            # Each edge once, from the triangle that comes first.
            if opposite[f, e] == NO_EDGE or g < f or chart[f] == chart[g]:
                continue
            after, beyond = (e + 1) % 3, (d + 1) % 3
            if not agree(normals, f, e, g, d):
                continue
            long = max(_length(uv[f, e], uv[f, after]), _length(uv[g, d], uv[g, beyond]))
            steps = int(np.ceil(2.0 * long)) + 1
            for step in range(steps):
                share = (step + 0.5) / steps
                _beside(uv[f, e], uv[f, after], uv[f, (e + 2) % 3], share, own)
                _beside(uv[g, beyond], uv[g, d], uv[g, (d + 2) % 3], share, across)
                for k in range(3):
                    one = _texel(own[1 if k == 1 else 0], chart[f], texel_chart)
                    two = _texel(across[1 if k == 2 else 0], chart[g], texel_chart)
                    if one < 0 or two < 0:
                        continue
                    if count == len(found):
                        found = np.concatenate((found, found))
                    found[count, 0], found[count, 1] = one, two
                    count += 1
    return found[:count].copy()


@inlined
def _length(a, b):  # type: ignore[no-untyped-def]
    return np.hypot(b[0] - a[0], b[1] - a[1])


@inlined
def _beside(a, b, inner, share, places):  # type: ignore[no-untyped-def]
    """Places (2, 2) half a texel within an edge and beyond it, at a share of its length."""
    du, dv = b[0] - a[0], b[1] - a[1]
    length = max(np.hypot(du, dv), 1e-9)
    side = 0.5 if du * (inner[1] - a[1]) - dv * (inner[0] - a[0]) >= 0.0 else -0.5
    across, down = -side * dv / length, side * du / length
    places[0, 0] = a[0] + share * du + across
    places[0, 1] = a[1] + share * dv + down
    places[1, 0] = a[0] + share * du - across
    places[1, 1] = a[1] + share * dv - down


@inlined
def _texel(place, chart, texel_chart):  # type: ignore[no-untyped-def]
    """The texel of a chart at a place, as row * width + column; -1 if it is another's."""
    x, y = int(np.floor(place[0])), int(np.floor(place[1]))
    height, width = texel_chart.shape
    if x < 0 or y < 0 or x >= width or y >= height or texel_chart[y, x] != chart:
        return -1
    return y * width + x
