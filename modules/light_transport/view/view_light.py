"""Computes light for the pixels of a finished still by their own rays (final gather).

A ledge darkens a strip of wall that is narrower than a map's texel. Points that pixels see have
their own rays, which end on the map's patches.
"""

from typing import NamedTuple

import numpy as np

from light_transport.giving_up import CancelCheck
from light_transport.hour.illumination import HourLight, Illumination
from light_transport.kernels import dot, kernel
from light_transport.rays.map_texels import NOBODY, surface_place
from light_transport.rays.ray_scene import RayScene
from light_transport.rays.ray_table import met_row
from light_transport.rays.trace import MISS, nearest_along
from light_transport.rays.tree import STACK
from light_transport.view.point_light import PointLight, light_by_noise
from light_transport.view.view_reflections import LobeLight, ViewPoints, lobe_light
from light_transport.view.view_smoothing import PointGrid, is_noisy, smoothed
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.camera import MoveCamera, pixel_rays
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

# Minimum share of rays that count; points with fewer lie inside bodies, where no eye looks.
_LEAST_FREE = 0.4
# Ratio of rays that light the surface to rays into a lobe.
_RAYS_A_LOBE_RAY = 4
# `unseen` and `largest` of `is_noisy` for reflections in coats, a small share of the light.
_UNSEEN_IN_COATS, _LARGEST_IN_COATS = 0.06, 0.5


class ViewLight(NamedTuple):
    """Light and planes (rows, columns, 4), and what lobes show (2, rows, columns, 4), as
    `ViewLightChanged` has them."""

    light: Float32Array
    plane: Float32Array
    mirrored: Float32Array


def view_light(
    scene: RayScene,
    hour: Illumination,
    lit: HourLight,
    camera: MoveCamera,
    size_px: tuple[int, int],
    edge_px: int,
    rays: int,
    threads: int,
    go_on: CancelCheck,
) -> ViewLight:
    """Light of an hour on what the middles of squares of `edge_px` pixels see.

    Args:
        scene: its rays, whose patches the new rays end on.
        hour: the light of the sky.
        lit: `hour_light` of both.
        camera: metres, in the scene's axes; `size_px` is its picture's (width, height).
        rays: of each point at most, see `light_by_noise`.
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
    radius_m, centre_m = scene.surfaces.radius_m, scene.surfaces.centre_m
    eye_m = np.asarray(camera.eye_m)
    eye = (eye_m - centre_m) / radius_m
    points = _seen(scene, eye, towards)
    place, normal, face = points.place, points.normal, points.face
    seen = np.flatnonzero(face.any(axis=1))
    shape = (rows, columns)
    distance_m = np.zeros((len(towards), 1))
    distance_m[seen, 0] = np.einsum("pi,pi->p", face[seen], place[seen] - eye) * radius_m
    plane = np.concatenate([face, distance_m], axis=1).astype(np.float32).reshape(*shape, 4)
    grid = PointGrid(plane, (place - eye).astype(np.float32).reshape(*shape, 3))
    found = light_by_noise(scene, lit, points, seen, grid, rays, threads, go_on)
    kept = found.free >= _LEAST_FREE
    plane.reshape(-1, 4)[seen[~kept]] = 0.0
    found, seen = PointLight(*(each[kept] for each in found)), seen[kept]
    light = np.zeros((len(towards), 4), np.float32)
    light[seen, :3] = found.irradiance_rgb
    open_sky = luminance(evaluate_irradiance(hour.open_sky, normal[seen]))
    light[seen, 3] = np.clip(found.sky / np.maximum(open_sky, 1e-30), 0.0, 1.0)
    go_on()

    def noisy(found: LobeLight) -> BoolArray:
        """By the lobe that is the same from everywhere."""
        mirrored = luminance(found.radiance[0, :, :3]).astype(np.float32).reshape(shape)
        room, error = found.room.reshape(shape), found.error[0].reshape(shape)
        return is_noisy(grid, mirrored, room, error, _UNSEEN_IN_COATS, _LARGEST_IN_COATS).ravel()

    lobe_rays = max(1, rays // _RAYS_A_LOBE_RAY)
    mirrored = lobe_light(scene, hour, lit, points, lobe_rays, threads, go_on, noisy)
    near = mirrored.room.reshape(shape)
    lobes = [
        smoothed(radiance.reshape(*shape, 4), grid, near, error.reshape(shape), go_on)
        for radiance, error in zip(mirrored.radiance, mirrored.error, strict=True)
    ]
    room, error = grid.filled(found.room_m / radius_m, seen), grid.filled(found.error, seen)
    return ViewLight(
        smoothed(light.reshape(*shape, 4), grid, room, error, go_on), plane, np.stack(lobes)
    )


def _seen(scene: RayScene, eye: FloatArray, towards: FloatArray) -> ViewPoints:
    """Where rays from the eye meet surfaces; normals are of the side that is seen."""
    count = len(towards)
    row = np.full(count, NOBODY, np.int32)
    place, normal, face = np.zeros((3, count, 3))
    points = ViewPoints(row, place, normal, face, towards)
    _find(scene.tree, scene.receivers, eye, points)
    return points


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
