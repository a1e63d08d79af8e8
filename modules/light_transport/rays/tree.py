"""A bounding volume hierarchy over triangles: binned surface-area heuristic, two boxes a node.

Wald 2007, "On fast construction of SAH-based bounding volume hierarchies". Single precision
suffices: a scene is scaled to unit radius around its middle before. For single rays two to eight
nodes are one of eight boxes (Wald, Benthin and Boulos 2008, "Getting rid of packets").
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import inlined
from light_transport.rays.simd_intersection import LANES
from vrut_lite.njit import njit
from vrut_lite.numeric_types import Float32Array, FloatArray

_BINS = 12
_LEAF = 4
# Deeper than this, nodes are halved by number: bounds the stack, whatever the triangles are.
_DEEPEST_BY_AREA = 40
_DEEPEST = 80
# Size of a search's stack: each of eight boxes may wait, eight triangles have three numbers each.
STACK = 8 * _DEEPEST
# A leaf's code keeps its number of triangles in these bits.
LEAF_BITS = 3
# Boxes are so much larger than their triangles, in radii: more than single precision loses.
_MARGIN = 1e-6


class Tree(NamedTuple):
    """Nodes (K) over triangles (F) that lie in the order of the leaves.

    `boxes` (K, 12) float32: lower and upper corner of both children's boxes. `child` (K, 2) int32:
    a node, or -1 - code of a leaf, whose code is first triangle << LEAF_BITS | number. `triangle`
    (F, 9) float32: a corner and the two edges that begin there. `order` (F,) int32: which
    triangle of the scene it is. `opacity` (F,) float32.

    The same in eights: `wide_boxes` (W, 6, 8) float32, lower and upper corners, of which nothing is
    entered where there is no child; `wide_child` (W, 8) int32: a node, or -1 - a block. `blocks`
    (B, 9, 8) float32: up to eight triangles, the others without area; `number` (B, 8) int32: which
    in the order of the leaves.
    """

    boxes: Float32Array
    child: NDArray[np.int32]
    triangle: Float32Array
    order: NDArray[np.int32]
    opacity: Float32Array
    wide_boxes: Float32Array
    wide_child: NDArray[np.int32]
    blocks: Float32Array
    number: NDArray[np.int32]


def tree_over(corners: FloatArray, opacity: Float32Array) -> Tree:
    """The tree over triangles (F, 3, 3) in units of the scene's radius; F may be 0."""
    corners = np.asarray(corners, np.float64)
    lower, upper = corners.min(axis=1), corners.max(axis=1)
    order = np.arange(len(corners), dtype=np.int32)
    boxes, child, used = _nodes(
        (lower - _MARGIN).astype(np.float32),
        (upper + _MARGIN).astype(np.float32),
        (0.5 * (lower + upper)).astype(np.float32),
        order,
    )
    first = corners[order]
    edges = (first[:, 1] - first[:, 0], first[:, 2] - first[:, 0])
    triangle = np.concatenate([first[:, 0], *edges], axis=1).astype(np.float32)
    boxes, child = boxes[:used].copy(), child[:used].copy()
    wide_boxes, wide_child, number = _in_eights(boxes, child)
    # Number -1 stands for the last, which has no area.
    blocks = np.append(triangle, np.zeros((1, 9), np.float32), axis=0)[number]
    return Tree(
        boxes,
        child,
        triangle,
        order,
        np.asarray(opacity[order], np.float32),
        wide_boxes,
        wide_child,
        np.ascontiguousarray(blocks.transpose(0, 2, 1)),
        number,
    )


@njit(cache=True, nogil=True)
def _in_eights(
    boxes: Float32Array, child: NDArray[np.int32]
) -> tuple[Float32Array, NDArray[np.int32], NDArray[np.int32]]:
    """Boxes (W, 6, 8), children (W, 8) and blocks (B, 8) of a tree of two boxes a node."""
    nodes = len(child)
    # Triangles below each node: they lie in one piece, and a node comes before those below it.
    first, count = np.empty(nodes, np.int32), np.zeros(nodes, np.int32)
    for n in range(nodes - 1, -1, -1):
        first[n] = 0x7FFFFFFF
        for side in range(2):
            begins, number = _below(child[n, side], first, count)
            if number > 0:
                first[n] = min(first[n], begins)
                count[n] += number
    wide_boxes = np.empty((nodes, 6, LANES), np.float32)
    wide_boxes[:, :3], wide_boxes[:, 3:] = 3e38, -3e38
    wide_child = np.full((nodes, LANES), -1, np.int32)
    blocks = np.full((nodes + 1, LANES), -1, np.int32)
    # The two-box node that each is made of.
    made_of = np.zeros(nodes, np.int32)
    code, box, area = np.empty(LANES, np.int32), np.empty((LANES, 6), np.float32), np.empty(LANES)
    used, used_blocks = 1, 0
    wide = 0
    while wide < used:
        kids = 0
        opened = made_of[wide]
        at = 0
        while True:
            # The node at `at` gives its place to its two children.
            for side in range(2):
                number = _below(child[opened, side], first, count)[1]
                if number == 0:
                    continue
                to = at if side == 0 or kids == 0 else kids
                if to == kids:
                    kids += 1
                code[to] = child[opened, side]
                # Number by number: numba compiles a slice's assignment with the text of its error.
                for k in range(6):
                    box[to, k] = boxes[opened, 6 * side + k]
                area[to] = _half_area(box[to]) if number > LANES else -1.0
            if kids == 0 or kids == LANES:
                break
            at = int(np.argmax(area[:kids]))
            if area[at] < 0.0:
                break
            opened = code[at]
        for k in range(kids):
            for side in range(6):
                wide_boxes[wide, side, k] = box[k, side]
            if area[k] >= 0.0:
                made_of[used] = code[k]
                wide_child[wide, k] = used
                used += 1
            else:
                begins, number = _below(code[k], first, count)
                for t in range(number):
                    blocks[used_blocks, t] = begins + t
                wide_child[wide, k] = -1 - used_blocks
                used_blocks += 1
        wide += 1
    return wide_boxes[:used].copy(), wide_child[:used].copy(), blocks[:used_blocks].copy()


@inlined
def _below(code, first, count):  # type: ignore[no-untyped-def]
    """The first triangle of a node or leaf, and how many it has."""
    if code >= 0:
        return first[code], count[code]
    leaf = np.int32(-1 - code)
    return leaf >> np.int32(LEAF_BITS), leaf & np.int32((1 << LEAF_BITS) - 1)


@njit(cache=True, nogil=True)
def _nodes(
    lower: Float32Array, upper: Float32Array, centre: Float32Array, order: NDArray[np.int32]
) -> tuple[Float32Array, NDArray[np.int32], int]:
    """Boxes and children of nodes, the first of which are used, and how many; fills in `order`."""
    count = len(lower)
    boxes = np.zeros((max(count, 1), 12), np.float32)
    child = np.empty((max(count, 1), 2), np.int32)
    # A leaf of no triangles.
    child[0, 0], child[0, 1] = -1, -1
    # Nodes to split: first and last triangle, depth, and the parent's child index.
    todo = np.empty((_DEEPEST, 5), np.int64)
    top, used = 0, 0
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3], todo[0, 4] = 0, count, 0, -1, 0
    top = 1 if count > 0 else 0
    used = 1 if count == 0 else 0
    bounds = np.empty(6, np.float32)
    while top > 0:
        top -= 1
        first, last, depth = todo[top, 0], todo[top, 1], todo[top, 2]
        parent, side = todo[top, 3], todo[top, 4]
        _bounds(lower, upper, order, first, last, bounds)
        number = last - first
        if number <= _LEAF and parent >= 0:
            code = -1 - ((first << LEAF_BITS) | number)
        elif number <= _LEAF:
            for k in range(6):
                boxes[0, k] = bounds[k]
            child[0, 0] = -1 - ((first << LEAF_BITS) | number)
            used = 1
            continue
        else:
            middle = first
            if depth < _DEEPEST_BY_AREA:
                middle = _split(lower, upper, centre, order, first, last)
            if middle <= first or middle >= last:
                middle = (first + last) // 2
            code = used
            used += 1
            # The larger half waits, so that few wait at once.
            which = 0 if middle - first > last - middle else 1
            for _ in range(2):
                todo[top, 0] = first if which == 0 else middle
                todo[top, 1] = middle if which == 0 else last
                todo[top, 2], todo[top, 3], todo[top, 4] = depth + 1, code, which
                top += 1
                which = 1 - which
        if parent >= 0:
            for k in range(6):
                boxes[parent, 6 * side + k] = bounds[k]
            child[parent, side] = code
    return boxes, child, used


@inlined
def _bounds(
    lower: Float32Array,
    upper: Float32Array,
    order: NDArray[np.int32],
    first: int,
    last: int,
    bounds: Float32Array,
) -> None:
    for a in range(3):
        bounds[a], bounds[3 + a] = lower[order[first], a], upper[order[first], a]
    for i in range(first + 1, last):
        t = order[i]
        for a in range(3):
            bounds[a] = min(bounds[a], lower[t, a])
            bounds[3 + a] = max(bounds[3 + a], upper[t, a])


@inlined
def _half_area(bounds: Float32Array) -> float:
    x, y, z = bounds[3] - bounds[0], bounds[4] - bounds[1], bounds[5] - bounds[2]
    return x * y + y * z + z * x


@inlined
def _make_empty(bounds: Float32Array) -> None:
    for a in range(3):
        bounds[a], bounds[3 + a] = 3e38, -3e38


@inlined
def _grow(bounds: Float32Array, lower: Float32Array, upper: Float32Array) -> None:
    for a in range(3):
        bounds[a] = min(bounds[a], lower[a])
        bounds[3 + a] = max(bounds[3 + a], upper[a])


@njit(cache=True, nogil=True)
def _split(
    lower: Float32Array,
    upper: Float32Array,
    centre: Float32Array,
    order: NDArray[np.int32],
    first: int,
    last: int,
) -> int:
    """Order triangles by the cheapest plane between bins; the first one behind it, or `first`."""
    least, most = np.empty(3, np.float32), np.empty(3, np.float32)
    for a in range(3):
        least[a] = most[a] = centre[order[first], a]
    for i in range(first + 1, last):
        t = order[i]
        for a in range(3):
            least[a] = min(least[a], centre[t, a])
            most[a] = max(most[a], centre[t, a])
    scale = np.zeros(3, np.float32)
    for a in range(3):
        if most[a] > least[a]:
            scale[a] = _BINS / (most[a] - least[a])
    bin_count = np.zeros((3, _BINS), np.int64)
    bin_box = np.empty((3, _BINS, 6), np.float32)
    for a in range(3):
        for b in range(_BINS):
            _make_empty(bin_box[a, b])
    for i in range(first, last):
        t = order[i]
        for a in range(3):
            b = min(_BINS - 1, int((centre[t, a] - least[a]) * scale[a]))
            bin_count[a, b] += 1
            _grow(bin_box[a, b], lower[t], upper[t])
    best, axis, cut = 3e38, -1, 0
    right_cost = np.empty(_BINS)
    box = np.empty(6, np.float32)
    for a in range(3):
        if scale[a] == 0.0:
            continue
        _make_empty(box)
        number = 0
        for b in range(_BINS - 1, 0, -1):
            if bin_count[a, b]:
                number += bin_count[a, b]
                _grow(box, bin_box[a, b, :3], bin_box[a, b, 3:])
            right_cost[b] = number * _half_area(box) if number else 0.0
        _make_empty(box)
        number = 0
        for b in range(_BINS - 1):
            if bin_count[a, b]:
                number += bin_count[a, b]
                _grow(box, bin_box[a, b, :3], bin_box[a, b, 3:])
            if number == 0 or number == last - first:
                continue
            cost = number * _half_area(box) + right_cost[b + 1]
            if cost < best:
                best, axis, cut = cost, a, b
    if axis < 0:
        return first
    i, j = first, last - 1
    while i <= j:
        if min(_BINS - 1, int((centre[order[i], axis] - least[axis]) * scale[axis])) <= cut:
            i += 1
        else:
            order[i], order[j] = order[j], order[i]
            j -= 1
    return i
