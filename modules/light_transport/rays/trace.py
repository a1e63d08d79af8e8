"""Intersects rays with a tree of triangles: the nearest triangle, or whether there is any."""

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import hot, inlined, kernel
from light_transport.rays.simd_intersection import LANES, boxes_entered, lowest, triangles_crossed
from light_transport.rays.tree import LEAF_BITS, STACK, Tree
from vrut_lite.numeric_types import Float32Array, FloatArray

# Farther than anything in a scene of unit radius.
FAR = np.float32(1e6)
MISS = -1
_LEAF_MASK = (1 << LEAF_BITS) - 1
# Distances of boxes and triangles stand at the end of a stack.
_FOUND = STACK - 3 * LANES
# A beam's directions begin at this of its numbers.
BEAM = 6
# Least magnitude of a direction's components.
_TINY = np.float32(1e-12)
_ONE, _ZERO = np.float32(1.0), np.float32(0.0)
# Barycentric margin beyond edges, so that no ray slips between two neighbouring triangles.
_BEYOND = np.float32(2e-6)


@inlined
def mixed(a: int, b: int) -> int:
    """A 32-bit hash of two numbers (finaliser of Murmur 3)."""
    h = (a * 0x9E3779B1 ^ b * 0x85EBCA77) & 0xFFFFFFFF
    h = ((h ^ (h >> 16)) * 0x7FEB352D) & 0xFFFFFFFF
    h = ((h ^ (h >> 15)) * 0x846CA68B) & 0xFFFFFFFF
    return h ^ (h >> 16)


@inlined
def _inverse(d):  # type: ignore[no-untyped-def]
    """1 / d, finite also for a component of 0."""
    return _ONE / (d if abs(d) > _TINY else _TINY)


@inlined
def _crossed(triangle, t, ox, oy, oz, dx, dy, dz):  # type: ignore[no-untyped-def]
    """Distance to a triangle and barycentric u, v there; distance -1 where it is missed.

    Moeller and Trumbore 1997.
    """
    e1x, e1y, e1z = triangle[t, 3], triangle[t, 4], triangle[t, 5]
    e2x, e2y, e2z = triangle[t, 6], triangle[t, 7], triangle[t, 8]
    px, py, pz = dy * e2z - dz * e2y, dz * e2x - dx * e2z, dx * e2y - dy * e2x
    det = e1x * px + e1y * py + e1z * pz
    if abs(det) < np.float32(1e-30):
        return -_ONE, _ZERO, _ZERO
    inverse = _ONE / det
    sx, sy, sz = ox - triangle[t, 0], oy - triangle[t, 1], oz - triangle[t, 2]
    u = (sx * px + sy * py + sz * pz) * inverse
    if u < -_BEYOND or u > _ONE + _BEYOND:
        return -_ONE, _ZERO, _ZERO
    qx, qy, qz = sy * e1z - sz * e1y, sz * e1x - sx * e1z, sx * e1y - sy * e1x
    v = (dx * qx + dy * qy + dz * qz) * inverse
    if v < -_BEYOND or u + v > _ONE + _BEYOND:
        return -_ONE, _ZERO, _ZERO
    return (e2x * qx + e2y * qy + e2z * qz) * inverse, u, v


@inlined
def _lets_pass(opacity, t, ray):  # type: ignore[no-untyped-def]
    """Whether a triangle that is not opaque lets this ray through; the answer never changes."""
    return opacity[t] < _ONE and mixed(ray, t) >= opacity[t] * np.float32(4294967296.0)


@inlined
def nearest(tree, ox, oy, oz, dx, dy, dz, ray, stack, far_stack):  # type: ignore[no-untyped-def]
    """The nearest triangle on a ray: distance, place in the tree's order (MISS), u, v.

    `ray` numbers the ray, for triangles that let a share of rays pass; the stacks hold STACK
    int32 and float32 numbers and are overwritten.
    """
    return nearest_within(tree, ox, oy, oz, dx, dy, dz, FAR, ray, stack, far_stack)


@hot
def nearest_within(tree, ox, oy, oz, dx, dy, dz, far, ray, stack, far_stack):  # type: ignore[no-untyped-def]
    """`nearest` within `far` lengths of the direction."""
    boxes, child, opacity = tree.wide_boxes, tree.wide_child, tree.opacity
    blocks, number = tree.blocks, tree.number
    to_boxes = ox, oy, oz, _inverse(dx), _inverse(dy), _inverse(dz)
    to_triangles = ox, oy, oz, dx, dy, dz
    hit, hit_u, hit_v = MISS, _ZERO, _ZERO
    top, node = 0, np.int64(0)
    while True:
        if node >= 0:
            bits = boxes_entered(boxes, node, far_stack, _FOUND, to_boxes, far)
            # The nearest child comes on top.
            first = top
            while bits != 0:
                k = lowest(bits)
                bits &= bits - np.int32(1)
                near, at = far_stack[_FOUND + k], top
                while at > first and far_stack[at - 1] < near:
                    far_stack[at], stack[at] = far_stack[at - 1], stack[at - 1]
                    at -= 1
                far_stack[at], stack[at] = near, child[node, k]
                top += 1
        else:
            block = -1 - node
            bits = triangles_crossed(blocks, block, far_stack, _FOUND, to_triangles, far)
            while bits != 0:
                k = lowest(bits)
                bits &= bits - np.int32(1)
                distance, t = far_stack[_FOUND + k], number[block, k]
                if distance < far and not _lets_pass(opacity, t, ray):
                    far, hit = distance, t
                    hit_u, hit_v = far_stack[_FOUND + LANES + k], far_stack[_FOUND + 2 * LANES + k]
        while top > 0 and far_stack[top - 1] >= far:
            top -= 1
        if top == 0:
            return far, hit, hit_u, hit_v
        top -= 1
        node = np.int64(stack[top])


@inlined
def nearest_along(tree, place, direction, ray, stack, far_stack):  # type: ignore[no-untyped-def]
    """`nearest` of a place (3,) and a direction (3,) in double precision."""
    return nearest(
        tree,
        np.float32(place[0]),
        np.float32(place[1]),
        np.float32(place[2]),
        np.float32(direction[0]),
        np.float32(direction[1]),
        np.float32(direction[2]),
        ray,
        stack,
        far_stack,
    )


@inlined
def bound_beam(beam, count):  # type: ignore[no-untyped-def]
    """Fill in the bounds of a beam's first `count` directions.

    `beam` (STACK,) float32 has the directions, three numbers each, from BEAM on; before it come the
    least and the largest inverse along each axis. An axis along which they have both signs bounds
    nothing.
    """
    for k in range(3):
        least, most = FAR, -FAR
        lowest, highest = FAR, -FAR
        for d in range(count):
            along = beam[BEAM + 3 * d + k]
            lowest, highest = min(lowest, along), max(highest, along)
            inverse = _inverse(along)
            least, most = min(least, inverse), max(most, inverse)
        if lowest * highest <= _ZERO:
            least, most = -_ONE / _TINY, _ONE / _TINY
        beam[k], beam[3 + k] = least, most


@inlined
def _may_enter(boxes, node, side, ox, oy, oz, beam, turned):  # type: ignore[no-untyped-def]
    """Whether some direction of a beam may enter a child's box; `turned` has a bit for each axis
    along which they are negative."""
    near, out = _ZERO, FAR
    for k in range(3):
        origin = ox if k == 0 else (oy if k == 1 else oz)
        first = 3 * ((turned >> k) & 1)
        to_near = boxes[node, side + k + first] - origin
        to_far = boxes[node, side + k + 3 - first] - origin
        near = max(near, min(to_near * beam[k], to_near * beam[3 + k]))
        out = min(out, max(to_far * beam[k], to_far * beam[3 + k]))
    return near <= out


@inlined
def _passing(triangle, opacity, t, ox, oy, oz, beam, count, free, ray):  # type: ignore[no-untyped-def]
    """The bits of `free` whose directions a triangle is not in the way of."""
    if _lets_pass(opacity, t, ray):
        return free
    for d in range(count):
        if (free >> d) & 1:
            at = BEAM + 3 * d
            distance, _, _ = _crossed(triangle, t, ox, oy, oz, beam[at], beam[at + 1], beam[at + 2])
            if distance > _ZERO:
                free &= ~(1 << d)
    return free


@hot
def unblocked(tree, ox, oy, oz, beam, count, wanted, ray, stack, likely):  # type: ignore[no-untyped-def]
    """Directions of a beam that nothing is in the way of, and the last triangle that was, or MISS.

    Of `count` directions close to each other (see `bound_beam`) those are asked whose bits `wanted`
    has; the answer has some of these bits. `likely` is tried first: neighbours are often in one
    shadow.
    """
    boxes, child, triangle, opacity = tree.boxes, tree.child, tree.triangle, tree.opacity
    free = wanted
    if likely != MISS:
        free = _passing(triangle, opacity, likely, ox, oy, oz, beam, count, free, ray)
        if free == 0:
            return free, likely
    turned = 0
    for k in range(3):
        if beam[3 + k] < _ZERO:
            turned |= 1 << k
    found = MISS
    top, node = 0, 0
    while True:
        if node >= 0:
            a = _may_enter(boxes, node, 0, ox, oy, oz, beam, turned)
            b = _may_enter(boxes, node, 6, ox, oy, oz, beam, turned)
            if a and b:
                stack[top] = child[node, 1]
                top += 1
            if a or b:
                node = child[node, 0 if a else 1]
                continue
        else:
            code = -1 - node
            first = code >> LEAF_BITS
            for t in range(first, first + (code & _LEAF_MASK)):
                left = _passing(triangle, opacity, t, ox, oy, oz, beam, count, free, ray)
                if left != free:
                    free, found = left, t
            if free == 0:
                return free, found
        if top == 0:
            return free, found
        top -= 1
        node = stack[top]


@kernel
def first_hits(
    tree: Tree, origin: FloatArray, direction: FloatArray
) -> tuple[NDArray[np.int32], Float32Array]:
    """Triangles (R,) of the scene, MISS for none, and distances (R,) along many rays (R, 3)."""
    hits = np.full(len(origin), MISS, np.int32)
    distances = np.full(len(origin), FAR, np.float32)
    stack, far_stack = np.empty(STACK, np.int32), np.empty(STACK, np.float32)
    o, d = origin.astype(np.float32), direction.astype(np.float32)
    for i in range(len(o)):
        distance, hit, _, _ = nearest(
            tree, o[i, 0], o[i, 1], o[i, 2], d[i, 0], d[i, 1], d[i, 2], i, stack, far_stack
        )
        if hit != MISS:
            hits[i], distances[i] = tree.order[hit], distance
    return hits, distances
