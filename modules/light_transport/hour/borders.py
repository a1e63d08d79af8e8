"""Light of texels at borders, by which the frame finds the means of their rays.

Rays begin in the part of a texel that surfaces cover and that is seen, the frame takes their mean
for the light of the texel's middle. At a chart's border and at the foot of a body across a
texel both are up to half a texel apart, and close to other surfaces light bends within a texel.
There a texel shows x_i = m_i + (m_i - sum_j w_ij m_j) /
w_ii instead, the first step of Jacobi's iteration for sum_j w_ij x_j = m_i: m are the means, and w
the shares that texels have in the frame's look-ups (linear between texels) at the places where rays
begin.

Texels inside bodies show a neighbour's light, for look-ups at a body's foot mix them in.
"""

from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import hot, inlined, kernel
from light_transport.rays.map_texels import ANYWHERE, NOBODY, PLACES, Texels, has_place, place_at
from vrut_lite.numeric_types import BoolArray, Float32Array

# Least w_ii: a strip along a chart's border is far from its texel's middle, and extrapolated light
# has more noise.
_LEAST_OWN = np.float32(0.6)
# Harmonic mean distance (texels) to visible surfaces below which light varies within a texel.
_CLOSE = np.float32(2.0)
# A texel shows from half to twice the mean of its rays.
_MOST_CHANGE = np.float32(2.0)


class Borders(NamedTuple):
    """Texels (K) at borders or close to other surfaces: their rows (K,) int32.

    `near` (K, 9) int32: rows whose light look-ups in a texel find, line by line of the map;
    `weight` (K, 9) float32: their shares w_ij.
    """

    row: NDArray[np.int32]
    near: NDArray[np.int32]
    weight: Float32Array


def borders_of(
    texels: Texels,
    beside: NDArray[np.int32],
    source: NDArray[np.int32],
    good: BoolArray,
    room: Float32Array,
) -> Borders:
    """Borders of good texels (N,), by the texels beside each (N, 4) and whose light it shows (N,).

    `room` (N,): harmonic mean distance of surfaces in view, in radii.

    Where the chart has no texel, look-ups find the texel itself: charts are padded by it, and in
    those of one texel's width the frame looks at its middle alone.
    """
    there = (texels.begins != ANYWHERE) | (room < _CLOSE * texels.width)
    there &= good & (texels.side > 0.0) & (texels.begins != 0)
    row = np.flatnonzero(there).astype(np.int32)
    near = np.repeat(row[:, None], 9, axis=1)
    weight = np.zeros(near.shape, np.float32)
    _fill_borders(texels, beside, source, row, near, weight)
    return Borders(row, near, weight)


@inlined
def _step(beside, row, off, axis):  # type: ignore[no-untyped-def]
    """The texel beside a row, -1, 0 or 1 along an axis of the map, or NOBODY."""
    return row if off == 0 or row < 0 else beside[row, 2 * axis + (off + 1) // 2]


@kernel
def _fill_borders(texels, beside, source, row, near, weight):  # type: ignore[no-untyped-def]
    for k in range(len(row)):
        i = row[k]
        column, line = texels.pixel[i, 0], texels.pixel[i, 1]
        for n in range(9):
            x, y = n % 3 - 1, n // 3 - 1
            found = _step(beside, _step(beside, i, y, 0), x, 1)
            if found < 0:
                found = _step(beside, _step(beside, i, x, 1), y, 0)
            if found >= 0 and source[found] >= 0:
                near[k, n] = source[found]
        places = 0
        for place in range(PLACES * PLACES):
            if not has_place(texels.begins[i], place):
                continue
            places += 1
            x, y = place_at(texels, i, place)
            # From the middle of the texel to the left and above.
            x, y = x - (column - 0.5), y - (line - 0.5)
            for n in range(9):
                share_x, share_y = 1.0 - abs(x - n % 3), 1.0 - abs(y - n // 3)
                if share_x > 0.0 and share_y > 0.0:
                    weight[k, n] += np.float32(share_x * share_y)
        for n in range(9):
            weight[k, n] /= np.float32(places)


@hot
def border_light(light, borders, first, last, out):  # type: ignore[no-untyped-def]
    """Fill in out[first:last] (K, 4), what border texels show, by the means of rays (N, 4)."""
    row, near, weight = borders.row, borders.near, borders.weight
    for k in range(first, last):
        i = row[k]
        own = np.float32(0.0)
        for n in range(9):
            if near[k, n] == i:
                own += weight[k, n]
        own = max(own, _LEAST_OWN)
        for c in range(4):
            found = np.float32(0.0)
            for n in range(9):
                found += weight[k, n] * light[near[k, n], c]
            mean = light[i, c]
            shown = mean + (mean - found) / own
            out[k, c] = min(max(shown, mean / _MOST_CHANGE), mean * _MOST_CHANGE)


def takes_light_of(
    links: NDArray[np.int32], good: BoolArray, free: Float32Array
) -> NDArray[np.int32]:
    """The texel whose light each texel (N,) shows: itself if good, else the nearest good one.

    Of two equally near ones that with more of its rays `free` (N,): under a wall that is two
    texels thick it is the one that look-ups beside the wall need. NOBODY without a good one.
    """
    return cast(NDArray[np.int32], _takes(links, good, free))


@kernel
def _takes(links, good, free):  # type: ignore[no-untyped-def]
    count = len(links)
    source = np.full(count, NOBODY, np.int32)
    for i in range(count):
        if good[i]:
            source[i] = i
    while True:
        found = source.copy()
        some = False
        for i in range(count):
            if source[i] >= 0:
                continue
            best = NOBODY
            for k in range(links.shape[1]):
                j = links[i, k]
                if j < 0 or source[j] < 0:
                    continue
                if best < 0 or free[source[j]] > free[best]:
                    best = source[j]
            if best >= 0:
                found[i] = best
                some = True
        if not some:
            return source
        source = found
