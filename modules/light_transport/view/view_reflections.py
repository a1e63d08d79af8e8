"""Reflections in coats and metals at the points of a finished still, by rays into their lobes.

A map's coat mirrors the mean of all things. Here each point has its own rays, distributed as the
facets that the eye sees (GGX: Heitz 2018, "Sampling the GGX distribution of visible normals", by
the spherical caps of Dupuy and Benyoub 2023); they end on the map's texels, in the key light or in
its shadow.
"""

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.giving_up import CancelCheck
from light_transport.hour.illumination import HourLight, Illumination
from light_transport.hour.relighting import reflectance_of
from light_transport.kernels import dot, inlined, kernel
from light_transport.rays.map_texels import NOBODY, surface_place
from light_transport.rays.ray_scene import RayScene
from light_transport.rays.ray_starts import OFF, SEQUENCES, TURNS, across, evenly, shift
from light_transport.rays.ray_table import met_row
from light_transport.rays.sky_nodes import NODES
from light_transport.rays.trace import BEAM, MISS, bound_beam, mixed, nearest_along, unblocked
from light_transport.rays.tree import STACK
from light_transport.surfaces.surfaces import GROUND
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import FACE_S_AXES, FACE_T_AXES
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

_BLOCK = 512
# Ratio of all rays to the first few.
_FEWER = 4
# As mesh.frag has it.
_SMALLEST_ALPHA = 0.005
_S_AXES, _T_AXES = FACE_S_AXES.astype(np.float32), FACE_T_AXES.astype(np.float32)


class ViewPoints(NamedTuple):
    """Points (P) that a picture shows: row of the surface, place, normals, direction.

    Attributes:
        row: (P,) int32, row of the table, see `met_row`.
        place: (P, 3) float64, in radii.
        normal, face: (P, 3) float64, unit shading and face normals on the side that is seen.
        towards: (P, 3) float64, unit, from the eye.
    """

    row: NDArray[np.int32]
    place: FloatArray
    normal: FloatArray
    face: FloatArray
    towards: FloatArray


class LobeLight(NamedTuple):
    """Light in lobes, by the two parts of Schlick's term: from everywhere, and at grazing angles.

    Attributes:
        radiance: (2, P, 4) float32, means over the lobe, W m^-2 sr^-1, and 1; 0 where the surface
            has no texels and so no roughness.
        error: (2, P) float32, rms error of the luminance.
        room: (P,) float32, harmonic mean distance of mirrored surfaces times the square of the
            roughness, in radii: the distance over which an image changes.
    """

    radiance: Float32Array
    error: Float32Array
    room: Float32Array


def lobe_light(
    scene: RayScene,
    hour: Illumination,
    lit: HourLight,
    points: ViewPoints,
    rays: int,
    threads: int,
    go_on: CancelCheck,
    noisy: Callable[[LobeLight], BoolArray] | None = None,
) -> LobeLight:
    """The light of an hour that surfaces mirror towards the eye, the key light's own left out.

    Args:
        rays: of each point.
        threads: that trace them; the result does not depend on it.
        noisy: says which points (P,) need all rays after a fourth of them; None: all do.

    Raises:
        GivenUp: by `go_on`.
    """
    assert scene.patches is not None
    surfaces, texels = scene.surfaces, len(scene.texels.pixel)
    surroundings = (
        lit.texels,
        lit.column_light,
        scene.patches.column_of,
        reflectance_of(scene, hour),
        surfaces.emitted_rgb,
        scene.colour_of,
    )
    alpha = np.zeros(len(points.row), np.float32)
    has_texels = np.flatnonzero((points.row >= 0) & (points.row < texels))
    own = scene.colour_of[points.row[has_texels]]
    glossy = surfaces.part[own] != GROUND
    roughness = surfaces.roughness[own[glossy]]
    alpha[has_texels[glossy]] = np.maximum(roughness**2, np.float32(_SMALLEST_ALPHA))
    light = (
        np.ascontiguousarray(hour.sky, np.float32),
        np.asarray(hour.ground_radiance_rgb, np.float32),
        np.asarray(hour.key_direction, np.float64),
        np.asarray(hour.key_irradiance_rgb, np.float32),
    )
    sums, nearness = np.zeros((len(alpha), 2, 7)), np.zeros(len(alpha))

    def trace(which: NDArray[np.intp], first_ray: int, last_ray: int) -> None:
        def block(first: int) -> None:
            go_on()
            some = which[first : first + _BLOCK]
            own = (alpha, some, first_ray, last_ray)
            _lobes(scene.tree, scene.receivers, points, own, surroundings, light, sums, nearness)

        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(block, range(0, len(which), _BLOCK)))

    coated = np.flatnonzero(alpha > 0.0)
    few = rays if noisy is None else max(1, rays // _FEWER)
    trace(coated, 0, few)
    found = _means(alpha, sums, nearness)
    if noisy is None:
        return found
    trace(coated[noisy(found)[coated]], few, rays)
    return _means(alpha, sums, nearness)


def _means(alpha: Float32Array, sums: FloatArray, nearness: FloatArray) -> LobeLight:
    """Means by the sums (P, 2, 7) and the nearness (P,) of rays, see `_lobes`."""
    total = np.moveaxis(sums[..., 3], 1, 0)
    known: BoolArray = np.asarray((total > 0.0).all(axis=0))
    total = np.where(known, total, 1.0)
    values = np.moveaxis(sums, 1, 0)
    radiance = np.append(values[..., :3] / total[..., None], np.ones((*total.shape, 1)), axis=2)
    mean = luminance(radiance[..., :3])
    spread = values[..., 6] - 2.0 * mean * values[..., 5] + mean * mean * values[..., 4]
    error = np.sqrt(np.maximum(spread, 0.0)) / total
    room = alpha * total.sum(axis=0) / np.maximum(nearness, 1e-6)
    return LobeLight(
        np.where(known[:, None], radiance, 0.0).astype(np.float32),
        np.where(known, error, 0.0).astype(np.float32),
        np.where(known, room, 0.0).astype(np.float32),
    )


@kernel
def _lobes(tree, receivers, points, own, scene, light, sums, nearness):  # type: ignore[no-untyped-def]
    """Add rays of some points to the sums (P, 2, 7) of both lobes and to the nearness (P,).

    The sums are of weights times RGB, of weights, of their squares, and of these times luminance
    and its square; the nearness is of weights over distances.
    """
    alphas, which, first_ray, last_ray = own
    stack, far_stack = np.empty(STACK, np.int32), np.empty(STACK, np.float32)
    shifts, weights = np.empty(SEQUENCES), np.empty(3)
    place, normal, ray = np.empty(3), np.empty(3), np.empty(3)
    rgb = np.empty(3, np.float32)
    beam = np.empty(STACK, np.float32)
    for k in range(3):
        beam[BEAM + k] = light[2][k]
    bound_beam(beam, 1)
    for i in which:
        a = np.float64(alphas[i])
        shift(i, shifts)
        n, face, towards = points.normal[i], points.face[i], points.towards[i]
        xx, xy, xz, yx, yy, yz = across(n)
        vx = -(xx * towards[0] + xy * towards[1] + xz * towards[2])
        vy = -(yx * towards[0] + yy * towards[1] + yz * towards[2])
        vz = max(-dot(n, towards), 1e-4)
        wide = math.sqrt(a * a * (vx * vx + vy * vy) + vz * vz)
        sx, sy, sz = a * vx / wide, a * vy / wide, vz / wide
        from_eye = math.sqrt(a * a + (1.0 - a * a) * vz * vz)
        for s in range(first_ray, last_ray):
            # A facet that is seen: of a cap, then flattened.
            z = (1.0 - evenly(shifts[0], TURNS[0], s)) * (1.0 + sz) - sz
            angle = 2.0 * math.pi * evenly(shifts[1], TURNS[1], s)
            radius = math.sqrt(max(1.0 - z * z, 0.0))
            hx, hy = a * (radius * math.cos(angle) + sx), a * (radius * math.sin(angle) + sy)
            hz = max(z + sz, 1e-9)
            length = math.sqrt(hx * hx + hy * hy + hz * hz)
            hx, hy, hz = hx / length, hy / length, hz / length
            vh = vx * hx + vy * hy + vz * hz
            lx, ly, lz = 2.0 * vh * hx - vx, 2.0 * vh * hy - vy, 2.0 * vh * hz - vz
            if lz <= 0.0:
                continue
            ray[0] = lx * xx + ly * yx + lz * n[0]
            ray[1] = lx * xy + ly * yy + lz * n[1]
            ray[2] = lx * xz + ly * yz + lz * n[2]
            for k in range(3):
                place[k] = points.place[i, k] + OFF * face[k]
            if dot(face, ray) <= 0.0:
                continue
            # Smith's terms, height-correlated, over that of the eye alone.
            to_light = math.sqrt(a * a + (1.0 - a * a) * lz * lz)
            weight = lz * (vz + from_eye) / (vz * to_light + lz * from_eye)
            number = mixed(i, s + 64)
            distance, hit, u, v = nearest_along(tree, place, ray, number, stack, far_stack)
            if hit == MISS:
                _open_radiance(light, ray, rgb)
            else:
                t = tree.order[hit]
                weights[0], weights[1], weights[2] = 1.0 - u - v, u, v
                for k in range(3):
                    place[k] += distance * ray[k]
                if not _met_radiance(
                    tree, receivers, scene, light, t, weights, ray, number, place, normal, beam,
                    stack, rgb,
                ):  # fmt: skip
                    continue
                nearness[i] += weight / max(distance, np.float32(1e-6))
            grazing = (1.0 - min(max(vh, 0.0), 1.0)) ** 5
            bright = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
            for lobe in range(2):
                share = weight * (grazing if lobe else 1.0 - grazing)
                for k in range(3):
                    sums[i, lobe, k] += share * rgb[k]
                sums[i, lobe, 3] += share
                sums[i, lobe, 4] += share * share
                sums[i, lobe, 5] += share * share * bright
                sums[i, lobe, 6] += share * share * bright * bright


@inlined
def _open_radiance(light, ray, rgb):  # type: ignore[no-untyped-def]
    """Fill in what a ray that meets nothing brings: sky, linear between texels, or ground."""
    sky, ground, _, _ = light
    if ray[1] < 0.0:
        for k in range(3):
            rgb[k] = ground[k]
        return
    axis = 0
    for k in range(1, 3):
        if abs(ray[k]) > abs(ray[axis]):
            axis = k
    side = 2 * axis + (1 if ray[axis] < 0.0 else 0)
    a, b = 0.0, 0.0
    for k in range(3):
        a += _S_AXES[side, k] * ray[k]
        b += _T_AXES[side, k] * ray[k]
    size = sky.shape[1]
    # The rows below the horizon are not the sky's.
    rows = size if axis == 1 else size // 2
    x = min(max((a / abs(ray[axis]) + 1.0) * 0.5 * size - 0.5, 0.0), size - 1.0)
    y = min(max((b / abs(ray[axis]) + 1.0) * 0.5 * size - 0.5, 0.0), rows - 1.0)
    j, i = min(int(x), size - 2), min(int(y), rows - 2)
    x, y = x - j, y - i
    for k in range(3):
        top = (1.0 - x) * sky[side, i, j, k] + x * sky[side, i, j + 1, k]
        below = (1.0 - x) * sky[side, i + 1, j, k] + x * sky[side, i + 1, j + 1, k]
        rgb[k] = (1.0 - y) * top + y * below


@inlined
def _met_radiance(  # type: ignore[no-untyped-def]
    tree, receivers, scene, light, t, weights, ray, number, place, normal, beam, stack, rgb
):
    """Fill in what a surface sends that a ray met; False at the back of a body."""
    geometry, texels, probes, groups = receivers
    lit, column_light, column_of, reflectance, emitted, colour_of = scene
    _, _, key, key_rgb = light
    first_group = len(texels.pixel) + len(probes.place)
    row = met_row(geometry, texels, groups, first_group, t, weights[1], weights[2], place, ray)
    if row == NOBODY:
        return False
    if row >= len(texels.pixel) or texels.side[row] < 0.0:
        column = column_of[NODES + row]
        for k in range(3):
            rgb[k] = column_light[column, k] * (1.0 / math.pi)
        return True
    x, y = texels.pixel[row, 0], texels.pixel[row, 1]
    surface_place(geometry, t, weights, place, normal)
    by_key = 0.0
    if key_rgb[1] > 0.0 and dot(geometry.faces[t], key) > 0.0 and dot(normal, key) > 0.0:
        ox = np.float32(place[0] + OFF * geometry.faces[t, 0])
        oy = np.float32(place[1] + OFF * geometry.faces[t, 1])
        oz = np.float32(place[2] + OFF * geometry.faces[t, 2])
        free, _ = unblocked(tree, ox, oy, oz, beam, 1, 1, number, stack, MISS)
        by_key = dot(normal, key) if free else 0.0
    own = colour_of[row]
    for k in range(3):
        falls = lit[y, x, k] + by_key * key_rgb[k]
        rgb[k] = (emitted[own, k] + reflectance[own, k] * falls) * (1.0 / math.pi)
    return True
