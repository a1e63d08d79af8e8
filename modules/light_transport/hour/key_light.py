"""Shares of the key light on texels, for its bounces: the frame draws its direct light.

A shadow ray is lit or not: towards the key light itself a patch of few rays would brighten in steps
while time plays. Shadows are interpolated between three fixed directions 1.5 degrees apart, so that
light changes linearly; hours that follow each other mostly share them. Shadows have edges as soft
as if the sun were three times as wide: less than a texel where it matters. The directions are the
crossings of a lattice on the square of Shirley and Chiu's map (`sky_nodes`), each of whose cells is
cut into two triangles.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import dot, hot
from light_transport.rays.patches import Patches
from light_transport.rays.ray_starts import begin, shift
from light_transport.rays.ray_table import TRIED
from light_transport.rays.trace import BEAM, MISS, bound_beam, mixed, unblocked
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector

# Shadow rays of a patch: at least so many, and from all rows where a third of its view is patches.
_FEWEST = 4
_ALL_ASKED = 1.0 / 3.0
# A group has no other rows whose rays are averaged with its own.
_RAYS_OF_A_GROUP = 8
# Number of directions whose shadows are kept: three for an hour, and three around it.
_MOST_KEPT = 6
# Cells along an edge of the lattice.
_EDGE = 96
_QUARTER = 0.25 * math.pi
# Sine of more than the angle between a direction and those around it.
FARTHEST = 0.06


class KeyRays(NamedTuple):
    """Rows with a shadow ray towards the key light, and their weights in patches.

    `ray` (N,) uint8: a ray of each row that begins outside bodies, or TRIED for rows without a
    shadow ray; `weight` (K,) float32: of patches' members, 1 in the sum over a patch.
    """

    ray: NDArray[np.uint8]
    weight: Float32Array


def key_rays_of(
    patches: Patches,
    free: NDArray[np.uint8],
    enclosed: Float32Array,
    also: NDArray[np.integer],
) -> KeyRays:
    """Rays for patches whose rows' first free rays (N,) are these.

    The rows `also` get shadow rays too and count for no patch.

    `enclosed` (M,): share of a patch's rays that end at other patches. It sends them the same share
    of its light (reciprocity), so that few rows suffice under open sky. Half of the share
    allows twice the error, and errors of means fall with the root of the number: hence the square.
    """
    sizes = np.diff(patches.start)
    patch = np.repeat(np.arange(len(sizes)), sizes)
    number = np.arange(len(patches.member)) - patches.start[patch]
    wanted = np.ceil(np.minimum(enclosed / _ALL_ASKED, 1.0) ** 2 * sizes)
    wanted = np.minimum(np.maximum(wanted, _FEWEST), sizes).astype(np.int64)[patch]
    # The wanted number, spread evenly over the patch's rows.
    asked = number * wanted // sizes[patch] != (number - 1) * wanted // sizes[patch]
    asked &= free[patches.member] < TRIED
    weight = np.where(asked, patches.weight, 0.0)
    total = np.bincount(patch, weight, len(sizes))
    ray = np.full(len(free), TRIED, np.uint8)
    for rows in (patches.member[asked], also):
        ray[rows] = free[rows]
    return KeyRays(ray, (weight / np.maximum(total, 1e-12)[patch]).astype(np.float32))


def patch_means(patches: Patches, rays: KeyRays, values: Float32Array) -> Float32Array:
    """Means (M,) over patches of values (N,) of the rows with shadow rays."""
    means = np.empty(len(patches.start) - 1, np.float32)
    _fill_means(patches.start, patches.member, rays.weight, values, means)
    return means


@hot
def _fill_means(start, member, weight, values, means):  # type: ignore[no-untyped-def]
    for p in range(len(means)):
        total = np.float32(0.0)
        for m in range(start[p], start[p + 1]):
            total += weight[m] * values[member[m]]
        means[p] = total


class KeyShadows:
    """Which shadow rays nothing is in the way of, for fixed directions that hours asked for.

    An hour that moves on needs a third of the rays, or none. Jobs may ask at the same time: what is
    kept is replaced, never changed.
    """

    def __init__(self, rays: KeyRays):
        self.rays = rays
        self._kept: dict[int, NDArray[np.uint8]] = {}

    @property
    def memory_bytes(self) -> int:
        """Memory of all arrays."""
        rays = self.rays.ray.nbytes + self.rays.weight.nbytes
        return rays + sum(kept.nbytes for kept in self._kept.values())

    def towards(
        self, numbers: list[int], cast: Callable[[FloatArray], NDArray[np.uint8]]
    ) -> list[NDArray[np.uint8]]:
        """`shadow_rays` (N,) towards each of some fixed directions, cast together unless kept."""
        kept = self._kept
        missing = [number for number in numbers if number not in kept]
        if missing:
            found = cast(np.array([direction_of(number) for number in missing]))
            own = {number: kept[number] for number in numbers if number in kept}
            own.update(zip(missing, found, strict=True))
            others = [item for item in kept.items() if item[0] not in own]
            kept = {**dict(others[max(len(others) + len(own) - _MOST_KEPT, 0) :]), **own}
            self._kept = kept
        return [kept[number] for number in numbers]


@hot
def shadow_rays(tree, receivers, free_start, directions, scratch, first, last, out):  # type: ignore[no-untyped-def]
    """Fill out[:, first:last] with the rays of rows, a bit each, that reach directions (D, 3).

    An occluder in one direction mostly hides those beside it too. A texel has one
    ray, from anywhere in it: a patch has the mean of its texels. A group has _RAYS_OF_A_GROUP.
    `free_start` (N,): see `KeyRays`. Rays that would begin into their surface go along it,
    for the key light itself may stand above.
    """
    stack, beam, shifts, weights, place, normal, face, _ = scratch
    geometry, texels, probes, groups = receivers
    first_probe = len(texels.pixel)
    first_group = first_probe + len(probes.place)
    likely = MISS
    for row in range(first, last):
        out[:, row] = 0
        if first_probe <= row < first_group or free_start[row] >= TRIED:
            continue
        rays = 1 if row < first_probe else _RAYS_OF_A_GROUP
        shift(row, shifts)
        for s in range(rays):
            number = s if rays > 1 else free_start[row]
            begin(
                geometry, texels, probes, groups, row, number, shifts, weights, place, normal, face
            )
            wanted = 0
            for d in range(len(directions)):
                cosine = dot(face, directions[d])
                if cosine >= -FARTHEST:
                    wanted |= 1 << d
                for k in range(3):
                    beam[BEAM + 3 * d + k] = directions[d, k] - min(cosine, 0.0) * face[k]
            if wanted == 0:
                continue
            bound_beam(beam, len(directions))
            passing, found = unblocked(
                tree,
                np.float32(place[0]),
                np.float32(place[1]),
                np.float32(place[2]),
                beam,
                len(directions),
                wanted,
                mixed(row, s),
                stack,
                likely,
            )
            if found != MISS:
                likely = found
            for d in range(len(directions)):
                if (passing >> d) & 1:
                    out[d, row] |= np.uint8(1 << s)


@hot
def lit_shares(receivers, direction, around, share_of, scratch, first, last, out):  # type: ignore[no-untyped-def]
    """Fill out[first:last] with visible share times cosine of a direction (3,), unit.

    `around`: `shadow_rays` (N,) of three directions around it, which count by `share_of` (3,).
    """
    _, _, shifts, weights, place, normal, face, _ = scratch
    geometry, texels, probes, groups = receivers
    first_probe = len(texels.pixel)
    for row in range(first, last):
        out[row] = 0.0
        if (around[0][row] | around[1][row] | around[2][row]) == 0:
            continue
        if row < first_probe:
            for k in range(3):
                face[k] = texels.side[row] * geometry.faces[texels.triangle[row], k]
        else:
            shift(row, shifts)
        rays = 1 if row < first_probe else _RAYS_OF_A_GROUP
        total = 0.0
        for s in range(rays):
            if rays > 1:
                begin(
                    geometry, texels, probes, groups, row, s, shifts, weights, place, normal, face
                )
            cosine = dot(face, direction)
            if cosine > 0.0:
                seen = 0.0
                for k in range(3):
                    seen += share_of[k] * ((around[k][row] >> s) & 1)
                total += seen * cosine
        out[row] = total / rays


def directions_around(direction: Vector) -> tuple[list[int], FloatArray]:
    """Numbers of three fixed directions around a unit vector, and their weights (3,).

    Weights are continuous in the direction and sum up to 1; from below the horizon it is moved
    there.
    """
    a, b = _on_square(*direction)
    x, y = 0.5 * (a + 1.0) * _EDGE, 0.5 * (b + 1.0) * _EDGE
    i, j = min(int(x), _EDGE - 1), min(int(y), _EDGE - 1)
    u, v = x - i, y - j
    if u + v <= 1.0:
        corners, weights = [(i, j), (i + 1, j), (i, j + 1)], [1.0 - u - v, u, v]
    else:
        corners = [(i + 1, j + 1), (i, j + 1), (i + 1, j)]
        weights = [u + v - 1.0, 1.0 - u, 1.0 - v]
    return [column * (_EDGE + 1) + row for column, row in corners], np.array(weights)


def direction_of(number: int) -> FloatArray:
    """The fixed direction (3,) of a number, unit, not below the horizon."""
    a, b = (2.0 * place / _EDGE - 1.0 for place in divmod(number, _EDGE + 1))
    if a == b == 0.0:
        return np.array([0.0, 1.0, 0.0])
    if abs(a) > abs(b):
        radius, angle = a, _QUARTER * b / a
    else:
        radius, angle = b, _QUARTER * (2.0 - a / b)
    across = radius * math.sqrt(2.0 - radius * radius)
    up = 1.0 - radius * radius
    return np.array([across * math.cos(angle), up, across * math.sin(angle)])


def _on_square(x: float, y: float, z: float) -> tuple[float, float]:
    """Where a direction lies in [-1, 1]^2."""
    radius = math.sqrt(1.0 - min(max(y, 0.0), 1.0))
    angle = math.atan2(z, x)
    if angle < -_QUARTER:
        angle += 2.0 * math.pi
    side, along = divmod(angle + _QUARTER, 2.0 * _QUARTER)
    along = radius * (along / _QUARTER - 1.0)
    if side == 0.0:
        return radius, along
    if side == 1.0:
        return -along, radius
    if side == 2.0:
        return -radius, -along
    return along, -radius
