"""The compiled path tracer: it goes from event to event and adds the direct sun at each.

A path starts at the eye and goes from scatterer to scatterer, or to the ground; it never leaves the
air; its weight falls instead. Each event adds the direct sun (next-event estimation) through the
closed-form optical paths. All wavelengths share one path: geometry takes most of the time, and the
noise between colours stays small.
"""

# ruff: noqa: NPY002 (inside compiled code the seed is set and used where nothing else draws)

import math

import numpy as np
from bruneton_sky.path_kernels import jacobian, make_ray

from vrut_lite_lab.monte_carlo.directions import (
    draw_direction,
    lobe_axis,
    lobe_share,
    set_scattering,
    turn,
    upward,
)
from vrut_lite_lab.monte_carlo.distances import (
    BINS,
    FOG_BINS,
    draw_distance,
    set_edges,
    weigh_bins,
)
from vrut_lite_lab.monte_carlo.medium import (
    compiled,
    cosine_at,
    densities,
    dim,
    distance_to,
    dot,
    meets_ground,
    y_at_top,
)

# Russian roulette begins where a path's weight falls below this share of that after one event.
ROULETTE = 0.2
# How distances are drawn under a low sun, at the first event of a path and at the later ones: the
# share drawn by sunlight, and the least cosine of the sun that is assumed. The first event serves
# the higher orders; in twilight the glow at the horizon lights it.
FIRST_AIM, LATER_AIM = (0.55, 0.0), (0.75, -1.0)


@compiled
def trace(medium, altitudes, points, directions, sun, numbers, seed, may_land, sums):  # type: ignore[no-untyped-def]
    """Add the radiance of n paths, by order of scattering, to sums (orders, C).

    Paths start at points (n, 3) of known altitudes (n,) in directions (n, 3), all in the
    planet's frame. `numbers` (n, events, 3) are uniform; later numbers come from numba's generator,
    seeded here. With `may_land` the first event may be a reflection by the ground.
    """
    np.random.seed(seed)
    orders, count = sums.shape
    weight, scratch = np.empty(count), np.empty(count)
    bins = FOG_BINS if medium.fog_scale > 0.0 else BINS
    edges, cumulative = np.empty(bins + 1), np.empty((2, bins))
    for path in range(altitudes.size):
        point, direction, altitude = points[path].copy(), directions[path].copy(), altitudes[path]
        for c in range(count):
            weight[c] = medium.importance[c]
        event, faint = 0, 0.0
        while _goes_on(weight, faint):
            u, v, w = _three_numbers(numbers[path], event)
            altitude, on_ground = _advance(
                medium, altitude, point, direction, sun, weight, scratch, edges, cumulative, u,
                FIRST_AIM if event == 0 else LATER_AIM, may_land or event > 0,
            )  # fmt: skip
            if altitude < 0.0:
                break
            out = sums[min(event, orders - 1)]
            if on_ground:
                _reflect(medium, point, direction, sun, weight, scratch, v, w, out)
            else:
                _scatter(medium, altitude, point, direction, sun, weight, scratch, v, w, out)
            event += 1
            if event == 1:
                faint = ROULETTE * weight.max()


@compiled
def _three_numbers(numbers, event):  # type: ignore[no-untyped-def]
    if event < len(numbers):
        return numbers[event, 0], numbers[event, 1], numbers[event, 2]
    return np.random.random(), np.random.random(), np.random.random()


@compiled
def _goes_on(weight, faint):  # type: ignore[no-untyped-def]
    """Russian roulette with faint paths."""
    strongest = weight.max()
    if strongest >= faint:
        return strongest > 0.0
    chance = strongest / faint
    if np.random.random() >= chance:
        return False
    weight /= chance
    return True


@compiled
def _advance(  # type: ignore[no-untyped-def]
    medium, altitude, point, direction, sun, weight, depth, edges, cumulative, u, aim, may_land
):
    """Move the point to the next event; returns its altitude (negative: no event) and whether it is
    the ground.

    The weight is multiplied by transmittance over probability density; `_scatter` and `_reflect`
    add the event's own factor.
    """
    radius = medium.radius + altitude
    ray = make_ray(medium.radius, altitude, cosine_at(point, direction, radius))
    set_edges(medium, ray, edges)
    mu_s = cosine_at(point, sun, radius)
    weigh_bins(medium, ray, mu_s, dot(direction, sun), aim[1], weight, depth, edges, cumulative)
    ground = 0.0
    if may_land and meets_ground(ray):
        for c in range(weight.size):
            ground += weight[c] * math.exp(-depth[c]) * medium.albedo[c]
    total = cumulative[0, -1] + ground
    if total <= 0.0:
        return -1.0, False
    ground /= total
    if u < ground:
        dim(medium, ray, 0.0, edges[-1], 1.0 / ground, weight)
        _move(point, direction, distance_to(ray, edges[-1]), medium.radius)
        return 0.0, True
    y, density = draw_distance(cumulative, edges, aim[0], (u - ground) / (1.0 - ground))
    density *= (1.0 - ground) / jacobian(ray[2], y)
    here = min(max(ray[3] + y * y, 0.0), medium.top)
    dim(medium, ray, here, y, 1.0 / density, weight)
    _move(point, direction, distance_to(ray, y), medium.radius + here)
    return here, False


@compiled
def _add_sun(medium, altitude, point, sun, weight, factor, out):  # type: ignore[no-untyped-def]
    """Add the direct sun at a point, seen through the air: weight * factor * transmittance."""
    ray = make_ray(medium.radius, altitude, cosine_at(point, sun, medium.radius + altitude))
    if meets_ground(ray):
        return
    for c in range(weight.size):
        factor[c] *= weight[c]
    dim(medium, ray, medium.top, y_at_top(medium, ray), 1.0, factor)
    out += factor


@compiled
def _scatter(medium, altitude, point, direction, sun, weight, factor, v, w, out):  # type: ignore[no-untyped-def]
    """Add the sun's light scattered here, and draw the path's next direction."""
    thin, haze, fog, high = densities(medium, altitude)
    set_scattering(medium, thin, haze, fog, high, dot(direction, sun), factor)
    _add_sun(medium, altitude, point, sun, weight, factor, out)
    molecules, aerosol, droplets, aloft = 0.0, 0.0, 0.0, 0.0
    for c in range(weight.size):
        molecules += weight[c] * medium.scattering[0, c] * thin
        aerosol += weight[c] * medium.scattering[1, c] * haze
        droplets += weight[c] * medium.scattering[2, c] * fog
        aloft += weight[c] * medium.scattering[3, c] * high
    aerosol += droplets + aloft
    share = aerosol / (aerosol + molecules) if aerosol > 0.0 else 0.0
    foggy = droplets / (aerosol + molecules) if droplets > 0.0 else 0.0
    lobes = lobe_share(cosine_at(point, sun, medium.radius + altitude), foggy)
    # Directions are drawn from the phase function of the kind that scatters most.
    cumulated = medium.fog_turn if 2.0 * droplets > aerosol else medium.turn
    if 2.0 * aloft > aerosol:
        cumulated = medium.aloft_turn
    cosine, density = draw_direction(
        cumulated, share, lobes, lobe_axis(point, sun), v, w, direction
    )
    set_scattering(medium, thin, haze, fog, high, cosine, factor)
    for c in range(weight.size):
        weight[c] *= factor[c] / density


@compiled
def _reflect(medium, point, direction, sun, weight, factor, v, w, out):  # type: ignore[no-untyped-def]
    """The same at Lambertian ground, whose next direction follows the cosine."""
    cosine = cosine_at(point, sun, medium.radius)
    for c in range(weight.size):
        weight[c] *= medium.albedo[c]
        factor[c] = max(cosine, 0.0) / math.pi
    _add_sun(medium, 0.0, point, sun, weight, factor, out)
    turn(upward(point), math.sqrt(1.0 - v), w, direction)


@compiled
def _move(point, direction, distance, radius):  # type: ignore[no-untyped-def]
    """Move along the direction, to the radius of the given altitude."""
    for i in range(3):
        point[i] += distance * direction[i]
    point *= radius / math.sqrt(dot(point, point))
