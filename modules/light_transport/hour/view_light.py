"""Light for the pixels of a finished still, by rays of their own (a final gather).

A map's texel is wide: what stands out a little darkens a strip of wall that is narrower. Points
that pixels see have their own rays, which end on the map's patches.
"""

from typing import NamedTuple

import numpy as np

from light_transport.bake import Bake
from light_transport.giving_up import GoOn
from light_transport.hour.free_points import light_at
from light_transport.hour.hour import Hour
from light_transport.hour.view_reflections import SeenPoints, lobe_light
from light_transport.kernels import dot, kernel
from light_transport.rays.ray_starts import OFF
from light_transport.rays.ray_table import met_row
from light_transport.rays.trace import MISS, nearest_along
from light_transport.rays.tree import STACK
from light_transport.surfaces.map_texels import NOBODY, surface_place
from vrut_lite.daylight.camera import MoveCamera, pixel_rays
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.numeric_types import Float32Array, FloatArray

# Points of which fewer rays count lie inside bodies, where no eye looks.
_LEAST_FREE = 0.4
# A ray into a lobe for so many that light the surface.
_RAYS_A_LOBE_RAY = 4
# Noise is smoothed over so many points to each side, then over so many that lie farther apart
# (Dammertz et al. 2010, "Edge-avoiding A-trous wavelet transform"); light changes slowly where
# there is room, and what differs by more than its noise is no noise.
_REACH, _APART = 2, (1, 2, 4)
# Mean room tells little of what is near: farther points count within less of it.
_SHARE_OF_ROOM = (0.3, 0.03, 0.03)
# Points differ by so many times the noise about them. Where that is a large share of the light, a
# few rays through a window bring most of it: room alone decides.
_NOISES, _AROUND, _LARGE_SHARE = 1.25, 5, 0.15


class ViewLight(NamedTuple):
    """Light and planes (rows, columns, 4), and what lobes show (2, rows, columns, 4), as
    `ViewLightChanged` has them."""

    light: Float32Array
    plane: Float32Array
    mirrored: Float32Array


def edge_for(size_px: tuple[int, int], points: int) -> int:
    """Edge of squares such that a picture has about so many."""
    return max(1, int(np.ceil(np.sqrt(size_px[0] * size_px[1] / points))))


def view_light(
    bake: Bake,
    hour: Hour,
    camera: MoveCamera,
    size_px: tuple[int, int],
    edge_px: int,
    rays: int,
    threads: int,
    go_on: GoOn,
) -> ViewLight:
    """Light of an hour on what the middles of squares of `edge_px` pixels see.

    Args:
        bake: the scene's rays, whose patches the new rays end on.
        hour: the light of the sky and the patches.
        camera: metres, in the scene's axes; `size_px` is its picture's (width, height).
        rays: of each point.
        threads: that trace them; the result does not depend on it.

    Returns:
        Light as a light map's texel has it (irradiance without the sun's own in W m^-2, and the
        share of the open sky's), and each point's plane: its face normal and its distance from the
        eye in metres. Where no surface is seen both are 0. And what a coat or metal mirrors there,
        see `LobeLight`.

    Raises:
        GivenUp: by `go_on`.
    """
    columns, rows = (-(-edge // edge_px) for edge in size_px)
    y, x = np.indices((rows, columns)).reshape(2, -1)
    middle = 0.5 * (edge_px - 1)
    towards = pixel_rays(camera, size_px, x * edge_px + middle, y * edge_px + middle)
    radius_m, centre_m = bake.surfaces.radius_m, bake.surfaces.centre_m
    eye_m = np.asarray(camera.eye_m)
    eye = (eye_m - centre_m) / radius_m
    points = _seen(bake, eye, towards)
    place, normal, face = points.place, points.normal, points.face
    seen = np.flatnonzero(face.any(axis=1))
    off = (place[seen] + OFF * face[seen]) * radius_m + centre_m
    found = light_at(bake, off, normal[seen], hour, rays, threads, go_on)
    seen, kept = seen[found.free >= _LEAST_FREE], found.free >= _LEAST_FREE
    light = np.zeros((len(towards), 4), np.float32)
    light[seen, :3] = found.irradiance_rgb[kept]
    open_sky = luminance(evaluate_irradiance(hour.open_sky, normal[seen]))
    light[seen, 3] = np.clip(found.sky[kept] / np.maximum(open_sky, 1e-30), 0.0, 1.0)
    distance_m = np.zeros((len(towards), 1))
    distance_m[seen, 0] = np.einsum("pi,pi->p", face[seen], place[seen] - eye) * radius_m
    shown = np.zeros((len(towards), 1), bool)
    shown[seen] = True
    plane = np.where(shown, np.concatenate([face, distance_m], axis=1), 0.0).astype(np.float32)
    go_on()
    mirrored = lobe_light(bake, hour, points, max(1, rays // _RAYS_A_LOBE_RAY), threads, go_on)
    room, error = np.zeros((2, len(towards)), np.float32)
    room[seen], error[seen] = found.room_m[kept] / radius_m, found.error[kept]
    shape = (rows, columns)
    planes = plane.reshape(*shape, 4)
    places = (place - eye).astype(np.float32).reshape(*shape, 3)

    def smooth(values: Float32Array, room: Float32Array, error: Float32Array) -> Float32Array:
        values, near = values.reshape(*shape, 4), room.reshape(shape)
        noise2 = _noise2(values, error.reshape(shape))
        for apart, share in zip(_APART, _SHARE_OF_ROOM, strict=True):
            go_on()
            values = _smoothed(values, planes, places, near, noise2, apart, share)
        return values

    lobes = [
        smooth(radiance, mirrored.room, noise)
        for radiance, noise in zip(mirrored.radiance, mirrored.error, strict=True)
    ]
    return ViewLight(smooth(light, room, error), planes, np.stack(lobes))


def _noise2(values: Float32Array, error: Float32Array) -> Float32Array:
    """The square of what noise may be (rows, columns), by what rays leave around a point."""
    noise2 = _mean_about(error * error)
    mean = _mean_about(luminance(values[..., :3]))
    share2 = noise2 / np.maximum(mean**2, np.float32(1e-30)) / _LARGE_SHARE**2
    return np.asarray(noise2 * (_NOISES**2 * (1.0 + share2**2)), np.float32)


def _seen(bake: Bake, eye: FloatArray, towards: FloatArray) -> SeenPoints:
    """Where rays from the eye meet surfaces; normals are of the side that is seen."""
    count = len(towards)
    row = np.full(count, NOBODY, np.int32)
    place, normal, face = np.zeros((3, count, 3))
    points = SeenPoints(row, place, normal, face, towards)
    _find(bake.tree, bake.receivers, eye, points)
    return points


def _mean_about(values: FloatArray | Float32Array) -> FloatArray:
    """Of numbers (H, W) and their neighbours, mirrored at the rim; scipy takes 0.4 s to import."""
    mean: FloatArray = np.asarray(values)
    for _ in range(2):
        rows = np.pad(mean, ((_AROUND // 2,) * 2, (0, 0)), mode="symmetric")
        mean = np.asarray(sum(rows[k : k + len(mean)] for k in range(_AROUND))).T / _AROUND
    return mean


@kernel
def _find(tree, receivers, eye, points):  # type: ignore[no-untyped-def]
    geometry, texels, probes, groups = receivers
    row, places, normals, faces, towards = points
    first_group = len(texels.pixel) + len(probes.place)
    weights = np.empty(3)
    stack, far_stack = np.empty(STACK, np.int32), np.empty(STACK, np.float32)
    for i in range(len(towards)):
        d = towards[i]
        _, hit, u, v = nearest_along(tree, eye, d, i, stack, far_stack)
        if hit == MISS:
            continue
        t = tree.order[hit]
        weights[0], weights[1], weights[2] = 1.0 - u - v, u, v
        surface_place(geometry, t, weights, places[i], normals[i])
        row[i] = met_row(geometry, texels, groups, first_group, t, u, v, places[i], d)
        side = 1.0 if dot(geometry.faces[t], d) < 0.0 else -1.0
        alike = 1.0 if dot(geometry.faces[t], normals[i]) > 0.0 else -1.0
        for k in range(3):
            faces[i, k] = side * geometry.faces[t, k]
            normals[i, k] *= side * alike


@kernel
def _smoothed(light, plane, place, room, noise2, apart, share):  # type: ignore[no-untyped-def]
    """Means of light (H, W, 4) over neighbours on one plane, by room and squared noise (H, W)."""
    height, width = room.shape
    out = np.zeros_like(light)
    for y in range(height):
        for x in range(width):
            total = np.float32(0.0)
            for i in range(-_REACH, _REACH + 1):
                for j in range(-_REACH, _REACH + 1):
                    r, c = y + i * apart, x + j * apart
                    if r < 0 or c < 0 or r >= height or c >= width:
                        continue
                    alike, away2, off = np.float32(0.0), np.float32(0.0), np.float32(0.0)
                    for k in range(3):
                        step = place[r, c, k] - place[y, x, k]
                        alike += plane[r, c, k] * plane[y, x, k]
                        away2 += step * step
                        off += step * plane[y, x, k]
                    away = np.sqrt(away2)
                    if alike < np.float32(0.9) or abs(off) > np.float32(0.1) * away:
                        continue
                    reach = np.float32(share) * min(room[y, x], room[r, c])
                    weight = min(np.float32(1.0), reach / max(away, np.float32(1e-9)))
                    apart_by = np.float32(0.2126) * (light[r, c, 0] - light[y, x, 0])
                    apart_by += np.float32(0.7152) * (light[r, c, 1] - light[y, x, 1])
                    apart_by += np.float32(0.0722) * (light[r, c, 2] - light[y, x, 2])
                    both = noise2[r, c] + noise2[y, x]
                    same = np.float32(1.0) - apart_by**2 / max(both, np.float32(1e-30))
                    weight *= weight * max(same, np.float32(0.0))
                    total += weight
                    for k in range(4):
                        out[y, x, k] += weight * light[r, c, k]
            if total > 0.0:
                for k in range(4):
                    out[y, x, k] /= total
    return out
