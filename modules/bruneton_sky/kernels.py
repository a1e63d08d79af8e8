"""The rule "GL-y-exp" compiled: one ray at a time, float64, parameters as arguments.

The formulas are those of `geometry`, `optical_path` and `quadrature`, which explain them. The
scaled complementary error function is a polynomial here (relative error 1.3e-9), so kernel
and twin differ by some 1e-9.

Importing this module imports numba: do it only where the first ray is traced.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.quadrature import CLUSTERING, HAZE_DEPTH, unit_nodes

FloatArray = NDArray[np.float64]
# erfcx(x) = P(t) / (1 + 2 x) with t = (x - 4) / (x + 4), for x >= 0; constant first.
ERFCX = (
    1.232995117440,
    -0.139621113854,
    0.015379768723,
    0.068096941417,
    -0.101040940771,
    0.093734073444,
    -0.066319044089,
    0.037161482871,
    -0.016230391983,
    0.005047229283,
    -0.000709132787,
    -0.000220404494,
    0.000114208173,
    -0.000008625303,
)
_GAUSS_3 = math.sqrt(0.6)
_compiled = njit(cache=True, nogil=True, error_model="numpy")


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
    extinction = np.array(
        [
            atmosphere.rayleigh_scattering,
            atmosphere.mie_extinction,
            atmosphere.absorption_extinction,
        ]
    )
    scattering = np.array([atmosphere.rayleigh_scattering, atmosphere.mie_scattering])
    out = np.zeros((2, len(mu), len(atmosphere.wavelength_nm)))
    _trace_rays(
        (atmosphere.ground_radius_m, atmosphere.top_altitude_m),
        (atmosphere.rayleigh_scale_height_m, atmosphere.mie_scale_height_m),
        extinction,
        np.array(atmosphere.absorber_altitude_m),
        np.array(atmosphere.absorber_density),
        *unit_nodes(samples),
        (CLUSTERING, HAZE_DEPTH),
        (float(altitude_m), float(mu_s)),
        np.ascontiguousarray(mu, dtype=float),
        np.ascontiguousarray(nu, dtype=float),
        out,
    )
    out *= (scattering * np.asarray(atmosphere.solar_irradiance))[:, None, :]
    return out[0], out[1]


@_compiled
def _trace_rays(  # type: ignore[no-untyped-def]
    planet, scales, extinction, absorber_altitude, absorber_density, nodes, weights, rule, place,
    mu, nu, out,
):  # fmt: skip
    breaks = np.empty((2, 5))
    for i in range(mu.size):
        ray = _ray(planet[0], place[0], mu[i])
        _fill_break_points(planet, ray, place[1], nu[i], breaks)
        for segment in range(4):
            length, low_y, low_altitude = _segment(breaks, segment)
            middle = 0.5 * (breaks[0, segment] + breaks[0, segment + 1])
            if length == 0.0 or _is_dark(planet, ray, middle, place[1], nu[i]):
                continue
            b = rule[0]
            if length > 0.0:
                thickness = _extinction(extinction, scales, low_altitude) * length
                b += math.log1p(thickness * _jacobian(ray[2], low_y) / rule[1])
            whole = math.expm1(b)
            for k in range(nodes.size):
                part = math.expm1(b * nodes[k])
                dy = length * part / whole
                y = low_y + dy
                altitude = min(max(low_altitude + dy * (dy + 2.0 * low_y), 0.0), planet[1])
                weight = weights[k] * b * (part + 1.0) / whole
                metres = abs(length) * weight * _jacobian(ray[2], y)
                _add_node(
                    planet, scales, extinction, absorber_altitude, absorber_density,
                    ray, altitude, y, place[1], nu[i], metres, out[:, i],
                )  # fmt: skip


@_compiled
def _add_node(  # type: ignore[no-untyped-def]
    planet, scales, extinction, absorber_altitude, absorber_density, ray, altitude, y, mu_s, nu,
    metres, out,
):  # fmt: skip
    sun = _ray(planet[0], altitude, _sun_cosine(planet[0], ray, altitude, y, mu_s, nu))
    sun_y = max(math.sqrt(max(planet[1] - sun[3], 0.0)), sun[4])
    rayleigh_path, rayleigh_density = _two_paths(planet[1], ray, altitude, y, sun, sun_y, scales[0])
    mie_path, mie_density = _two_paths(planet[1], ray, altitude, y, sun, sun_y, scales[1])
    absorbed = 0.0
    if extinction[2].any():
        absorbed = _layered_path(ray, y, absorber_altitude, absorber_density)
        absorbed += _layered_path(sun, sun_y, absorber_altitude, absorber_density)
    for c in range(extinction.shape[1]):
        depth = extinction[0, c] * rayleigh_path + extinction[1, c] * mie_path
        light = metres * math.exp(-depth - extinction[2, c] * absorbed)
        out[0, c] += light * rayleigh_density
        out[1, c] += light * mie_density


@_compiled
def _extinction(extinction, scales, altitude):  # type: ignore[no-untyped-def]
    molecules = extinction[0].max() * math.exp(-altitude / scales[0])
    return molecules + extinction[1].max() * math.exp(-altitude / scales[1])


@_compiled
def _ray(ground_radius, altitude, mu):  # type: ignore[no-untyped-def]
    """Altitude, radius, perigee radius, perigee altitude, y, radius * mu."""
    radius = ground_radius + altitude
    sine = math.sqrt((1.0 - mu) * (1.0 + mu))
    y_squared = radius * mu * mu / (1.0 + sine)
    y = math.copysign(math.sqrt(y_squared), mu)
    return altitude, radius, radius * sine, altitude - y_squared, y, radius * mu


@_compiled
def _fill_break_points(planet, ray, mu_s, nu, breaks):  # type: ignore[no-untyped-def]
    """y and altitude of start, perigee, both shadow edges and end, sorted by y."""
    altitude, radius, p, perigee, start, along = ray
    hits = along < 0 and perigee <= 0
    end = -math.sqrt(-perigee) if hits else math.sqrt(max(planet[1] - perigee, 0.0))
    end, end_altitude = max(end, start), 0.0 if hits else planet[1]
    a = (1.0 - nu) * (1.0 + nu)
    b = along - radius * mu_s * nu
    c = altitude * (radius + planet[0]) - (radius * mu_s) ** 2
    discriminant = b * b - a * c
    q = -(b + math.copysign(math.sqrt(max(discriminant, 0.0)), b))
    breaks[0, :] = start
    breaks[0, 1], breaks[0, 4] = min(max(0.0, start), end), end
    for k in range(2):
        numerator, denominator = (q, a) if k == 0 else (c, q)
        if discriminant > 0 and abs(denominator) > abs(numerator) * 1e-9:
            s = numerator / denominator
            if s > 0 and radius * mu_s + s * nu < 0:
                d = along + s
                crossing = d / math.sqrt(max(p + math.sqrt(p * p + d * d), 1e-300))
                breaks[0, 2 + k] = min(max(crossing, start), end)
    breaks[0].sort()
    for k in range(5):
        breaks[1, k] = perigee + breaks[0, k] ** 2
        if breaks[0, k] == start:
            breaks[1, k] = altitude
        elif breaks[0, k] == end:
            breaks[1, k] = end_altitude


@_compiled
def _segment(breaks, segment):  # type: ignore[no-untyped-def]
    """Signed length from the low to the high end, and the low end's y and altitude."""
    first, last = segment, segment + 1
    total = breaks[0, first] + breaks[0, last]
    length = 0.0
    if total != 0.0:
        length = (breaks[1, last] - breaks[1, first]) / total
    if breaks[0, last] > 0:
        return length, breaks[0, first], breaks[1, first]
    return -length, breaks[0, last], breaks[1, last]


@_compiled
def _is_dark(planet, ray, y, mu_s, nu):  # type: ignore[no-untyped-def]
    altitude = max(ray[3] + y * y, 0.0)
    cosine = _sun_cosine(planet[0], ray, altitude, y, mu_s, nu)
    tangent = (planet[0] + altitude) * cosine
    return cosine < 0 and tangent * tangent >= altitude * (2.0 * planet[0] + altitude)


@_compiled
def _sun_cosine(ground_radius, ray, altitude, y, mu_s, nu):  # type: ignore[no-untyped-def]
    distance = y * math.sqrt(y * y + 2.0 * ray[2]) - ray[5]
    cosine = (ray[1] * mu_s + distance * nu) / (ground_radius + altitude)
    return min(max(cosine, -1.0), 1.0)


@_compiled
def _jacobian(p, y):  # type: ignore[no-untyped-def]
    squared = y * y + 2.0 * p
    return 2.0 * (y * y + p) / math.sqrt(squared) if squared > 0 else 0.0


@_compiled
def _two_paths(top, ray, altitude, y, sun, sun_y, scale):  # type: ignore[no-untyped-def]
    """Path from the eye to the node and on to the sun, and the density at the node."""
    density = math.exp(-altitude / scale)
    eye = _exponential_path(ray, math.exp(-ray[0] / scale), altitude, y, density, scale)
    light = _exponential_path(sun, density, top, sun_y, math.exp(-top / scale), scale)
    return eye + light, density


@_compiled
def _exponential_path(ray, d0, h1, y1, d1, scale):  # type: ignore[no-untyped-def]
    h0, r, p, perigee, y0, _ = ray
    root = math.sqrt(scale)
    tail0, tail1 = d0 * _erfcx(abs(y0) / root), d1 * _erfcx(abs(y1) / root)
    if y0 >= 0:
        t0 = tail0 - tail1
    elif y1 <= 0:
        t0 = tail1 - tail0
    else:
        t0 = 2.0 * math.exp(-max(perigee, 0.0) / scale) - tail0 - tail1
    t0 *= math.sqrt(math.pi) * root
    y0_squared = y0 * y0
    t1 = scale * (d0 * y0 - d1 * y1) + (0.5 * scale - y0_squared) * t0
    t2 = -scale * y1 * (h1 - h0) * d1 + (1.5 * scale - y0_squared) * t1 + scale * y0_squared * t0
    inverse_q = 1.0 / (r + p)
    a1 = 1.0 / r - 0.5 * inverse_q
    a2 = inverse_q * (0.375 * inverse_q - 0.5 / r)
    return max(r * math.sqrt(inverse_q) * (t0 + a1 * t1 + a2 * t2), 0.0)


@_compiled
def _erfcx(x):  # type: ignore[no-untyped-def]
    t = (x - 4.0) / (x + 4.0)
    value = 0.0
    for k in range(len(ERFCX) - 1, -1, -1):
        value = value * t + ERFCX[k]
    return value / (1.0 + 2.0 * x)


@_compiled
def _layered_path(ray, end, node_altitude, density):  # type: ignore[no-untyped-def]
    perigee, start, path = ray[3], ray[4], 0.0
    for k in range(node_altitude.size - 1):
        low, high = node_altitude[k], node_altitude[k + 1]
        if high <= perigee:
            continue
        slope = (density[k + 1] - density[k]) / (high - low)
        near, far = math.sqrt(max(low - perigee, 0.0)), math.sqrt(high - perigee)
        offset = density[k] + slope * (perigee - low)
        path += _layer_branch(ray[2], max(near, start), min(far, end), offset, slope)
        path += _layer_branch(ray[2], max(-far, start), min(-near, end), offset, slope)
    return path


@_compiled
def _layer_branch(p, from_y, to_y, offset, slope):  # type: ignore[no-untyped-def]
    half, middle = 0.5 * (to_y - from_y), 0.5 * (from_y + to_y)
    if half <= 0:
        return 0.0
    path = 0.0
    for k in range(3):
        y = middle + half * _GAUSS_3 * (k - 1)
        path += (8.0 if k == 1 else 5.0) / 9.0 * _jacobian(p, y) * (offset + slope * y * y)
    return half * path
