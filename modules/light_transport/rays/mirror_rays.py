"""The surroundings of glossy parts: cube maps whose texels remember the rows that their rays met.

The rays are traced once a scene, from the middle of a part through the part itself; each hour
lights the rows that they met (mirror_light.py).
"""

from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.giving_up import GoOn, always
from light_transport.kernels import hot
from light_transport.rays.mirror_parts import MirrorParts
from light_transport.rays.ray_starts import Receivers, scratch
from light_transport.rays.ray_table import met_row
from light_transport.rays.trace import MISS, nearest_along
from light_transport.rays.tree import Tree
from light_transport.surfaces.groups import NO_GROUP
from light_transport.surfaces.map_texels import NOBODY
from vrut_lite.geometry.cube_map import FACE_NORMALS, FACE_S_AXES, FACE_T_AXES, texel_centres
from vrut_lite.numeric_types import Float32Array

SKY = -1
# Edges of cubes; the largest that need no more rays than these.
_EDGES = (128, 96, 64, 48, 32)
_MOST_RAYS = 450_000
# Rays of a texel, along each of its edges.
_ACROSS = 2
# A ray that passes more back sides than this counts as lost inside a body.
_MOST_PASSED = 32
_STEP = 2e-5
# A part larger than this many distances to its surroundings cannot be served by one point.
_LONGEST = 4.0


class MirrorRays(NamedTuple):
    """Cubes (N) of the surroundings of parts, from the middle of each.

    Attributes:
        parts: the parts of the cubes.
        row: (U,) int32, rows of the table of rays that are seen, in order.
        target: (N, 6, e, e, S) int32, which of these each ray met; SKY for sky and open ground.
        nearness: (N, 6, e, e) float32, 1 / distance in 1 / radius, the mean of a texel's rays; 0
            for the sky's.
    """

    parts: MirrorParts
    row: NDArray[np.int32]
    target: NDArray[np.int32]
    nearness: Float32Array


def mirror_rays(
    parts: MirrorParts,
    part_of: NDArray[np.int32],
    tree: Tree,
    receivers: Receivers,
    threads: int,
    go_on: GoOn = always,
) -> MirrorRays | None:
    """Trace the cubes of parts, `part_of` (F,) being each triangle's; None where there are none.

    Raises:
        GivenUp: by `go_on`, which is asked before each cube.
    """
    if len(parts.part) == 0:
        return None
    edge = _edge(len(parts.part))
    directions = _directions(edge)
    target = np.empty((len(parts.part), len(directions)), np.int32)
    near = np.empty(target.shape, np.float32)

    def trace(n: int) -> None:
        go_on()
        own, hollow = int(parts.part[n]), bool(parts.hollow[n])
        view = parts.centre[n], parts.facing[n], directions
        _trace(tree, receivers, part_of, own, hollow, view, scratch(), target[n], near[n])

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(trace, range(len(parts.part))))
    shape = (len(parts.part), 6, edge, edge, _ACROSS**2)
    target = target.reshape(shape)
    near = near.reshape(shape).mean(axis=-1, dtype=np.float32)
    fits = _fits(parts, near)
    if not fits.any():
        return None
    served = MirrorParts(
        parts.part[fits],
        parts.centre[fits],
        parts.radius[fits],
        parts.hollow[fits],
        parts.facing[fits],
    )
    target = target[fits]
    seen = np.zeros(int(target.max()) + 1, bool)
    seen[target[target != SKY]] = True
    # The last entry is SKY's.
    number = np.append(np.cumsum(seen) - 1, SKY).astype(np.int32)
    return MirrorRays(served, np.flatnonzero(seen).astype(np.int32), number[target], near[fits])


def _edge(count: int) -> int:
    rays = 6 * _ACROSS**2 * count
    return next((e for e in _EDGES if e * e * rays <= _MOST_RAYS), _EDGES[-1])


def _fits(parts: MirrorParts, near: Float32Array) -> NDArray[np.bool_]:
    """Which parts see something, and are not too long for one cube."""
    met = near > 0.0
    seen = met.sum(axis=(1, 2, 3))
    mean = near.sum(axis=(1, 2, 3)) / np.maximum(seen, 1)
    return np.asarray((seen > 0) & (parts.radius * mean <= _LONGEST))


def _directions(edge: int) -> Float32Array:
    """Unit directions (6 e e S, 3) of the rays, texel by texel."""
    fine = edge * _ACROSS
    c = texel_centres(fine)
    d = (
        FACE_NORMALS[:, None, None]
        + c[None, None, :, None] * FACE_S_AXES[:, None, None]
        + c[None, :, None, None] * FACE_T_AXES[:, None, None]
    )
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    pieces = d.reshape(6, edge, _ACROSS, edge, _ACROSS, 3).swapaxes(2, 3)
    return np.ascontiguousarray(pieces.reshape(-1, 3), np.float32)


@hot
def _trace(tree, receivers, part_of, own, hollow, view, scratch, target, near):  # type: ignore[no-untyped-def]
    """Fill in the row that each ray met, and its nearness.

    Backs of bodies are passed, and the part itself where it is not hollow. Rays behind a flat part
    are mirrored by it, so that its blurred images do not contain surfaces behind it.
    """
    centre, facing, directions = view
    geometry, texels, probes, groups = receivers
    stack, far_stack, pixel, _, _, place, _, _, ray = scratch
    first_group = len(texels.pixel) + len(probes.place)
    faces = geometry.faces
    for i in range(len(directions)):
        target[i], near[i] = SKY, 0.0
        travelled = np.float32(0.0)
        for k in range(3):
            place[k], ray[k] = centre[k], directions[i, k]
        behind_by = ray[0] * facing[0] + ray[1] * facing[1] + ray[2] * facing[2]
        if behind_by < 0.0:
            for k in range(3):
                ray[k] -= 2.0 * behind_by * facing[k]
        for _ in range(_MOST_PASSED):
            distance, hit, u, v = nearest_along(tree, place, ray, i, stack, far_stack)
            if hit == MISS:
                break
            t = tree.order[hit]
            behind = faces[t, 0] * ray[0] + faces[t, 1] * ray[1] + faces[t, 2] * ray[2] > 0.0
            passed = behind and groups.back[t] == NO_GROUP
            passed = passed or (part_of[t] == own and (behind or not hollow))
            ahead = distance + np.float32(_STEP) if passed else distance
            travelled += ahead
            for k in range(3):
                place[k] += ahead * ray[k]
            if passed:
                continue
            row = met_row(geometry, texels, groups, first_group, t, u, v, place, ray, pixel)
            if row != NOBODY:
                target[i], near[i] = row, np.float32(1.0) / max(travelled, np.float32(1e-6))
            break
