"""The compiled path tracer: it goes from event to event and adds the direct sun at each.

A path starts at the eye and goes from scatterer to scatterer, or to the ground; it never leaves the
air; its weight falls instead. Each event adds the direct sun (next-event estimation) through the
closed-form optical paths. All wavelengths share one path: geometry takes most of the time, and the
noise between colours stays small.

Polarised light is traced backward too. A path carries, for each measured Stokes parameter, the row
(3,) by which light arriving at its end contributes to it: I, Q and U about an axis that moves with
the path. A scattering turns the axis into its plane and multiplies the rows by its matrix. Rows are
kept relative to the first row's first element, which is in the weight. Light that does not polarise
is the case of phase functions alone: rows stay as they are.
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
    """Add the light of n paths, by order of scattering, to sums (orders, 1 or 3, C): I, Q, U.

    Paths start at points (n, 3) of known altitudes (n,) in directions (n, 3), all in the
    planet's frame. `numbers` (n, events, 3) are uniform; later numbers come from numba's generator,
    seeded here. With `may_land` the first event may be a reflection by the ground. Q is light that
    vibrates in the plane of direction and zenith minus light across, U the same 45 degrees
    clockwise of the zenith, as one sees it.
    """
    np.random.seed(seed)
    orders, parameters, count = sums.shape
    weight, scratch, matrix = np.empty(count), np.empty(count), np.zeros((4, count))
    rows, axis = np.empty((parameters, 3, count)), np.empty(3)
    bins = FOG_BINS if medium.fog_scale > 0.0 else BINS
    edges, cumulative = np.empty(bins + 1), np.empty((2, bins))
    for path in range(altitudes.size):
        point, direction, altitude = points[path].copy(), directions[path].copy(), altitudes[path]
        weight[:] = medium.importance
        for s in range(parameters):
            for k in range(3):
                rows[s, k] = 1.0 if s == k else 0.0
        _set_axis(point, direction, axis)
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
                _reflect(medium, point, direction, sun, weight, scratch, rows, axis, v, w, out)
            else:
                _scatter(
                    medium, altitude, point, direction, sun, weight, scratch, matrix, rows, axis,
                    v, w, out,
                )  # fmt: skip
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
def _sunlight(medium, altitude, point, sun, weight, light):  # type: ignore[no-untyped-def]
    """Whether the direct sun reaches a point; sets light (C,) to weight * its transmittance."""
    ray = make_ray(medium.radius, altitude, cosine_at(point, sun, medium.radius + altitude))
    if meets_ground(ray):
        return False
    light[:] = weight
    dim(medium, ray, medium.top, y_at_top(medium, ray), 1.0, light)
    return True


@compiled
def _scatter(  # type: ignore[no-untyped-def]
    medium, altitude, point, direction, sun, weight, light, matrix, rows, axis, v, w, out
):
    """Add the sun's light scattered here, and draw the path's next direction."""
    density = densities(medium, altitude)
    if _sunlight(medium, altitude, point, sun, weight, light):
        set_scattering(medium, density, dot(direction, sun), matrix)
        _add_scattered(medium, direction, sun, light, matrix, rows, axis, out)
    molecules, aerosol, droplets, aloft, veil = 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(weight.size):
        molecules += weight[c] * medium.scattering[0, c] * density[0]
        aerosol += weight[c] * medium.scattering[1, c] * density[1]
        droplets += weight[c] * medium.scattering[2, c] * density[2]
        aloft += weight[c] * medium.scattering[3, c] * density[3]
        veil += weight[c] * medium.scattering[4, c] * density[4]
    aerosol += droplets + aloft + veil
    share = aerosol / (aerosol + molecules) if aerosol > 0.0 else 0.0
    foggy = droplets / (aerosol + molecules) if droplets > 0.0 else 0.0
    lobes = lobe_share(cosine_at(point, sun, medium.radius + altitude), foggy)
    # Directions are drawn from the phase function of the kind that scatters most.
    cumulated = medium.fog_turn if 2.0 * droplets > aerosol else medium.turn
    if 2.0 * aloft > aerosol:
        cumulated = medium.aloft_turn
    elif 2.0 * veil > aerosol:
        cumulated = medium.veil_turn
    old = (direction[0], direction[1], direction[2])
    cosine, chance = draw_direction(cumulated, share, lobes, lobe_axis(point, sun), v, w, direction)
    set_scattering(medium, density, cosine, matrix)
    for c in range(weight.size):
        weight[c] *= matrix[0, c] / chance
    if medium.polarises:
        _polarise(old, direction, weight, matrix, rows, axis)


@compiled
def _add_scattered(medium, direction, sun, light, matrix, rows, axis, out):  # type: ignore[no-untyped-def]
    """Add sunlight (C,), which is not polarised, after a scattering into the path."""
    cos_2, sin_2 = 1.0, 0.0
    if medium.polarises:
        cos_2, sin_2, _ = _into_plane(direction, sun, axis)
    for s in range(rows.shape[0]):
        for c in range(light.size):
            seen = rows[s, 0, c] * matrix[0, c]
            seen += (rows[s, 1, c] * cos_2 + rows[s, 2, c] * sin_2) * matrix[1, c]
            out[s, c] += light[c] * seen


@compiled
def _polarise(old, direction, weight, matrix, rows, axis):  # type: ignore[no-untyped-def]
    """Multiply the rows by a scattering matrix from the new direction into the old one."""
    cos_2, sin_2, normal = _into_plane(old, direction, axis)
    for c in range(weight.size):
        p11 = matrix[0, c]
        p12, p22, p33 = matrix[1, c] / p11, matrix[2, c] / p11, matrix[3, c] / p11
        first = 0.0
        for s in range(rows.shape[0]):
            i, q, u = rows[s, 0, c], rows[s, 1, c], rows[s, 2, c]
            q, u = q * cos_2 + u * sin_2, u * cos_2 - q * sin_2
            if s == 0:
                first = i + q * p12
                weight[c] *= first
            rows[s, 0, c] = (i + q * p12) / first
            rows[s, 1, c] = (i * p12 + q * p22) / first
            rows[s, 2, c] = u * p33 / first
    _set_cross(normal, direction, axis)


@compiled
def _into_plane(direction, other, axis):  # type: ignore[no-untyped-def]
    """Cosine and sine of twice the angle from the axis to the plane of both directions; its normal.

    The angle turns clockwise about the direction. Where the directions are parallel, any plane
    serves: that of the axis.
    """
    normal, inside, across = np.empty(3), np.empty(3), np.empty(3)
    _set_cross(direction, other, normal)
    length = math.sqrt(dot(normal, normal))
    if length < 1e-12:
        _set_cross(direction, axis, normal)
        return 1.0, 0.0, normal
    normal /= length
    _set_cross(normal, direction, inside)
    _set_cross(direction, axis, across)
    cosine, sine = dot(inside, axis), dot(inside, across)
    return cosine * cosine - sine * sine, 2.0 * sine * cosine, normal


@compiled
def _set_axis(point, direction, axis):  # type: ignore[no-untyped-def]
    """Set the axis of Q and U: across the direction, toward the zenith.

    Looking up, it is that of a view whose azimuth is 0.
    """
    up = upward(point)
    cosine = dot(up, direction)
    for k in range(3):
        axis[k] = up[k] - cosine * direction[k]
    length = math.sqrt(dot(axis, axis))
    if length < 1e-9:
        axis[0], axis[1], axis[2] = -1.0, 0.0, 0.0
        return
    axis /= length


@compiled
def _set_cross(a, b, out):  # type: ignore[no-untyped-def]
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@compiled
def _reflect(medium, point, direction, sun, weight, light, rows, axis, v, w, out):  # type: ignore[no-untyped-def]
    """The same at Lambertian ground: the next direction follows the cosine, polarisation ends."""
    cosine = cosine_at(point, sun, medium.radius)
    for c in range(weight.size):
        weight[c] *= medium.albedo[c]
    if cosine > 0.0 and _sunlight(medium, 0.0, point, sun, weight, light):
        for s in range(rows.shape[0]):
            for c in range(weight.size):
                out[s, c] += light[c] * rows[s, 0, c] * cosine / math.pi
    rows[:, 1:] = 0.0
    turn(upward(point), math.sqrt(1.0 - v), w, direction)
    _set_axis(point, direction, axis)


@compiled
def _move(point, direction, distance, radius):  # type: ignore[no-untyped-def]
    """Move along the direction, to the radius of the given altitude."""
    for i in range(3):
        point[i] += distance * direction[i]
    point *= radius / math.sqrt(dot(point, point))
