"""Light scattered again: the source function at every bin of a ray, for many suns at once.

A bin has one altitude and one direction: the source function is blended to these once, with
the bin's weights folded in, and leaves a slab (azimuth, sun * 4) in which each cell of the bin
is then looked up bilinearly.

Importing this module imports numba.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.solver.between_suns import SUN_TILT
from bruneton_sky.solver.cell_kernels import (
    HALF,
    ONE,
    ZERO,
    add_four,
    add_weighed,
    inner,
    making,
    set_polynomial,
)
from bruneton_sky.solver.ray_kernels import altitude_place

_f4 = np.float32
_TINY, _TILT = np.float32(1e-9), np.float32(SUN_TILT)


class Source(NamedTuple):
    """The source function as the kernels take it, float32.

    `rayleigh` (altitudes, 4, suns * 4): coefficients of 1, 3 mu^2 - 1, mu sin(theta) cos(phi)
    and sin^2(theta) cos(2 phi). `mie` (altitudes, mu, azimuths, suns * 4). An array without
    altitudes is left out. `azimuth_cosine` (azimuths,), `grid` (4,): see `SunGrid.constants`.
    `bend` (altitudes, suns): half the second difference of the light between a sun and the next,
    over the light; `pace` (suns,): 1 / 12 of the squared number of nodes in a unit of mu_s there.
    """

    rayleigh: NDArray[np.float32]
    mie: NDArray[np.float32]
    azimuth_cosine: NDArray[np.float32]
    grid: NDArray[np.float32]
    bend: NDArray[np.float32]
    pace: NDArray[np.float32]


class Slab(NamedTuple):
    """Scratch of `gather_later`: `light` (azimuths * suns * 4,), `rows` (4, suns * 4), `bend` and
    `tilt` (suns,): see `between_suns.SUN_TILT`."""

    light: NDArray[np.float32]
    rows: NDArray[np.float32]
    bend: NDArray[np.float32]
    tilt: NDArray[np.float32]


@making
def empty_slab(source):  # type: ignore[no-untyped-def]
    """Arrays for the light of one bin."""
    columns = source.rayleigh.shape[2]
    light, rows = np.empty(source.azimuth_cosine.size * columns, _f4), np.empty((4, columns), _f4)
    bend, tilt = np.empty(columns // 4, _f4), np.empty(columns // 4, _f4)
    return Slab(light, rows, bend, tilt)


@inner
def gather_later(air, altitude, bins, cells, source, slab, out):  # type: ignore[no-untyped-def]
    """Add light of the source function along a ray to the cells (cells * 4,)."""
    extremes = cell_extremes(cells)
    for b in range(bins.centre.shape[0]):
        if bins.centre[b, 3] > 0.0:
            first, last = suns_in_sight(air, altitude, bins, b, extremes, source)
            _blend(air, bins, b, source, 4 * first, 4 * last + 4, slab)
            place_cells(air, altitude, bins, b, source, cells)
            _add_cells(slab, source.pace, cells, out)


@inner
def sun_place(mu_s, grid0, grid1, grid2, grid3):  # type: ignore[no-untyped-def]
    """Place in [0, 1] on the solver's axis of suns; see `grid.SunGrid`."""
    d = math.sqrt(ONE - mu_s) - grid0
    return min(max((grid2 - d / (grid1 + abs(d))) * grid3, ZERO), ONE)


@inner
def cell_extremes(cells):  # type: ignore[no-untyped-def]
    """Lowest and highest mu_s, lowest and highest nu of the cells."""
    low, high, least, most = ONE, -ONE, ONE, -ONE
    for n in range(cells.mu_s.size):
        low, high = min(low, cells.mu_s[n]), max(high, cells.mu_s[n])
        least, most = min(least, cells.nu[n]), max(most, cells.nu[n])
    return low, high, least, most


@inner
def suns_in_sight(air, altitude, bins, b, extremes, source):  # type: ignore[no-untyped-def]
    """First and last node of the suns that the cells can see from a bin, given their extremes."""
    inverse_r = _f4(1.0 / (air.ground_radius_m + bins.centre[b, 1]))
    radius, distance = _f4(air.ground_radius_m + altitude), _f4(bins.centre[b, 0])
    low = (radius * extremes[0] + distance * extremes[2]) * inverse_r
    high = (radius * extremes[1] + distance * extremes[3]) * inverse_r
    grid, suns = source.grid, source.rayleigh.shape[2] // 4
    places = suns - 1
    first = int(sun_place(min(max(low, -ONE), ONE), grid[0], grid[1], grid[2], grid[3]) * places)
    last = int(sun_place(min(high, ONE), grid[0], grid[1], grid[2], grid[3]) * places) + 1
    # One more on either side: the places of the cells are rounded in their own way.
    return max(min(first - 1, suns - 2), 0), min(last + 1, suns - 1)


@inner
def _blend(air, bins, b, source, low, high, slab):  # type: ignore[no-untyped-def]
    """Fill a slab's columns from `low` to `high` with the light of bin b."""
    mu = bins.centre[b, 2]
    i, u = set_bend(air, bins.centre[b, 1], source, low, high, slab)
    if source.rayleigh.shape[0] > 0:
        _set_rayleigh(source, i, u, mu, bins.weight[b, 0], low, high, slab)
    else:
        slab.light[:] = ZERO
    if source.mie.shape[0] > 0:
        add_mie(source.mie, i, u, mu, bins.weight[b, 1], low, high, slab)


@inner
def set_bend(air, altitude, source, low, high, slab):  # type: ignore[no-untyped-def]
    """Fill a slab's `bend` and `tilt` at an altitude; its node below and the share of the next."""
    count = source.bend.shape[0]
    place = altitude_place(air, altitude) * (count - 1)
    i = min(int(place), count - 2)
    u = place - i
    near, far = _f4(1.0 - u), _f4(u)
    for k in range(low // 4, high // 4):
        slab.bend[k] = near * source.bend[i, k] + far * source.bend[i + 1, k]
        slab.tilt[k] = _TILT * math.sqrt(max(slab.bend[k], ZERO))
    return i, u


@inner
def _set_rayleigh(source, i, u, mu, weight, low, high, slab):  # type: ignore[no-untyped-def]
    """The source function of molecules, a polynomial in cos(phi), times their weight.

    Here and below, rows are cut to [low, high) before the loops over them: an index that might
    be negative, or a stride that might not be one, would not vectorise.
    """
    below, above = source.rayleigh[i], source.rayleigh[i + 1]
    b0, b1, b2, b3 = below[0][low:high], below[1][low:high], below[2][low:high], below[3][low:high]
    a0, a1, a2, a3 = above[0][low:high], above[1][low:high], above[2][low:high], above[3][low:high]
    row0, row1, row2 = slab.rows[0][low:high], slab.rows[1][low:high], slab.rows[2][low:high]
    weights = slab.rows[3][low:high]
    repeat_weights(weight, weights)
    across = (1.0 - mu) * (1.0 + mu)
    k1, k2 = _f4(3.0 * mu * mu - 1.0), _f4(mu * math.sqrt(max(across, 0.0)))
    k3, far = _f4(across), _f4(u)
    near = ONE - far
    for n in range(row0.size):
        twice = k3 * (near * b3[n] + far * a3[n])
        level = near * b0[n] + far * a0[n] + k1 * (near * b1[n] + far * a1[n])
        row0[n] = weights[n] * (level - twice)
        row1[n] = weights[n] * k2 * (near * b2[n] + far * a2[n])
        row2[n] = weights[n] * (twice + twice)
    columns, four = np.uintp(slab.rows.shape[1]), np.uintp(4)
    for t in range(source.azimuth_cosine.size):
        first = np.uintp(t) * columns + np.uintp(low)
        for k in range(np.uintp(row0.size) // four):
            at = four * k
            set_polynomial(slab.light, first + at, (row0, row1, row2), at, source.azimuth_cosine[t])


@inner
def add_mie(table, i, u, mu, weight, low, high, slab):  # type: ignore[no-untyped-def]
    """Add the source function of aerosol, times its weight."""
    place = (0.5 * mu + 0.5) * (table.shape[1] - 1)
    j = min(int(place), table.shape[1] - 2)
    v = place - j
    w00, w01 = _f4((1.0 - u) * (1.0 - v)), _f4((1.0 - u) * v)
    w10, w11 = _f4(u * (1.0 - v)), _f4(u * v)
    weights = slab.rows[3]
    repeat_weights(weight, weights[:4])
    tables = (
        table[i, j].reshape(-1), table[i, j + 1].reshape(-1),
        table[i + 1, j].reshape(-1), table[i + 1, j + 1].reshape(-1),
    )  # fmt: skip
    columns, four = np.uintp(slab.rows.shape[1]), np.uintp(4)
    for t in range(table.shape[2]):
        first = np.uintp(t) * columns + np.uintp(low)
        for k in range(np.uintp(high - low) // four):
            at = first + four * k
            add_weighed(slab.light, at, weights, tables, at, w00, w01, w10, w11)


@inner
def repeat_weights(weight, row):  # type: ignore[no-untyped-def]
    """The weights (4,) for every sun."""
    for n in range(row.size // 4):
        for c in range(4):
            row[4 * n + c] = weight[c]


@inner
def place_cells(air, altitude, bins, b, source, cells):  # type: ignore[no-untyped-def]
    """Where in a slab each cell is, seen from bin b: the sun moves as the ray leaves its start."""
    inverse_r = _f4(1.0 / (air.ground_radius_m + bins.centre[b, 1]))
    radius, distance = _f4(air.ground_radius_m + altitude), _f4(bins.centre[b, 0])
    cosine = bins.centre[b, 2]
    mu = _f4(cosine)
    inverse_sine = _f4(1.0 / math.sqrt(max((1.0 - cosine) * (1.0 + cosine), 1e-9)))
    suns, azimuths = source.rayleigh.shape[2] // 4, source.azimuth_cosine.size
    last_sun, last_turn = _f4(suns - 1.001), _f4(azimuths - 1.001)
    sun_scale, turn_scale = _f4(suns - 1), _f4(azimuths - 1)
    row = np.int32(suns)
    grid0, grid1, grid2, grid3 = source.grid[0], source.grid[1], source.grid[2], source.grid[3]
    mu_s, nu = cells.mu_s, cells.nu
    per_length = _f4((bins.edge[b + 1] - bins.edge[b]) * inverse_r)
    for n in range(mu_s.size):
        sun = min(ONE, max(-ONE, (radius * mu_s[n] + distance * nu[n]) * inverse_r))
        moved = (nu[n] - mu * sun) * per_length
        k = min(last_sun, sun_place(sun, grid0, grid1, grid2, grid3) * sun_scale)
        sines = max((ONE - sun) * (ONE + sun), _TINY)
        turn = min(ONE, max(-ONE, (nu[n] - mu * sun) * inverse_sine / math.sqrt(sines)))
        t = min(last_turn, math.sqrt((ONE - turn) * HALF) * turn_scale)
        i, j = np.int32(k), np.int32(t)
        cells.along[n], cells.across[n], cells.moved[n] = k - _f4(i), t - _f4(j), moved * moved
        cells.offset[n], cells.sun[n] = (j * row + i) * np.int32(4), i


@inner
def _add_cells(slab, pace, cells, out):  # type: ignore[no-untyped-def]
    """Add a bin's light to the cells.

    Of light that falls by a factor with every degree, lines are too bright between their nodes, and
    the centre of a bin is too dark: `level` is the light over both.
    """
    next_row = np.uintp(slab.rows.shape[1])
    for n in range(cells.offset.size):
        place, offset = np.uintp(4 * n), np.uintp(cells.offset[n])
        sun, k, t = np.uintp(cells.sun[n]), cells.along[n], cells.across[n]
        tilted = ONE + slab.tilt[sun] * (ONE - k - k)
        level = ONE - slab.bend[sun] * (tilted * k * (ONE - k) - pace[sun] * cells.moved[n])
        k *= level
        w11 = k * t
        w10, w01 = t * level - w11, k - w11
        add_four(out, place, slab.light, offset, next_row, level - k - w10, w01, w10, w11)
