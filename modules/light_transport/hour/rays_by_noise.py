"""Rays of a still's points where their noise would be seen: a few everywhere, then the others.

What a few rays leave is smoothed over neighbours. Where a point has few of them, as in corners and
on thin things, or where few rays bring most of the light, all its rays are traced.
"""

import numpy as np
from numpy.typing import NDArray

from light_transport.bake import Bake
from light_transport.giving_up import CancelCheck
from light_transport.hour.free_points import PointLight, light_at
from light_transport.hour.illumination import Illumination
from light_transport.hour.view_reflections import SeenPoints
from light_transport.hour.view_smoothing import PointGrid, is_noisy, noise_shares
from light_transport.rays.ray_starts import OFF
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import Float32Array

# A few rays are so many times fewer than all.
_FEWER = 3
# Noise that stays after smoothing over next neighbours alone and is not seen, as a share of the
# light; random rays would leave it, these leave less.
UNSEEN_NOISE = 0.03
# Of single points, as `is_noisy` has it.
_LARGEST_NOISE = 0.1
# Where smoothing would leave more, as in corners, points trace so many times more rays: neighbours
# in a picture lie on two faces by turns there, and noise looks like teeth. At most this share.
_SEEN_NOISE, _TIMES, _MOST_AGAIN = 0.08, 4, 0.06
# Where more points than this share need them, all have all: their rays go on where they ended.
_MOST = 0.75


def light_by_noise(
    bake: Bake,
    hour: Illumination,
    points: SeenPoints,
    seen: NDArray[np.intp],
    grid: PointGrid,
    rays: int,
    threads: int,
    go_on: CancelCheck,
) -> PointLight:
    """Light of an hour at the points that are `seen`, by their numbers, by at most so many rays."""
    surfaces, few = bake.surfaces, max(1, rays // _FEWER)
    places_m = (points.place[seen] + OFF * points.face[seen]) * surfaces.radius_m
    places_m += surfaces.centre_m
    normals = points.normal[seen]
    found = light_at(bake, places_m, normals, hour, few, threads, go_on)
    noisy = is_noisy(grid, *_on(grid, surfaces.radius_m, found, seen), UNSEEN_NOISE, _LARGEST_NOISE)
    more = np.flatnonzero(noisy.ravel()[seen])
    if rays <= few or not len(more):
        return found
    if len(more) > _MOST * len(seen):
        more = np.arange(len(seen))
    again = light_at(bake, places_m[more], normals[more], hour, rays - few, threads, go_on, few)
    _add(found, more, again, few / rays)
    left = noise_shares(grid, *_on(grid, surfaces.radius_m, found, seen))[1].ravel()[seen[more]]
    noisiest = np.argsort(-left, kind="stable")[: int(_MOST_AGAIN * len(seen))]
    more = np.sort(more[noisiest[left[noisiest] > _SEEN_NOISE]])
    if len(more):
        further = (_TIMES - 1) * rays
        again = light_at(bake, places_m[more], normals[more], hour, further, threads, go_on, rays)
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
