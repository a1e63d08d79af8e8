"""Traces light at points off the texel grid, by rays that end on the map's patches.

A still's points first have a few rays each, whose noise is smoothed over neighbours. All rays are
traced where a point has few neighbours, as in corners and on thin things, or where few rays bring
most of the light.
"""

from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.giving_up import CancelCheck, always
from light_transport.hour.gather import patches_gathered, sky_gathered
from light_transport.hour.illumination import HourLight
from light_transport.rays.ray_scene import RayScene
from light_transport.rays.ray_starts import OFF, Probes
from light_transport.rays.ray_table import columns_and_rays, empty_rows, slice_of, with_rays
from light_transport.rays.sky_nodes import NODES
from light_transport.view.view_reflections import ViewPoints
from light_transport.view.view_smoothing import PointGrid, is_noisy, noise_shares
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import Float32Array, FloatArray

_BLOCK = 1024
# Ratio of all rays to the first few.
_FEWER = 3
# Noise that is not seen after smoothing over next neighbours alone, as a share of the light, if
# rays were random; these leave less.
UNSEEN_NOISE = 0.03
# Noise of single points, `largest` of `is_noisy`.
_LARGEST_NOISE = 0.1
# Noise after smoothing above which points trace _TIMES more rays, as in corners, where neighbours
# lie on two faces by turns and noise looks like teeth; maximum share of such points.
_SEEN_NOISE, _TIMES, _MOST_AGAIN = 0.08, 4, 0.06
# Share of noisy points above which all points have all rays, which continue the first few.
_MOST = 0.75


class PointLight(NamedTuple):
    """Light at points (P).

    Attributes:
        irradiance_rgb: (P, 3), W m^-2.
        sky: (P,), luminance of the sky's part.
        error: (P,), rms error of the luminance, if rays were random.
        room_m: (P,), harmonic mean distance of surfaces in view, infinite under open sky.
        free: (P,), share of the rays that meet no backs of bodies: little inside them.
    """

    irradiance_rgb: Float32Array
    sky: Float32Array
    error: Float32Array
    room_m: Float32Array
    free: Float32Array


def light_at(
    scene: RayScene,
    places_m: FloatArray,
    normals: FloatArray,
    light: HourLight,
    rays: int,
    threads: int = 1,
    go_on: CancelCheck = always,
    first_ray: int = 0,
) -> PointLight:
    """Light of an hour at `places_m` (P, 3) on planes with unit `normals` (P, 3), world axes.

    The key light's own is not in it. Light does not depend on the number of threads. Rays are
    numbered from `first_ray`: other numbers are other rays.

    Raises:
        GivenUp: by `go_on`.
    """
    assert scene.patches is not None
    surfaces, texels = scene.surfaces, len(scene.texels.pixel)
    places = scene.in_radii(places_m)
    probes = Probes(places.astype(np.float32), normals.astype(np.float32))
    # Rows of these points stand where those of the scene's probes do.
    columns, own = scene.patches.column_of, len(scene.receivers.probes.place)
    nothing = np.full(len(places), NODES + len(scene.patches.area), np.int32)
    after = columns[NODES + texels + own :]
    column_of = np.concatenate([columns[: NODES + texels], nothing, after])
    receivers = scene.receivers._replace(probes=probes)
    column_light = light.column_light
    squares = np.zeros_like(column_light)
    squares[:, 0] = luminance(column_light[:, :3]) ** 2
    rows = empty_rows(texels, len(places))
    mean, square = np.empty((2, len(places), 4), np.float32)
    room, free, error = np.empty((3, len(places)), np.float32)

    def block(first: int) -> None:
        go_on()
        last = min(first + _BLOCK, len(places))
        here = slice_of(rows, first, last)
        # No point in view lies inside a body: backs belong to sheets, and hide surfaces behind.
        found = with_rays(scene.tree, receivers, here, column_of, first_ray, rays, NODES + texels)
        for means, of in ((mean[first:last], column_light), (square[first:last], squares)):
            sky_gathered(found, of, 0, last - first, means)
            patches_gathered(found, of, 0, last - first, means)
        spread = np.maximum(square[first:last, 0] - luminance(mean[first:last, :3]) ** 2, 0.0)
        error[first:last] = np.sqrt(spread / np.maximum(found.valid, 1))
        with np.errstate(divide="ignore", invalid="ignore"):
            room[first:last] = found.valid / found.nearness * np.float32(surfaces.radius_m)
        column, number = columns_and_rays(found.entry)
        dark = np.append(np.where(column == nothing[0], number, 0), 0)
        free[first:last] = 1.0 - np.add.reduceat(dark, found.start[:-1]) / np.float32(rays)

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(block, range(0, len(places), _BLOCK)))
    return PointLight(mean[:, :3], mean[:, 3], error, room, free)


def light_by_noise(
    scene: RayScene,
    light: HourLight,
    points: ViewPoints,
    seen: NDArray[np.intp],
    grid: PointGrid,
    rays: int,
    threads: int,
    go_on: CancelCheck,
) -> PointLight:
    """Light of an hour at the points that are `seen`, by their numbers, by at most so many rays."""
    surfaces, few = scene.surfaces, max(1, rays // _FEWER)
    places_m = (points.place[seen] + OFF * points.face[seen]) * surfaces.radius_m
    places_m += surfaces.centre_m
    normals = points.normal[seen]
    found = light_at(scene, places_m, normals, light, few, threads, go_on)
    noisy = is_noisy(grid, *_on(grid, surfaces.radius_m, found, seen), UNSEEN_NOISE, _LARGEST_NOISE)
    more = np.flatnonzero(noisy.ravel()[seen])
    if rays <= few or not len(more):
        return found
    if len(more) > _MOST * len(seen):
        more = np.arange(len(seen))
    again = light_at(scene, places_m[more], normals[more], light, rays - few, threads, go_on, few)
    _add(found, more, again, few / rays)
    left = noise_shares(grid, *_on(grid, surfaces.radius_m, found, seen))[1].ravel()[seen[more]]
    noisiest = np.argsort(-left, kind="stable")[: int(_MOST_AGAIN * len(seen))]
    more = np.sort(more[noisiest[left[noisiest] > _SEEN_NOISE]])
    if len(more):
        further = (_TIMES - 1) * rays
        again = light_at(scene, places_m[more], normals[more], light, further, threads, go_on, rays)
        _add(found, more, again, 1.0 / _TIMES)
    return found


def _on(
    grid: PointGrid, radius_m: float, found: PointLight, seen: NDArray[np.intp]
) -> tuple[Float32Array, Float32Array, Float32Array]:
    """Luminance, room in radii and error (H, W) of the points that are seen."""
    light = grid.filled(luminance(found.irradiance_rgb), seen)
    return light, grid.filled(found.room_m / radius_m, seen), grid.filled(found.error, seen)


def _add(found: PointLight, more: NDArray[np.intp], again: PointLight, share: float) -> None:
    """Mix light of further rays into that of some points, whose rays so far have this share."""
    part = np.float32(share)
    rest = np.float32(1.0) - part
    for whole, own in (
        (found.irradiance_rgb, again.irradiance_rgb),
        (found.sky, again.sky),
        (found.free, again.free),
    ):
        whole[more] = part * whole[more] + rest * own
    found.error[more] = np.hypot(part * found.error[more], rest * again.error)
    with np.errstate(divide="ignore"):
        found.room_m[more] = 1.0 / (part / found.room_m[more] + rest / again.room_m)
