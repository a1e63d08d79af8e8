"""Where a path goes from a scatterer or from the ground.

Directions are drawn from a mixture of the phase functions and of two lobes that look at the
horizon below which the sun has gone.
"""

# ruff: noqa: NPY002 (inside compiled code the seed is set and used where nothing else draws)

import math

import numpy as np

from tools.twilight_fit.medium import compiled, dot

# The lobes at the sun's horizon: their share of the directions, a wide and a narrow asymmetry
# that take half of it each, and their tilt upward.
LOBE_SHARE, LOBE_G_WIDE, LOBE_G_NARROW, LOBE_TILT = 0.5, 0.4, 0.85, 0.1


@compiled
def set_scattering(medium, thin, haze, cosine, factor):  # type: ignore[no-untyped-def]
    """Scattering coefficients (C,) per steradian at a cosine from the old direction."""
    rayleigh, mie = _rayleigh(cosine) * thin, _cornette_shanks(cosine, medium.g) * haze
    for c in range(factor.size):
        factor[c] = medium.scattering[0, c] * rayleigh + medium.scattering[1, c] * mie


@compiled
def draw_direction(g, aerosol_share, lobe, direction):  # type: ignore[no-untyped-def]
    """Turn the direction; the cosine of the turn and the density per steradian."""
    aerosol_share *= 1.0 - LOBE_SHARE
    even_share = 1.0 - LOBE_SHARE - aerosol_share
    old = (direction[0], direction[1], direction[2])
    u = np.random.random()
    if u < LOBE_SHARE:
        g_lobe = LOBE_G_WIDE if u < 0.5 * LOBE_SHARE else LOBE_G_NARROW
        turn(lobe, _draw_henyey_greenstein(g_lobe), direction)
    elif u < LOBE_SHARE + aerosol_share:
        turn(old, _draw_henyey_greenstein(g), direction)
    else:
        turn(old, 2.0 * np.random.random() - 1.0, direction)
    cosine, toward = dot(old, direction), dot(lobe, direction)
    density = 0.5 * LOBE_SHARE * _henyey_greenstein(toward, LOBE_G_WIDE)
    density += 0.5 * LOBE_SHARE * _henyey_greenstein(toward, LOBE_G_NARROW)
    density += aerosol_share * _henyey_greenstein(cosine, g) + even_share / (4.0 * math.pi)
    return cosine, density


@compiled
def lobe_axis(point, sun):  # type: ignore[no-untyped-def]
    """A unit vector at the horizon where the sun went down, tilted up a little."""
    up = upward(point)
    mu_s = dot(up, sun)
    x, y, z = sun[0] - mu_s * up[0], sun[1] - mu_s * up[1], sun[2] - mu_s * up[2]
    level = math.sqrt(x * x + y * y + z * z)
    if level < 1e-9:
        return up
    length = math.sqrt(1.0 + LOBE_TILT * LOBE_TILT)
    return (
        (x / level + LOBE_TILT * up[0]) / length,
        (y / level + LOBE_TILT * up[1]) / length,
        (z / level + LOBE_TILT * up[2]) / length,
    )


@compiled
def turn(axis, cosine, direction):  # type: ignore[no-untyped-def]
    """Set a direction at an angle from an axis, at a random azimuth about it."""
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    azimuth = 2.0 * math.pi * np.random.random()
    a, b = sine * math.cos(azimuth), sine * math.sin(azimuth)
    x, y, z = axis
    # Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    sign = math.copysign(1.0, z)
    c = -1.0 / (sign + z)
    d = x * y * c
    direction[0] = cosine * x + a * (1.0 + sign * x * x * c) + b * d
    direction[1] = cosine * y + a * sign * d + b * (sign + y * y * c)
    direction[2] = cosine * z - a * sign * x - b * y


@compiled
def _draw_henyey_greenstein(g):  # type: ignore[no-untyped-def]
    z = (1.0 - g * g) / (1.0 - g + 2.0 * g * np.random.random())
    return min(max((1.0 + g * g - z * z) / (2.0 * g), -1.0), 1.0)


@compiled
def _henyey_greenstein(cosine, g):  # type: ignore[no-untyped-def]
    return (1.0 - g * g) / (4.0 * math.pi * (1.0 + g * g - 2.0 * g * cosine) ** 1.5)


@compiled
def _cornette_shanks(cosine, g):  # type: ignore[no-untyped-def]
    spread = (1.0 - g) ** 2 + 2.0 * g * (1.0 - cosine)
    scale = 3.0 / (8.0 * math.pi) * (1.0 - g * g) / (2.0 + g * g)
    return scale * (1.0 + cosine * cosine) / (spread * math.sqrt(spread))


@compiled
def _rayleigh(cosine):  # type: ignore[no-untyped-def]
    return 3.0 / (16.0 * math.pi) * (1.0 + cosine * cosine)


@compiled
def upward(point):  # type: ignore[no-untyped-def]
    """The zenith's direction at a point, as a tuple."""
    r = math.sqrt(dot(point, point))
    return point[0] / r, point[1] / r, point[2] / r
