"""How far a path goes to its next scatterer.

A ray is cut into bins, finer towards its low end. Half of the distances are drawn by density and
transmittance, the other half by their product with the direct sunlight, so that in twilight
paths climb out of the planet's shadow.
"""

import math

from bruneton_sky.kernels import _jacobian

from tools.twilight_fit.medium import (
    absorber_at,
    compiled,
    densities,
    distance_to,
    make_ray,
    path_to,
    y_at_top,
)

BINS = 24
# The last bin is so many powers of e wider than the first.
CLUSTERING = 4.0
SUNLIT_SHARE = 0.5


@compiled
def draw_distance(cumulative, edges, u):  # type: ignore[no-untyped-def]
    """y of the next scatterer and its probability density per unit of y."""
    share = SUNLIT_SHARE if cumulative[1, BINS - 1] > 0.0 else 0.0
    chosen, rest = (1, u / share) if u < share else (0, (u - share) / (1.0 - share))
    k, within = _draw(cumulative[chosen], rest)
    chance = (1.0 - share) * _bin(cumulative[0], k)
    if share > 0.0:
        chance += share * _bin(cumulative[1], k)
    width = edges[k + 1] - edges[k]
    return edges[k] + within * width, chance / width


@compiled
def set_edges(medium, ray, hits, edges):  # type: ignore[no-untyped-def]
    """y of the bins' edges, from the start of the ray to the ground or the top."""
    start = ray[4]
    if hits:
        _cluster(start, -math.sqrt(-ray[3]), False, edges)
        return
    end = max(math.sqrt(max(medium.top - ray[3], 0.0)), start)
    if start >= 0.0:
        _cluster(start, end, True, edges)
        return
    half = BINS // 2
    _cluster(start, 0.0, False, edges[: half + 1])
    _cluster(0.0, end, True, edges[half:])


@compiled
def _cluster(first, last, at_first, edges):  # type: ignore[no-untyped-def]
    """Edges from first to last, dense at the first or else at the last."""
    n = edges.size - 1
    whole = math.expm1(CLUSTERING)
    for k in range(n + 1):
        if at_first:
            edges[k] = first + (last - first) * math.expm1(CLUSTERING * k / n) / whole
        else:
            edges[k] = last - (last - first) * math.expm1(CLUSTERING * (n - k) / n) / whole


@compiled
def weigh_bins(medium, ray, mu_s, nu, weight, depth, edges, cumulative):  # type: ignore[no-untyped-def]
    """Cumulative shares of the bins, without and with the sunlight that reaches them.

    `depth` receives the optical depth of the whole ray. All by the midpoint rule: it only makes
    probabilities, in which nothing needs to be exact.
    """
    extinction, scattering = medium.extinction, medium.scattering
    plain, sunlit, rayleigh, mie, absorbed = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(BINS):
        y = 0.5 * (edges[k] + edges[k + 1])
        altitude = min(max(ray[3] + y * y, 0.0), medium.top)
        metres = (edges[k + 1] - edges[k]) * _jacobian(ray[2], y)
        thin, haze = densities(medium, altitude)
        layer = absorber_at(altitude, medium.absorber_altitude, medium.absorber_density)
        value = 0.0
        for c in medium.picked:
            here = extinction[0, c] * (rayleigh + 0.5 * thin * metres)
            here += extinction[1, c] * (mie + 0.5 * haze * metres)
            here += extinction[2, c] * (absorbed + 0.5 * layer * metres)
            strength = scattering[0, c] * thin + scattering[1, c] * haze
            value += weight[c] * math.exp(-here) * strength
        value *= metres
        rayleigh += thin * metres
        mie += haze * metres
        absorbed += layer * metres
        plain += value
        sunlit += value * _sunlight(medium, ray, altitude, y, mu_s, nu)
        cumulative[0, k] = plain
        cumulative[1, k] = sunlit
    for c in range(depth.size):
        depth[c] = extinction[0, c] * rayleigh + extinction[1, c] * mie
        depth[c] += extinction[2, c] * absorbed


@compiled
def _sunlight(medium, ray, altitude, y, mu_s, nu):  # type: ignore[no-untyped-def]
    """Red light's transmittance from the sun through the molecules alone; 0 in the shadow."""
    radius = medium.radius + altitude
    cosine = (ray[1] * mu_s + distance_to(ray, y) * nu) / radius
    sun = make_ray(medium.radius, altitude, min(max(cosine, -1.0), 1.0))
    if cosine < 0.0 and sun[3] <= 0.0:
        return 0.0
    path = path_to(sun, medium.top, y_at_top(medium, sun), medium.rayleigh_scale)
    return math.exp(-medium.extinction[0, medium.picked[2]] * path)


@compiled
def _draw(cumulative, u):  # type: ignore[no-untyped-def]
    """The bin that holds the share u of the total, and where in it u falls."""
    target = u * cumulative[BINS - 1]
    k = 0
    while k < BINS - 1 and cumulative[k] <= target:
        k += 1
    below = cumulative[k - 1] if k > 0 else 0.0
    size = cumulative[k] - below
    return k, (target - below) / size if size > 0.0 else 0.5


@compiled
def _bin(cumulative, k):  # type: ignore[no-untyped-def]
    """A bin's share of the total."""
    below = cumulative[k - 1] if k > 0 else 0.0
    return (cumulative[k] - below) / cumulative[BINS - 1]
