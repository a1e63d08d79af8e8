"""Directions of a traced path after a scatterer or the ground.

A scattered path's direction is drawn from a mixture: the aerosol's phase function about the old
direction, uniform directions for the molecules, and two lobes toward the sun or, after
sunset, toward the horizon below which it is. The mixture's density is exact, so that it
changes the noise alone.
"""

import math

import numpy as np

from vrut_lite_lab.monte_carlo.medium import compiled, dot

# The lobes toward the sun, a wide and a narrow asymmetry in equal parts, and the least sine of
# their elevation. Their share of the directions grows from LOBE_DAY to LOBE_DUSK as the sun's
# cosine falls from LOBE_BELOW to 0. All values were chosen for least noise, from noon to the sun 6
# degrees down, with thin and thick aerosol; the optimum is flat.
LOBE_G_WIDE, LOBE_G_NARROW, LOBE_TILT = 0.6, 0.92, 0.1
LOBE_DAY, LOBE_DUSK, LOBE_BELOW = 0.05, 0.5, 0.4


@compiled
def set_scattering(medium, density, cosine, matrix):  # type: ignore[no-untyped-def]
    """Set the scattering matrix (4, C) in 1/(m sr) at a cosine from the old direction.

    `density` (5,): see `densities`.
    Rows P11, P12, P22, P33; only the first where the medium does not polarise. Molecules: Hansen
    and Travis 1974, equation 2.15. Particles are spheres, with P22 = P11; P34 and V are left out.
    """
    squared = cosine * cosine
    dipoles = 3.0 / (16.0 * math.pi) * medium.anisotropy * density[0]
    even = (1.0 - medium.anisotropy) / (4.0 * math.pi) * density[0]
    for c in range(matrix.shape[1]):
        dipole = medium.scattering[0, c] * dipoles
        matrix[0, c] = dipole * (1.0 + squared) + medium.scattering[0, c] * even
        if medium.polarises:
            matrix[1, c] = dipole * (squared - 1.0)
            matrix[2, c] = dipole * (1.0 + squared)
            matrix[3, c] = dipole * 2.0 * cosine
    place = _turn_of(cosine) * (medium.phase.shape[1] - 1)
    k = min(int(place), medium.phase.shape[1] - 2)
    far = place - k
    _add_particles(medium.phase, k, far, medium.scattering[1], density[1], matrix)
    if density[2] > 0.0:
        _add_particles(medium.fog_phase, k, far, medium.scattering[2], density[2], matrix)
    if density[3] > 0.0:
        _add_particles(medium.aloft_phase, k, far, medium.scattering[3], density[3], matrix)
    if density[4] > 0.0:
        _add_particles(medium.veil_phase, k, far, medium.scattering[4], density[4], matrix)


@compiled
def _add_particles(table, k, far, scattering, density, matrix):  # type: ignore[no-untyped-def]
    """Add particles whose table (1 or 3, nodes, C) holds P11, P12 and P33 in sr^-1."""
    for c in range(matrix.shape[1]):
        strength = scattering[c] * density
        p11 = strength * (table[0, k, c] + far * (table[0, k + 1, c] - table[0, k, c]))
        matrix[0, c] += p11
        if table.shape[0] > 1:
            matrix[1, c] += strength * (
                table[1, k, c] + far * (table[1, k + 1, c] - table[1, k, c])
            )
            matrix[2, c] += p11
            matrix[3, c] += strength * (
                table[2, k, c] + far * (table[2, k + 1, c] - table[2, k, c])
            )


@compiled
def draw_direction(cumulated, aerosol_share, lobes, lobe, u, v, direction):  # type: ignore[no-untyped-def]
    """Turn a direction by two uniform numbers; the cosine of the turn, the density in 1/sr.

    `cumulated`: see `Medium.turn`.
    """
    aerosol = (1.0 - lobes) * aerosol_share
    old = (direction[0], direction[1], direction[2])
    if u < lobes:
        u /= lobes
        asymmetry = LOBE_G_WIDE if u < 0.5 else LOBE_G_NARROW
        turn(lobe, _draw_cosine(asymmetry, (2.0 * u) % 1.0), v, direction)
    elif u < lobes + aerosol:
        turn(old, _draw_tabulated(cumulated, (u - lobes) / aerosol), v, direction)
    else:
        even = (u - lobes - aerosol) / (1.0 - lobes - aerosol)
        turn(old, 1.0 - 2.0 * even, v, direction)
    cosine, toward = dot(old, direction), dot(lobe, direction)
    density = aerosol * _tabulated_density(cumulated, cosine)
    density += (1.0 - lobes - aerosol) / (4.0 * math.pi)
    density += 0.5 * lobes * _henyey_greenstein(toward, LOBE_G_WIDE)
    density += 0.5 * lobes * _henyey_greenstein(toward, LOBE_G_NARROW)
    return cosine, density


@compiled
def lobe_share(mu_s, fog_share):  # type: ignore[no-untyped-def]
    """Share of the directions drawn toward the sun: none in fog, whose light is diffuse.

    There paths scatter so often that their weights would grow without bound.
    """
    dusk = min(max(1.0 - mu_s / LOBE_BELOW, 0.0), 1.0)
    return (LOBE_DAY + (LOBE_DUSK - LOBE_DAY) * dusk) * (1.0 - fog_share)


@compiled
def lobe_axis(point, sun):  # type: ignore[no-untyped-def]
    """A unit vector toward the sun, but never below a point a little above the horizon."""
    up = upward(point)
    mu_s = dot(up, sun)
    if mu_s > LOBE_TILT:
        return sun[0], sun[1], sun[2]
    x, y, z = sun[0] - mu_s * up[0], sun[1] - mu_s * up[1], sun[2] - mu_s * up[2]
    level = math.sqrt(x * x + y * y + z * z)
    if level < 1e-9:
        return up
    flat = math.sqrt(1.0 - LOBE_TILT * LOBE_TILT) / level
    return (
        flat * x + LOBE_TILT * up[0],
        flat * y + LOBE_TILT * up[1],
        flat * z + LOBE_TILT * up[2],
    )


@compiled
def turn(axis, cosine, v, direction):  # type: ignore[no-untyped-def]
    """Set a direction at an angle from an axis, at the azimuth 2 pi v about it."""
    sine = math.sqrt(max((1.0 - cosine) * (1.0 + cosine), 0.0))
    azimuth = 2.0 * math.pi * v
    a, b = sine * math.cos(azimuth), sine * math.sin(azimuth)
    x, y, z = axis
    # Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    sign = math.copysign(1.0, z)
    c = -1.0 / (sign + z)
    d = x * y * c
    direction[0] = cosine * x + a * (1.0 + sign * x * x * c) + b * d
    direction[1] = cosine * y + a * sign * d + b * (sign + y * y * c)
    direction[2] = cosine * z - a * sign * x - b * y
    direction /= math.sqrt(dot(direction, direction))


@compiled
def _turn_of(cosine):  # type: ignore[no-untyped-def]
    """sin(theta / 2) of a cosine."""
    return math.sqrt(min(max(0.5 - 0.5 * cosine, 0.0), 1.0))


@compiled
def _draw_tabulated(cumulated, u):  # type: ignore[no-untyped-def]
    """A cosine of a tabulated phase function, even over the sphere between two nodes."""
    k = min(np.searchsorted(cumulated, u, side="right"), cumulated.size - 1)
    below = cumulated[k - 1] if k > 0 else 0.0
    share = min(max((u - below) / max(cumulated[k] - below, 1e-300), 0.0), 1.0)
    near, far = k / cumulated.size, (k + 1) / cumulated.size
    return 1.0 - 2.0 * (near * near + share * (far - near) * (far + near))


@compiled
def _tabulated_density(cumulated, cosine):  # type: ignore[no-untyped-def]
    """The density in 1/sr of such a cosine."""
    k = min(int(_turn_of(cosine) * cumulated.size), cumulated.size - 1)
    chance = cumulated[k] - (cumulated[k - 1] if k > 0 else 0.0)
    near, far = k / cumulated.size, (k + 1) / cumulated.size
    return chance / (4.0 * math.pi * (far - near) * (far + near))


@compiled
def _draw_cosine(g, u):  # type: ignore[no-untyped-def]
    """A cosine of Henyey and Greenstein's distribution, falling with u in [0, 1)."""
    # Its cumulative distribution inverted and multiplied out, so that g = 0 divides by 1.
    s = 1.0 - 2.0 * u
    stretch = 1.0 + g * s
    cosine = (g * (3.0 - g * g) + (1.0 + g * g) * s * (2.0 + g * s)) / (2.0 * stretch * stretch)
    return min(max(cosine, -1.0), 1.0)


@compiled
def _henyey_greenstein(cosine, g):  # type: ignore[no-untyped-def]
    return (1.0 - g) * (1.0 + g) / (4.0 * math.pi) * _peak(cosine, g)


@compiled
def _peak(cosine, g):  # type: ignore[no-untyped-def]
    """(1 + g^2 - 2 g cosine)^-1.5, exact toward the sun at g near 1 too."""
    spread = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cosine)
    return 1.0 / (spread * math.sqrt(spread))


@compiled
def upward(point):  # type: ignore[no-untyped-def]
    """The zenith's direction at a point, as a tuple."""
    r = math.sqrt(dot(point, point))
    return point[0] / r, point[1] / r, point[2] / r
