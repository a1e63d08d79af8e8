"""Rays of a still's points where their noise would be seen: a few everywhere, then the others.

What a few rays leave is smoothed over neighbours. Where a point has few of them, as in corners and
on thin things, or where few rays bring most of the light, all its rays are traced.
"""

import numpy as np
from numpy.typing import NDArray

from light_transport.bake import Bake
from light_transport.giving_up import GoOn
from light_transport.hour.free_points import PointLight, light_at
from light_transport.hour.hour import Hour
from light_transport.hour.view_reflections import SeenPoints
from light_transport.hour.view_smoothing import PointGrid, is_noisy
from light_transport.rays.ray_starts import OFF
from vrut_lite.geometry.colour import luminance

# A few rays are so many times fewer than all.
_FEWER = 3
# Noise that stays after smoothing over next neighbours alone and is not seen, as a share of the
# light; random rays would leave it, these leave less.
UNSEEN_NOISE = 0.03
# Of single points, as `is_noisy` has it.
_LARGEST_NOISE = 0.1
# Where more points than this share need them, all have all: their rays go on where they ended.
_MOST = 0.75


def light_by_noise(
    bake: Bake,
    hour: Hour,
    points: SeenPoints,
    seen: NDArray[np.intp],
    grid: PointGrid,
    rays: int,
    threads: int,
    go_on: GoOn,
) -> PointLight:
    """Light of an hour at the points that are `seen`, by their numbers, by at most so many rays."""
    surfaces, few = bake.surfaces, max(1, rays // _FEWER)
    places_m = (points.place[seen] + OFF * points.face[seen]) * surfaces.radius_m
    places_m += surfaces.centre_m
    normals = points.normal[seen]
    found = light_at(bake, places_m, normals, hour, few, threads, go_on)
    room = grid.filled(found.room_m / surfaces.radius_m, seen)
    light, error = (grid.filled(of, seen) for of in (luminance(found.irradiance_rgb), found.error))
    noisy = is_noisy(grid, light, room, error, UNSEEN_NOISE, _LARGEST_NOISE)
    more = np.flatnonzero(noisy.ravel()[seen])
    if rays <= few or not len(more):
        return found
    if len(more) > _MOST * len(seen):
        more = np.arange(len(seen))
    places_m, normals = places_m[more], normals[more]
    again = light_at(bake, places_m, normals, hour, rays - few, threads, go_on, first_ray=few)
    part = np.float32(few / rays)
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
    return found
