"""Starts and directions of rays: an endless low-discrepancy sequence.

Ray s of a row is the same for any number of rays and on any thread. The sequences
are additive recurrences (Roberts 2018, "The unreasonable effectiveness of quasirandom
sequences"), each row's shifted by its hash.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import inlined
from light_transport.rays.groups import TriangleGroups
from light_transport.rays.map_texels import (
    MapGeometry,
    Texels,
    beginning_at,
    ground_place,
    keep_off_edges,
    surface_place,
    triangle_at,
)
from light_transport.rays.trace import mixed
from light_transport.rays.tree import STACK
from vrut_lite.numeric_types import Float32Array, FloatArray

# Powers of the plastic number for directions, and of the root of x^4 = x + 1 for places. One
# sequence of four dimensions errs four times as much with 64 rays.
TURNS = (0.7548776662466927, 0.5698402909980532)
_STEPS = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)
SEQUENCES = 5
# Rays begin so far off their surface, in radii; single precision needs a tenth of it.
OFF = 1e-5


class Probes(NamedTuple):
    """Small planes in the air (Q): places (Q, 3) in radii and normals (Q, 3), float32."""

    place: Float32Array
    normal: Float32Array


class Receivers(NamedTuple):
    """All rows of the table: texels, then planes of probes, then groups."""

    geometry: MapGeometry
    texels: Texels
    probes: Probes
    groups: TriangleGroups


class Scratch(NamedTuple):
    """Small arrays that kernels of rays overwrite."""

    stack: NDArray[np.int32]
    far_stack: Float32Array
    shifts: FloatArray
    weights: FloatArray
    place: FloatArray
    normal: FloatArray
    face: FloatArray
    direction: FloatArray


def scratch() -> Scratch:
    """New ones, for one thread."""
    threes = [np.empty(3) for _ in range(5)]
    stack, far_stack = np.empty(STACK, np.int32), np.empty(STACK, np.float32)
    return Scratch(stack, far_stack, np.empty(SEQUENCES), *threes)


@inlined
def shift(row, shifts):  # type: ignore[no-untyped-def]
    """Fill in where the sequences (SEQUENCES) of a row begin."""
    for which in range(SEQUENCES):
        shifts[which] = mixed(row, which) * (1.0 / 4294967296.0)


@inlined
def evenly(shift, step, number):  # type: ignore[no-untyped-def]
    """A number in [0, 1), evenly spread over rays."""
    moved = shift + step * (number + 1)
    return moved - math.floor(moved)


@inlined
def begin(geometry, texels, probes, groups, row, number, shifts, weights, place, normal, face):  # type: ignore[no-untyped-def]
    """Fill in the point that ray `number` of a row begins at, off the surface, and the normals.

    `normal` is the shading normal that rays are spread around, `face` the triangle's own;
    `weights` (3,) is overwritten. The first four are those of `Receivers`; taken from it for each
    ray, their arrays would be counted each time.
    """
    off = OFF
    if row < len(texels.pixel):
        column, line = texels.pixel[row, 0], texels.pixel[row, 1]
        x = column + evenly(shifts[2], _STEPS[0], number)
        y = line + evenly(shifts[3], _STEPS[1], number)
        x, y = beginning_at(texels, row, number, x, y)
        t = texels.triangle[row]
        if geometry.on_ground[t]:
            ground_place(geometry.ground, x, y, place)
            for k in range(3):
                normal[k] = geometry.faces[t, k]
        else:
            t = triangle_at(geometry, column, line, x, y, weights)
            surface_place(geometry, t, weights, place, normal)
        side = texels.side[row]
        for k in range(3):
            normal[k] *= side
            face[k] = side * geometry.faces[t, k]
    elif row < len(texels.pixel) + len(probes.place):
        probe = row - len(texels.pixel)
        for k in range(3):
            place[k] = probes.place[probe, k]
            normal[k] = face[k] = probes.normal[probe, k]
        off = 0.0
    else:
        group = row - len(texels.pixel) - len(probes.place)
        first, last = groups.start[group], groups.start[group + 1]
        wanted = evenly(shifts[4], _STEPS[2], number)
        low, high = first, last - 1
        while low < high:
            middle = (low + high) // 2
            if groups.area_up_to[middle] < wanted:
                low = middle + 1
            else:
                high = middle
        t = groups.triangle[low]
        root = math.sqrt(evenly(shifts[2], _STEPS[0], number))
        across = evenly(shifts[3], _STEPS[1], number)
        weights[0], weights[1], weights[2] = 1.0 - root, root * (1.0 - across), root * across
        keep_off_edges(weights)
        surface_place(geometry, t, weights, place, normal)
        for k in range(3):
            normal[k] *= groups.side[group]
            face[k] = groups.side[group] * geometry.faces[t, k]
    for k in range(3):
        place[k] += off * face[k]


@inlined
def across(normal):  # type: ignore[no-untyped-def]
    """Two unit vectors across a normal and each other.

    Duff et al. 2017, "Building an orthonormal basis, revisited".
    """
    sign = 1.0 if normal[2] >= 0.0 else -1.0
    a = -1.0 / (sign + normal[2])
    b = normal[0] * normal[1] * a
    return (
        1.0 + sign * normal[0] ** 2 * a,
        sign * b,
        -sign * normal[0],
        b,
        sign + normal[1] ** 2 * a,
        -normal[1],
    )


@inlined
def aim(number, shifts, normal, face, direction):  # type: ignore[no-untyped-def]
    """Fill in the direction of ray `number`: cosine-distributed around the normal.

    Directions below the triangle are mirrored by its plane.
    """
    radius2 = evenly(shifts[0], TURNS[0], number)
    angle = 2.0 * math.pi * evenly(shifts[1], TURNS[1], number)
    radius = math.sqrt(radius2)
    x, y, z = radius * math.cos(angle), radius * math.sin(angle), math.sqrt(1.0 - radius2)
    xx, xy, xz, yx, yy, yz = across(normal)
    direction[0] = x * xx + y * yx + z * normal[0]
    direction[1] = x * xy + y * yy + z * normal[1]
    direction[2] = x * xz + y * yz + z * normal[2]
    below = direction[0] * face[0] + direction[1] * face[1] + direction[2] * face[2]
    if below < 0.0:
        for k in range(3):
            direction[k] -= 2.0 * below * face[k]


def no_probes() -> Probes:
    """The empty probes of a scene whose surfaces all have texels."""
    return Probes(np.empty((0, 3), np.float32), np.empty((0, 3), np.float32))


def probe_planes(places_m: NDArray[np.float64], centre_m: FloatArray, radius_m: float) -> Probes:
    """Six planes for each place (..., 3), world axes: +x, -x, +y, -y, +z and -z."""
    places = (places_m.reshape(-1, 3) - centre_m) / radius_m
    axes = np.zeros((6, 3))
    axes[np.arange(6), np.arange(6) // 2] = np.where(np.arange(6) % 2 == 0, 1.0, -1.0)
    return Probes(
        np.repeat(places, 6, axis=0).astype(np.float32),
        np.tile(axes, (len(places), 1)).astype(np.float32),
    )
