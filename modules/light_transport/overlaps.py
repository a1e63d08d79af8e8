"""Charts whose projection would cover a texel twice, taken apart into layers."""

import numpy as np

from light_transport.kernels import kernel


@kernel
def layers(chart, uv, sizes, opposite):  # type: ignore[no-untyped-def]
    """A number (F,) for each triangle, such that those of one number and chart share no texel.

    A texel is a triangle's if its middle lies inside, not on the border. `chart` (F,), `uv`
    (F, 3, 2) in texels from the corner of the chart's rectangle, `sizes` (C, 2) of these.

    Triangles are taken in the order of a walk from neighbour to neighbour, each into the layer of
    the one before if its texels are free there, else into a new one: a turn of a winding stair
    becomes a chart. Claims of a texel are a linked list of layers.
    """
    count = len(chart)
    first = np.zeros(len(sizes) + 1, np.int64)
    for c in range(len(sizes)):
        first[c + 1] = first[c] + sizes[c, 0] * sizes[c, 1]
    head = np.full(first[-1], -1, np.int32)
    follows = np.empty(1024, np.int32)
    claimed = np.empty(1024, np.int32)
    claims = 0
    layer = np.full(count, -1, np.int32)
    newest = np.zeros(len(sizes), np.int32)
    queue = np.empty(count, np.int32)
    for seed in range(count):
        if layer[seed] >= 0:
            continue
        c = chart[seed]
        layer[seed], queue[0], begin, end = newest[c], seed, 0, 1
        while begin < end:
            f = queue[begin]
            begin += 1
            texels = _texels_within(uv[f])
            for t in texels:
                claim = head[first[c] + t[1] * sizes[c, 0] + t[0]]
                while claim >= 0 and claimed[claim] != layer[f]:
                    claim = follows[claim]
                if claim >= 0:
                    newest[c] += 1
                    layer[f] = newest[c]
                    break
            for t in texels:
                if claims == len(claimed):
                    follows = np.concatenate((follows, follows))
                    claimed = np.concatenate((claimed, claimed))
                at = first[c] + t[1] * sizes[c, 0] + t[0]
                follows[claims], claimed[claims], head[at] = head[at], layer[f], claims
                claims += 1
            for e in range(3):
                g = opposite[f, e] // 3
                if opposite[f, e] >= 0 and chart[g] == c and layer[g] < 0:
                    layer[g] = layer[f]
                    queue[end] = g
                    end += 1
    return layer


@kernel
def _texels_within(corners):  # type: ignore[no-untyped-def]
    """Texels (n, 2), column and row, whose middles lie inside a triangle, not on its border."""
    left = int(np.floor(corners[:, 0].min()))
    right = int(np.ceil(corners[:, 0].max()))
    top = int(np.floor(corners[:, 1].min()))
    bottom = int(np.ceil(corners[:, 1].max()))
    found = np.empty((max(right - left, 0) * max(bottom - top, 0), 2), np.int64)
    count = 0
    area = signed_area(corners[0], corners[1], corners[2, 0], corners[2, 1])
    if area == 0.0:
        return found[:0]
    for y in range(top, bottom):
        for x in range(left, right):
            inside = True
            for e in range(3):
                side = signed_area(corners[e], corners[(e + 1) % 3], x + 0.5, y + 0.5)
                if side * area <= 0.0:
                    inside = False
                    break
            if inside:
                found[count, 0], found[count, 1] = x, y
                count += 1
    return found[:count]


@kernel
def signed_area(a, b, x, y):  # type: ignore[no-untyped-def]
    """Twice the area of the triangle a, b, (x, y), exact for coordinates of `STEPS_PER_PX`."""
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
