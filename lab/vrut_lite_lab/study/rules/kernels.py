"""The textbook rules compiled: one ray at a time, float64.

The formulas are those of `bruneton_sky.published.classical_rules`, for an observer at sea level
who looks up through molecules and aerosol. Simpson's odd nodes get the optical depth before them by
the parabola through their neighbours, as there, or by the trapezoid rule.
`bruneton_sky.single_scattering_kernels` has the other rule.

Importing this module imports numba.
"""

import math

import numpy as np
from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.path_kernels import compiled
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.published.classical_rules import checked_intervals, rule_nodes

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.rules.airs import SeaLevelRays

_MIDPOINT, _TRAPEZOID, _SIMPSON, _SIMPSON_TRAPEZOID = range(4)
_CODES = {
    "midpoint": _MIDPOINT,
    "trapezoid": _TRAPEZOID,
    "simpson": _SIMPSON,
    "simpson-trapezoid": _SIMPSON_TRAPEZOID,
}


def classical_radiance(
    air: Atmosphere, rays: SeaLevelRays, rule: str, intervals: tuple[int, int]
) -> FloatArray:
    """Radiance (n, C) of light scattered once, by a textbook rule.

    Args:
        air: without absorber and fog.
        rays: upward, (n,).
        rule: `midpoint`, `trapezoid`, `simpson`, or `simpson-trapezoid`, whose odd nodes get
            their optical depth by the trapezoid rule.
        intervals: on the view ray and from there to the sun.

    Raises:
        ValueError: the intervals do not suit the rule.
    """
    name = rule.removesuffix("-trapezoid")
    view, light = checked_intervals(name, intervals)
    scatterers = air.scatterers()
    out = np.zeros((2, rays.mu.size, len(air.wavelength_nm)))
    _trace(
        (air.ground_radius_m, air.top_altitude_m),
        (air.rayleigh_scale_height_m, air.mie_scale_height_m),
        np.array([kind.extinction for kind in scatterers]),
        _CODES[rule],
        rule_nodes(name, view),
        rule_nodes(name, light),
        rays.mu_s,
        np.ascontiguousarray(rays.mu),
        np.ascontiguousarray(rays.nu),
        out,
    )
    out *= np.array([kind.scattering for kind in scatterers])[:, None] * air.solar_irradiance
    cosine = rays.nu[:, None]
    return np.asarray(out[0] * rayleigh_phase(cosine) + out[1] * mie_phase(air, cosine))


@compiled
def _trace(  # type: ignore[no-untyped-def]
    planet, scales, extinction, rule, view, light, mu_s, mu, nu, out
):
    count = view[0].size
    altitude, density, path = np.empty(count), np.empty((2, count)), np.empty((2, count))
    for i in range(mu.size):
        length = _distance_to_top(planet, 0.0, mu[i])
        for k in range(count):
            h = _altitude_after(planet[0], mu[i], length * view[0][k])
            altitude[k] = min(max(h, 0.0), planet[1])
            density[0, k] = math.exp(-altitude[k] / scales[0])
            density[1, k] = math.exp(-altitude[k] / scales[1])
        for kind in range(2):
            _accumulate(rule, density[kind], length * (view[0][1] - view[0][0]), path[kind])
        for k in range(count):
            h = altitude[k]
            cosine = (planet[0] * mu_s + length * view[0][k] * nu[i]) / (planet[0] + h)
            cosine = min(max(cosine, -1.0), 1.0)
            if cosine < 0.0 and ((planet[0] + h) * cosine) ** 2 >= h * (2.0 * planet[0] + h):
                continue
            rayleigh_m, mie_m = _light_paths(planet, scales, h, cosine, light)
            rayleigh_m, mie_m = rayleigh_m + path[0, k], mie_m + path[1, k]
            metres = length * view[1][k]
            for c in range(extinction.shape[1]):
                depth = extinction[0, c] * rayleigh_m + extinction[1, c] * mie_m
                reaching = metres * math.exp(-depth)
                out[0, i, c] += reaching * density[0, k]
                out[1, i, c] += reaching * density[1, k]


@compiled
def _accumulate(rule, density, step, path):  # type: ignore[no-untyped-def]
    """Paths from the start to each node by the rule itself."""
    path[0] = 0.5 * step * density[0] if rule == _MIDPOINT else 0.0
    for k in range(1, density.size):
        before, here = density[k - 1], density[k]
        if rule >= _SIMPSON and k % 2 == 0:
            path[k] = path[k - 2] + step / 3.0 * (density[k - 2] + 4.0 * before + here)
        elif rule == _SIMPSON:
            path[k] = path[k - 1] + step / 12.0 * (5.0 * before + 8.0 * here - density[k + 1])
        else:
            path[k] = path[k - 1] + 0.5 * step * (before + here)


@compiled
def _light_paths(planet, scales, altitude, mu_s, light):  # type: ignore[no-untyped-def]
    length = _distance_to_top(planet, altitude, mu_s)
    radius = planet[0] + altitude
    rayleigh_m, mie_m = 0.0, 0.0
    for k in range(light[0].size):
        d = length * light[0][k]
        rise = d * (d + 2.0 * radius * mu_s)
        h = max(altitude + rise / (math.sqrt(rise + radius * radius) + radius), 0.0)
        rayleigh_m += light[1][k] * math.exp(-h / scales[0])
        mie_m += light[1][k] * math.exp(-h / scales[1])
    return rayleigh_m * length, mie_m * length


@compiled
def _distance_to_top(planet, altitude, mu):  # type: ignore[no-untyped-def]
    along = (planet[0] + altitude) * mu
    c = (planet[1] - altitude) * (2.0 * planet[0] + planet[1] + altitude)
    root = math.sqrt(along * along + c)
    return c / (root + along) if along > 0.0 else root - along


@compiled
def _altitude_after(ground_radius, mu, distance):  # type: ignore[no-untyped-def]
    """Altitude on a ray from sea level."""
    rise = distance * (distance + 2.0 * ground_radius * mu)
    return rise / (math.sqrt(rise + ground_radius * ground_radius) + ground_radius)
