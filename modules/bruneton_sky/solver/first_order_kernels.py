"""Light scattered once: the sun's light at every bin of a ray, for many suns at once.

Importing this module imports numba.
"""

import math

import numpy as np

from bruneton_sky.path_kernels import (
    exponential_layers_path,
    exponential_path,
    layered_path,
    layers_density,
    make_ray,
)
from bruneton_sky.solver.cell_kernels import HALF, ONE, ZERO, add_two, fast, inner, making
from bruneton_sky.solver.ray_kernels import altitude_at, altitude_place, tent_at

_f4 = np.float32
_OUT_OF_REACH = np.float32(3e38)
_TINY = np.float32(1e-7)
# Rounding of a bin's dark share must leave none of it lit: 6e-8 of the sun's light outshines the
# sky 18 degrees after sunset.
_OVER_ONE = np.float32(1.0 + 1e-6)


@fast
def fill_transmittance(air, table):  # type: ignore[no-untyped-def]
    """Transmittance (altitudes, columns, 4) to the top of the atmosphere.

    The grid is that of Bruneton 2017: rows uniform in sqrt(r^2 - Rg^2), columns in the
    distance to the top, from the zenith to the horizon. Fog and haze add rows.
    """
    rows, columns = table.shape[0], table.shape[1]
    ground, top = air.ground_radius_m, air.top_altitude_m
    whole, at_top = top * (2.0 * ground + top), layers_density(air.molecules, top)
    for i in range(rows):
        squared = whole * (i / (rows - 1)) ** 2
        altitude = min(squared / (math.sqrt(squared + ground * ground) + ground), top)
        if air.layer_share > 0.0:
            altitude = altitude_at(air, i / (rows - 1)) if i > 0 else 0.0
            squared = altitude * (2.0 * ground + altitude)
        nearest = top - altitude
        span = math.sqrt(squared) + math.sqrt(whole) - nearest
        for j in range(columns):
            distance = nearest + span * j / (columns - 1)
            mu = 1.0
            if distance > 0.0:
                rise = whole - squared - distance * distance
                mu = rise / (2.0 * (ground + altitude) * distance)
            ray = make_ray(ground, altitude, min(max(mu, -1.0), 1.0))
            end = max(math.sqrt(max(top - ray[3], 0.0)), ray[4])
            here = layers_density(air.molecules, altitude)
            molecules = exponential_layers_path(ray, here, top, end, at_top, air.molecules)
            aerosol = _path_to_top(air.mie_scale_height_m, top, ray, end)
            absorber = layered_path(ray, end, air.absorber[0], air.absorber[1])
            high = layered_path(ray, end, air.stratosphere[0], air.stratosphere[1])
            fog, aloft = 0.0, 0.0
            if air.fog_scale_height_m > 0.0:
                fog = _path_to_top(air.fog_scale_height_m, top, ray, end)
            if air.aloft_scale_height_m > 0.0:
                aloft = _path_to_top(air.aloft_scale_height_m, top, ray, end)
            for c in range(4):
                depth = air.extinction[0, c] * molecules + air.extinction[1, c] * aerosol
                depth += air.extinction[3, c] * fog + air.extinction[4, c] * aloft
                depth += air.extinction[5, c] * high
                table[i, j, c] = _f4(math.exp(-depth - air.extinction[2, c] * absorber))


@inner
def _path_to_top(scale, top, ray, end):  # type: ignore[no-untyped-def]
    here = math.exp(-ray[0] / scale)
    return exponential_path(ray, here, top, end, math.exp(-top / scale), scale)


@making
def gather_first(air, altitude, mu, bins, cells, table, row, once):  # type: ignore[no-untyped-def]
    """Light scattered once toward a ray's start, by molecules over Rayleigh's phase function
    3 / (16 pi) (1 + nu^2), by particles over their own.

    `once` (parts * cells * 4,): by molecules; then by all particles, or by each of their kinds.
    `table` is the transmittance (altitudes, columns * 4), `row` (columns * 4,) is scratch.
    """
    weight, share = np.empty(20, _f4), np.empty((4, 4))
    _gather_first(air, altitude, mu, bins, cells, table, row, weight, share, once)


@inner
def _gather_first(  # type: ignore[no-untyped-def]
    air, altitude, mu, bins, cells, table, row, weight, share, once
):
    _find_shadow(air, altitude, mu, cells)
    once[:] = ZERO
    parts = once.size // (4 * cells.nu.size)
    for b in range(bins.centre.shape[0]):
        if bins.centre[b, 3] > 0.0:
            for c in range(4):
                weight[c] = air.solar_irradiance[c] * bins.weight[b, 0, c]
                weight[4 + c] = air.solar_irradiance[c] * bins.weight[b, 1, c]
            if parts > 2:
                share_particles(air, bins.centre[b, 1], share)
                for c in range(4):
                    whole = weight[4 + c]
                    for k in range(parts - 1):
                        weight[4 + 4 * k + c] = whole * share[k, c]
            _place_suns(air, altitude, bins, b, row.size // 4, cells)
            _blend_row(air, bins.centre[b, 1], table, cells.offset, row)
            if parts > 2:
                _add_suns_apart(row, weight, parts, cells, once)
            else:
                _add_suns(row, weight, cells, once)
    if air.anisotropy < 1.0:
        _depolarise(_f4(air.anisotropy), cells.nu, once)


@inner
def _depolarise(dipoles, nu, once):  # type: ignore[no-untyped-def]
    """Multiply the molecules' light by their phase function over Rayleigh's."""
    even = (ONE - dipoles) * _f4(4.0 / 3.0)
    for n in range(nu.size):
        share = dipoles + even / (ONE + nu[n] * nu[n])
        for c in range(4):
            once[4 * n + c] *= share


@inner
def share_particles(air, altitude, share):  # type: ignore[no-untyped-def]
    """Shares (4, 4) of aerosol, aerosol aloft and, where there are any, fog and aerosol of the
    stratosphere in what particles scatter at an altitude: the order of `particles.kinds_of`."""
    low, aloft, fog, high = math.exp(-altitude / air.mie_scale_height_m), 0.0, 0.0, 0.0
    if air.aloft_scale_height_m > 0.0:
        aloft = math.exp(-altitude / air.aloft_scale_height_m)
    if air.fog_scale_height_m > 0.0:
        fog = math.exp(-altitude / air.fog_scale_height_m)
    if air.stratosphere.shape[1] > 1:
        high = tent_at(air, altitude)
    last = 3 if air.fog_scale_height_m > 0.0 else 2
    for c in range(4):
        one, two = air.scattering[1, c] * low, air.scattering[2, c] * aloft
        three, four = air.scattering[3, c] * fog, air.scattering[4, c] * high
        per_all = 1.0 / max(one + two + three + four, 1e-300)
        share[0, c], share[1, c], share[3, c] = one * per_all, two * per_all, 0.0
        share[2, c] = three * per_all
        share[last, c] = four * per_all


@inner
def _find_shadow(air, altitude, mu, cells):  # type: ignore[no-untyped-def]
    """Distances in m between which a ray is in the planet's shadow.

    The shadow is the half of a cylinder on the side away from the sun. With s in units of the
    radius at the start, A s^2 + 2 B s + C < 0 inside the cylinder, and the sun is level where
    mu_s + s nu = 0. For a ray that never enters, the first distance is out of reach.
    """
    radius = air.ground_radius_m + altitude
    above = _f4(altitude * (radius + air.ground_radius_m) / (radius * radius))
    cosine, scale = _f4(mu), _f4(radius)
    mu_s, nu, begin, end = cells.mu_s, cells.nu, cells.shadow_from, cells.shadow_to
    for n in range(mu_s.size):
        a = max((ONE - nu[n]) * (ONE + nu[n]), _TINY)
        b = cosine - mu_s[n] * nu[n]
        c = above - mu_s[n] * mu_s[n]
        root = math.sqrt(max(b * b - a * c, ZERO))
        first, last = (-b - root) / a, (root - b) / a
        level = -mu_s[n] / max(abs(nu[n]), _TINY)
        first = max(first, -level) if nu[n] < ZERO else first
        last = last if nu[n] < ZERO else min(last, level)
        begin[n] = first * scale if root > ZERO else _OUT_OF_REACH
        end[n] = last * scale


@inner
def _blend_row(air, altitude, table, offset, row):  # type: ignore[no-untyped-def]
    """The row (columns * 4,) of the transmittance at an altitude, as far as cells look at it.

    The sun of one observer moves little along a ray: only a small part of the row is needed.
    """
    low, high = offset[0], offset[0]
    for n in range(offset.size):
        low, high = min(low, offset[n]), max(high, offset[n])
    place = altitude_place(air, altitude) * (table.shape[0] - 1)
    i = min(int(place), table.shape[0] - 2)
    far = _f4(place - i)
    near = ONE - far
    # A cell looks at the column of its offset and the next, of four numbers each.
    first, last = np.uintp(low), np.uintp(high) + np.uintp(8)
    below, above, out = table[i][first:last], table[i + 1][first:last], row[first:last]
    for n in range(out.size):
        out[n] = below[n] * near + above[n] * far


@inner
def _place_suns(air, altitude, bins, b, columns, cells):  # type: ignore[no-untyped-def]
    """Where in a row of the transmittance each cell's sun is, seen from bin b.

    `across` becomes the share of the bin that the sun lights.
    """
    ground, top = air.ground_radius_m, air.top_altitude_m
    there = bins.centre[b, 1]
    r = ground + there
    squared = there * (2.0 * ground + there)
    whole = top * (2.0 * ground + top)
    inverse_r = _f4(1.0 / r)
    radius, distance = _f4(ground + altitude), _f4(bins.centre[b, 0])
    to_top = _f4((whole - squared) / (r * r))
    nearest = _f4((top - there) / r)
    span = (math.sqrt(squared) + math.sqrt(whole) - (top - there)) / r
    scale, last = _f4((columns - 1) / span), _f4(columns - 1.001)
    start, stop = _f4(bins.edge[b]), _f4(bins.edge[b + 1])
    per_metre = _OVER_ONE / max(stop - start, _f4(1e-30))
    mu_s, nu, begin, end = cells.mu_s, cells.nu, cells.shadow_from, cells.shadow_to
    for n in range(mu_s.size):
        cosine = (radius * mu_s[n] + distance * nu[n]) * inverse_r
        path = math.sqrt(cosine * cosine + to_top) - cosine
        column = min(last, max(ZERO, (path - nearest) * scale))
        i = np.int32(column)
        cells.along[n] = column - _f4(i)
        cells.offset[n] = i * np.int32(4)
        dark = (min(end[n], stop) - max(begin[n], start)) * per_metre
        cells.across[n] = ONE - min(max(dark, ZERO), ONE)


@inner
def _add_suns(row, weight, cells, once):  # type: ignore[no-untyped-def]
    """Add a bin's light to the cells; `weight` (4 * parts,) is per unit transmittance."""
    none, four, stride = np.uintp(0), np.uintp(4), np.uintp(4 * cells.offset.size)
    for n in range(cells.offset.size):
        place, offset = np.uintp(4 * n), np.uintp(cells.offset[n])
        far = cells.along[n] * cells.across[n]
        near = cells.across[n] - far
        add_two(once, place, row, offset, near, far, weight, none)
        add_two(once, place + stride, row, offset, near, far, weight, four)


@inner
def _add_suns_apart(row, weight, parts, cells, once):  # type: ignore[no-untyped-def]
    """The same of more parts than two."""
    count = cells.offset.size
    for n in range(count):
        offset = np.uintp(cells.offset[n])
        far = cells.along[n] * cells.across[n]
        near = cells.across[n] - far
        for k in range(parts):
            place = np.uintp(4 * (k * count + n))
            add_two(once, place, row, offset, near, far, weight, np.uintp(4 * k))


@inner
def apply_phases(cells, phase, once, out):  # type: ignore[no-untyped-def]
    """Light off molecules and particles times their phase functions, a table (n, 5) over
    sqrt((1 - nu) / 2)."""
    rayleigh, mie = once[: 4 * cells.nu.size], once[4 * cells.nu.size :]
    scale, last = _f4(phase.shape[0] - 1), _f4(phase.shape[0] - 1.001)
    one = np.uintp(1)
    for n in range(cells.nu.size):
        place = min(math.sqrt(max((ONE - cells.nu[n]) * HALF, ZERO)) * scale, last)
        i = np.uintp(place)
        far = place - _f4(i)
        molecules = phase[i, 0] + far * (phase[i + one, 0] - phase[i, 0])
        for c in range(4):
            aerosol = phase[i, c + 1] + far * (phase[i + one, c + 1] - phase[i, c + 1])
            out[4 * n + c] = rayleigh[4 * n + c] * molecules + mie[4 * n + c] * aerosol
