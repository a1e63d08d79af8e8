"""The rule "GL-y-exp" compiled: one ray at a time, float64, parameters as arguments.

The formulas are those of `quadrature`, which explains them, along the rays of `path_kernels`.

Importing this module imports numba: do it only where the first ray is traced.
"""

import math

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.optical_path import TENT
from bruneton_sky.path_kernels import (
    compiled,
    exponential_layers_path,
    exponential_path,
    jacobian,
    layered_path,
    layers_density,
    make_ray,
)
from bruneton_sky.quadrature import CLUSTERING, HAZE_DEPTH, break_levels_m, unit_nodes
from vrut_lite.numeric_types import FloatArray

_TENT = np.array(TENT)


def fast_scattered_without_phase(
    atmosphere: Atmosphere,
    altitude_m: float,
    mu: FloatArray,
    mu_s: float,
    nu: FloatArray,
    samples: int = 12,
) -> tuple[FloatArray, FloatArray]:
    """The compiled twin of `scattered_without_phase` for one observer and sun.

    Args:
        atmosphere: C wavelengths.
        altitude_m: of the observer, inside the atmosphere.
        mu, nu: view cosines (n,), in [-1, 1].
        mu_s: cosine of the sun's zenith angle.
        samples: nodes per segment.

    Returns:
        Rayleigh and Mie radiance (n, C) each, W m^-2 sr^-1 nm^-1 over the phase function.
    """
    light = fast_by_name(atmosphere, altitude_m, mu, mu_s, nu, samples)
    return light.pop("molecules"), np.sum(list(light.values()), axis=0)


def fast_by_name(
    atmosphere: Atmosphere,
    altitude_m: float,
    mu: FloatArray,
    mu_s: float,
    nu: FloatArray,
    samples: int = 12,
) -> dict[str, FloatArray]:
    """The same (n, C) of each of the atmosphere's scatterers, by name."""
    scatterers = atmosphere.scatterers()
    out = np.zeros((len(scatterers), len(mu), len(atmosphere.wavelength_nm)))
    _trace_rays(
        (atmosphere.ground_radius_m, atmosphere.top_altitude_m),
        scatterers[0].exponentials.array(),
        np.array([kind.scale_height_m for kind in scatterers[1:] if kind.peak_m is None]),
        np.array([kind.kinks_m for kind in scatterers if kind.peak_m is not None]).reshape(-1, 3),
        np.array([kind.extinction for kind in scatterers]),
        np.array(atmosphere.absorption_extinction),
        np.array(atmosphere.absorber_altitude_m),
        np.array(atmosphere.absorber_density),
        *unit_nodes(samples),
        (CLUSTERING, HAZE_DEPTH),
        np.array(break_levels_m(atmosphere)),
        (float(altitude_m), float(mu_s)),
        np.ascontiguousarray(mu, dtype=float),
        np.ascontiguousarray(nu, dtype=float),
        out,
    )
    scattering = np.array([kind.scattering for kind in scatterers])
    out *= (scattering * np.asarray(atmosphere.solar_irradiance))[:, None, :]
    return {kind.name: part for kind, part in zip(scatterers, out, strict=True)}


@compiled
def _trace_rays(  # type: ignore[no-untyped-def]
    planet, layers, scales, tents, extinction, absorption, absorber_altitude, absorber_density,
    nodes, weights, rule, levels, place, mu, nu, out,
):  # fmt: skip
    breaks = np.empty((2, 5 + 2 * levels.size))
    matter = np.empty((2, len(extinction)))
    for i in range(mu.size):
        ray = make_ray(planet[0], place[0], mu[i])
        _fill_break_points(planet, ray, place[1], nu[i], levels, breaks)
        for segment in range(breaks.shape[1] - 1):
            length, low_y, low_altitude = _segment(breaks, segment)
            middle = 0.5 * (breaks[0, segment] + breaks[0, segment + 1])
            if length == 0.0 or _is_dark(planet, ray, middle, place[1], nu[i]):
                continue
            b = rule[0]
            if length > 0.0:
                thickness = _extinction(extinction, layers, scales, tents, low_altitude) * length
                b += math.log1p(thickness * jacobian(ray[2], low_y) / rule[1])
            whole = math.expm1(b)
            for k in range(nodes.size):
                part = math.expm1(b * nodes[k])
                dy = length * part / whole
                y = low_y + dy
                altitude = min(max(low_altitude + dy * (dy + 2.0 * low_y), 0.0), planet[1])
                weight = weights[k] * b * (part + 1.0) / whole
                metres = abs(length) * weight * jacobian(ray[2], y)
                _add_node(
                    planet, layers, scales, tents, extinction, absorption, absorber_altitude,
                    absorber_density, ray, altitude, y, place[1], nu[i], metres, matter, out[:, i],
                )  # fmt: skip


@compiled
def _add_node(  # type: ignore[no-untyped-def]
    planet, layers, scales, tents, extinction, absorption, absorber_altitude, absorber_density, ray,
    altitude, y, mu_s, nu, metres, matter, out,
):  # fmt: skip
    sun = make_ray(planet[0], altitude, _sun_cosine(planet[0], ray, altitude, y, mu_s, nu))
    sun_y = max(math.sqrt(max(planet[1] - sun[3], 0.0)), sun[4])
    path, density = matter[0], matter[1]
    here, top = layers_density(layers, altitude), layers_density(layers, planet[1])
    density[0] = here
    path[0] = exponential_layers_path(sun, here, planet[1], sun_y, top, layers)
    path[0] += exponential_layers_path(
        ray, layers_density(layers, ray[0]), altitude, y, here, layers
    )
    for k in range(scales.size):
        path[1 + k], density[1 + k] = _two_paths(planet[1], ray, altitude, y, sun, sun_y, scales[k])
    for k in range(len(tents)):
        last = 1 + scales.size + k
        path[last] = layered_path(ray, y, tents[k], _TENT)
        path[last] += layered_path(sun, sun_y, tents[k], _TENT)
        density[last] = _tent(tents[k], altitude)
    absorbed = 0.0
    if absorption.any():
        absorbed = layered_path(ray, y, absorber_altitude, absorber_density)
        absorbed += layered_path(sun, sun_y, absorber_altitude, absorber_density)
    for c in range(extinction.shape[1]):
        depth = absorption[c] * absorbed
        for k in range(path.size):
            depth += extinction[k, c] * path[k]
        light = metres * math.exp(-depth)
        for k in range(path.size):
            out[k, c] += light * density[k]


@compiled
def _extinction(extinction, layers, scales, tents, altitude):  # type: ignore[no-untyped-def]
    total = extinction[0].max() * layers_density(layers, altitude)
    for k in range(1, len(extinction)):
        if k <= scales.size:
            density = math.exp(-altitude / scales[k - 1])
        else:
            density = _tent(tents[k - 1 - scales.size], altitude)
        total += extinction[k].max() * density
    return total


@compiled
def _tent(kinks, altitude):  # type: ignore[no-untyped-def]
    return max(1.0 - abs(altitude - kinks[1]) / (kinks[2] - kinks[1]), 0.0)


@compiled
def _fill_break_points(planet, ray, mu_s, nu, levels, breaks):  # type: ignore[no-untyped-def]
    """y and altitude of start, perigee, both shadow edges, end and altitudes, sorted by y."""
    altitude, radius, p, perigee, start, along = ray
    hits = along < 0 and perigee <= 0
    end = -math.sqrt(-perigee) if hits else math.sqrt(planet[1] - altitude + start * start)
    end, end_altitude = max(end, start), 0.0 if hits else planet[1]
    a = (1.0 - nu) * (1.0 + nu)
    b = along - radius * mu_s * nu
    c = altitude * (radius + planet[0]) - (radius * mu_s) ** 2
    discriminant = b * b - a * c
    q = -(b + math.copysign(math.sqrt(max(discriminant, 0.0)), b))
    breaks[0, :] = start
    breaks[0, 1], breaks[0, 4] = min(max(0.0, start), end), end
    for k in range(levels.size):
        level = math.sqrt(max(levels[k] - perigee, 0.0))
        breaks[0, 5 + 2 * k] = min(max(-level, start), end)
        breaks[0, 6 + 2 * k] = min(max(level, start), end)
    for k in range(2):
        numerator, denominator = (q, a) if k == 0 else (c, q)
        if discriminant > 0 and abs(denominator) > abs(numerator) * 1e-9:
            s = numerator / denominator
            if s > 0 and radius * mu_s + s * nu < 0:
                d = along + s
                crossing = d / math.sqrt(max(p + math.sqrt(p * p + d * d), 1e-300))
                breaks[0, 2 + k] = min(max(crossing, start), end)
    # numba takes two seconds to compile its own sort, which is made for long arrays.
    for k in range(1, breaks.shape[1]):
        y, before = breaks[0, k], k
        while before > 0 and breaks[0, before - 1] > y:
            breaks[0, before] = breaks[0, before - 1]
            before -= 1
        breaks[0, before] = y
    for k in range(breaks.shape[1]):
        breaks[1, k] = perigee + breaks[0, k] ** 2
        if breaks[0, k] == start:
            breaks[1, k] = altitude
        elif breaks[0, k] == end:
            breaks[1, k] = end_altitude


@compiled
def _segment(breaks, segment):  # type: ignore[no-untyped-def]
    """Signed length from the low to the high end, and the low end's y and altitude."""
    first, last = segment, segment + 1
    total = breaks[0, first] + breaks[0, last]
    length = breaks[0, last] - breaks[0, first]
    if length < abs(total) / 3.0:
        length = (breaks[1, last] - breaks[1, first]) / total
    if breaks[0, last] > 0:
        return length, breaks[0, first], breaks[1, first]
    return -length, breaks[0, last], breaks[1, last]


@compiled
def _is_dark(planet, ray, y, mu_s, nu):  # type: ignore[no-untyped-def]
    altitude = max(ray[3] + y * y, 0.0)
    cosine = _sun_cosine(planet[0], ray, altitude, y, mu_s, nu)
    tangent = (planet[0] + altitude) * cosine
    return cosine < 0 and tangent * tangent >= altitude * (2.0 * planet[0] + altitude)


@compiled
def _sun_cosine(ground_radius, ray, altitude, y, mu_s, nu):  # type: ignore[no-untyped-def]
    distance = y * math.sqrt(y * y + 2.0 * ray[2]) - ray[5]
    cosine = (ray[1] * mu_s + distance * nu) / (ground_radius + altitude)
    return min(max(cosine, -1.0), 1.0)


@compiled
def _two_paths(top, ray, altitude, y, sun, sun_y, scale):  # type: ignore[no-untyped-def]
    """Path from the eye to the node and on to the sun, and the density at the node."""
    density = math.exp(-altitude / scale)
    eye = exponential_path(ray, math.exp(-ray[0] / scale), altitude, y, density, scale)
    light = exponential_path(sun, density, top, sun_y, math.exp(-top / scale), scale)
    return eye + light, density
