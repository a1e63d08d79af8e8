"""Distances of a traced path to its next scatterer.

A ray is cut into bins, finer toward its low end. Distances are drawn by density and
transmittance; where the sun is low, a share of them by their product with the direct sunlight,
so that in twilight paths climb out of the planet's shadow.
"""

import math

from bruneton_sky.path_kernels import jacobian, make_ray
from bruneton_sky.quadrature import FOG_TOP

from vrut_lite_lab.monte_carlo.medium import (
    absorber_at,
    compiled,
    densities,
    distance_to,
    meets_ground,
    molecules_to,
    y_at_top,
)

BINS = 16
FOG_BINS = 32
# Logarithm of the ratio of widths of the last bin to the first.
CLUSTERING = 4.0
# The sun's cosine below which distances are drawn by sunlight too.
SUNLIT_BELOW = 0.2


@compiled
def set_edges(medium, ray, edges):  # type: ignore[no-untyped-def]
    """y of the bins' edges, from the start of a ray to the ground or the top."""
    if medium.fog_scale > 0.0:
        _set_edges_in_fog(medium, ray, edges)
        return
    start = ray[4]
    if meets_ground(ray):
        _cluster(start, max(-math.sqrt(-ray[3]), start), False, edges)
        return
    end = y_at_top(medium, ray)
    if start >= 0.0:
        _cluster(start, end, True, edges)
        return
    half = BINS // 2
    _cluster(start, 0.0, False, edges[: half + 1])
    _cluster(0.0, end, True, edges[half:])


@compiled
def _set_edges_in_fog(medium, ray, edges):  # type: ignore[no-untyped-def]
    """A quarter of the bins before fog, half in it, a quarter beyond; any may be empty.

    In fog light comes from a few mean free paths away: half of its bins shrink toward the start of
    the ray, so that the first has about that length.
    """
    n = edges.size - 1
    quarter, middle = n // 4, n // 2
    hits, start = meets_ground(ray), ray[4]
    end = max(-math.sqrt(-ray[3]), start) if hits else y_at_top(medium, ray)
    reach = math.sqrt(max(FOG_TOP * medium.fog_scale - ray[3], 0.0))
    enters, leaves = min(max(-reach, start), end), min(max(reach, start), end)
    _cluster(start, enters, False, edges[: quarter + 1])
    half = 0.5 * (enters + leaves) if start < 0.0 else leaves
    inside = max(min(math.exp(-max(ray[3] + enters * enters, 0.0) / medium.fog_scale), 1.0), 1e-3)
    depth = medium.extinction[3].max() * inside * (half - enters) * jacobian(ray[2], enters)
    _cluster_so(enters, half, True, CLUSTERING + math.log1p(depth), edges[quarter : middle + 1])
    _cluster(half, leaves, False, edges[middle : n - quarter + 1])
    _cluster(leaves, end, True, edges[n - quarter :])


@compiled
def _cluster(first, last, at_first, edges):  # type: ignore[no-untyped-def]
    """Edges from first to last, dense at the first or else at the last."""
    _cluster_so(first, last, at_first, CLUSTERING, edges)


@compiled
def _cluster_so(first, last, at_first, clustering, edges):  # type: ignore[no-untyped-def]
    """The same; the last bin is exp(clustering) times as wide as the first."""
    n = edges.size - 1
    whole = math.expm1(clustering)
    for k in range(n + 1):
        if at_first:
            edges[k] = first + (last - first) * math.expm1(clustering * k / n) / whole
        else:
            edges[k] = last - (last - first) * math.expm1(clustering * (n - k) / n) / whole


@compiled
def weigh_bins(medium, ray, mu_s, nu, least_cosine, weight, depth, edges, cumulative):  # type: ignore[no-untyped-def]
    """Cumulative shares (2, bins) of the bins, without and with the sunlight that reaches them.

    The sun is taken to stand at `least_cosine` where it is lower. `depth` (C,) receives the
    optical depth of the whole ray. The midpoint rule suffices, since these are only probabilities.
    """
    extinction, scattering = medium.extinction, medium.scattering
    bins = edges.size - 1
    low_sun = min(mu_s, _sun_cosine(medium, ray, edges[bins], mu_s, nu)) < SUNLIT_BELOW
    plain, sunlit, rayleigh, mie, absorbed = 0.0, 0.0, 0.0, 0.0, 0.0
    droplets, aloft, veils = 0.0, 0.0, 0.0
    for k in range(bins):
        y = 0.5 * (edges[k] + edges[k + 1])
        altitude = min(max(ray[3] + y * y, 0.0), medium.top)
        metres = (edges[k + 1] - edges[k]) * jacobian(ray[2], y)
        thin, haze, fog, high, veil = densities(medium, altitude)
        layer = absorber_at(medium, altitude)
        value = 0.0
        for c in range(depth.size):
            here = extinction[0, c] * (rayleigh + 0.5 * thin * metres)
            here += extinction[1, c] * (mie + 0.5 * haze * metres)
            here += extinction[2, c] * (absorbed + 0.5 * layer * metres)
            here += extinction[3, c] * (droplets + 0.5 * fog * metres)
            here += extinction[4, c] * (aloft + 0.5 * high * metres)
            here += extinction[5, c] * (veils + 0.5 * veil * metres)
            strength = scattering[0, c] * thin + scattering[1, c] * haze + scattering[2, c] * fog
            strength += scattering[3, c] * high + scattering[4, c] * veil
            value += weight[c] * math.exp(-here) * strength
        value *= metres
        rayleigh += thin * metres
        mie += haze * metres
        absorbed += layer * metres
        droplets += fog * metres
        aloft += high * metres
        veils += veil * metres
        plain += value
        cumulative[0, k] = plain
        if low_sun:
            cosine = max(_sun_cosine(medium, ray, y, mu_s, nu), least_cosine)
            sunlit += value * _sunlight(medium, altitude, cosine)
        cumulative[1, k] = sunlit
    for c in range(depth.size):
        depth[c] = extinction[0, c] * rayleigh + extinction[1, c] * mie
        depth[c] += extinction[2, c] * absorbed + extinction[3, c] * droplets
        depth[c] += extinction[4, c] * aloft + extinction[5, c] * veils


@compiled
def _sun_cosine(medium, ray, y, mu_s, nu):  # type: ignore[no-untyped-def]
    """Cosine of the sun's zenith angle at a point of a ray."""
    altitude = min(max(ray[3] + y * y, 0.0), medium.top)
    cosine = (ray[1] * mu_s + distance_to(ray, y) * nu) / (medium.radius + altitude)
    return min(max(cosine, -1.0), 1.0)


@compiled
def _sunlight(medium, altitude, cosine):  # type: ignore[no-untyped-def]
    """The sun's transmittance through the thinnest colour's molecules; 0 in the shadow."""
    sun = make_ray(medium.radius, altitude, cosine)
    if meets_ground(sun):
        return 0.0
    path = molecules_to(medium, sun, medium.top, y_at_top(medium, sun))
    return math.exp(-medium.extinction[0].min() * path)


@compiled
def draw_distance(cumulative, edges, sunlit_share, u):  # type: ignore[no-untyped-def]
    """y of the next scatterer and its probability density per unit of y."""
    share = sunlit_share if cumulative[1, -1] > 0.0 else 0.0
    chosen, rest = (1, u / share) if u < share else (0, (u - share) / (1.0 - share))
    k, within = _draw(cumulative[chosen], rest)
    chance = (1.0 - share) * _bin(cumulative[0], k)
    if share > 0.0:
        chance += share * _bin(cumulative[1], k)
    width = edges[k + 1] - edges[k]
    return edges[k] + within * width, chance / width


@compiled
def _draw(cumulative, u):  # type: ignore[no-untyped-def]
    """The bin at the share u of the total, and the place of u in it."""
    target = u * cumulative[-1]
    k = 0
    while k < cumulative.size - 1 and cumulative[k] <= target:
        k += 1
    below = cumulative[k - 1] if k > 0 else 0.0
    size = cumulative[k] - below
    return k, (target - below) / size if size > 0.0 else 0.5


@compiled
def _bin(cumulative, k):  # type: ignore[no-untyped-def]
    """A bin's share of the total."""
    below = cumulative[k - 1] if k > 0 else 0.0
    return (cumulative[k] - below) / cumulative[-1]
