"""Light of a solved field along rays of one observer, over the sky, and along a table's rays.

Importing this module imports numba.
"""

import math

import numpy as np

from bruneton_sky.solver.bin_kernels import (
    empty_bins,
    empty_steps,
    fill_bins,
    merge_steps,
)
from bruneton_sky.solver.cell_kernels import (
    ONE,
    ZERO,
    empty_cells,
    fast,
    fill_cells,
    inner,
    some_cells,
)
from bruneton_sky.solver.first_order_kernels import apply_phases, gather_first
from bruneton_sky.solver.later_order_kernels import empty_slab, gather_later
from bruneton_sky.solver.ray_kernels import hits_ground

_f4 = np.float32


@fast
def trace_view(air, altitude, mu, mu_s, nu, source, sizes, out):  # type: ignore[no-untyped-def]
    """Radiance (rays * 4,) of orders two and up along mu (rays,) with the sun at mu_s, nu (rays,).

    Neighbours of the same mu share their bins. `sizes`: steps, bins.
    """
    bins, steps = empty_bins(sizes[1]), empty_steps(air, sizes[0])
    slab, all_cells = empty_slab(source), empty_cells(mu.size)
    all_cells.mu_s[:] = mu_s
    for k in range(nu.size):
        all_cells.nu[k] = nu[k]
    out[:] = ZERO
    start = 0
    while start < mu.size:
        stop = _end_of_run(mu, start)
        cells = some_cells(all_cells, start, stop)
        hits = hits_ground(air, altitude, mu[start])
        fill_bins(air, altitude, mu[start], hits, steps, bins)
        gather_later(air, altitude, bins, cells, source, slab, out[4 * start : 4 * stop])
        start = stop


@fast
def trace_first(air, altitude, mu, mu_s, nu, table, sizes, out):  # type: ignore[no-untyped-def]
    """Light (parts, rays * 4) scattered once, over phase functions.

    Parts as in `gather_first`. Arguments as for `trace_view`; `table` is the sun's transmittance.
    """
    bins, steps = empty_bins(sizes[1]), empty_steps(air, sizes[0])
    row, all_cells = np.empty(table.shape[1], _f4), empty_cells(mu.size)
    all_cells.mu_s[:] = mu_s
    for k in range(nu.size):
        all_cells.nu[k] = nu[k]
    start = 0
    while start < mu.size:
        stop = _end_of_run(mu, start)
        hits = hits_ground(air, altitude, mu[start])
        fill_bins(air, altitude, mu[start], hits, steps, bins)
        cells, count = some_cells(all_cells, start, stop), 4 * (stop - start)
        once = np.empty(out.shape[0] * count, _f4)
        gather_first(air, altitude, mu[start], bins, cells, table, row, once)
        for k in range(out.shape[0]):
            for m in range(count):
                out[k, 4 * start + m] = once[k * count + m]
        start = stop


@inner
def _end_of_run(values, start):  # type: ignore[no-untyped-def]
    """Where the equal values that begin at `start` end."""
    stop = start + 1
    while stop < values.size and values[stop] == values[start]:
        stop += 1
    return stop


@fast
def fill_irradiance(  # type: ignore[no-untyped-def]
    air, altitude, mu, weight, sun, turn_cosine, phase, table, source, sizes, out
):
    """Irradiance (altitudes, suns, 4) of level surfaces by the sky of all orders.

    `mu` (n,) are upward directions, `weight` (n,) what each adds per azimuth. `phase`
    (altitudes, n, 5): see `apply_phases`. `sizes`: steps, bins.
    """
    bins, steps = empty_bins(sizes[1]), empty_steps(air, sizes[0])
    slab, cells = empty_slab(source), empty_cells(sun.size * turn_cosine.size)
    once = np.empty(8 * cells.nu.size, _f4)
    light, row = np.empty(4 * cells.nu.size, _f4), np.empty(table.shape[1], _f4)
    out[:] = 0.0
    for i in range(altitude.size):
        for q in range(mu.size):
            fill_bins(air, altitude[i], mu[q], mu[q] < 0.0, steps, bins)
            fill_cells(mu[q], sun, turn_cosine, cells)
            gather_first(air, altitude[i], mu[q], bins, cells, table, row, once)
            apply_phases(cells, phase[i], once, light)
            gather_later(air, altitude[i], bins, cells, source, slab, light)
            for n in range(cells.nu.size):
                for c in range(4):
                    out[i, n % sun.size, c] += weight[q] * light[4 * n + c]


@fast
def march_rays(air, altitude, mu, hits, mu_s, nu, table, source, sizes, first, scattering, mie):  # type: ignore[no-untyped-def]
    """Fill scattering and single Mie (altitudes, mu, nu, mu_s, C) from wavelength `first` on.

    `mu` (altitudes, mu) and `hits` (mu,): the rays; `mu_s`, `nu`: the suns. A nu that mu and
    mu_s do not allow is moved to the nearest that they do: most of those fall together, and
    are computed once. `sizes`: steps, bins of light scattered once, bins of later orders.
    """
    steps = empty_steps(air, sizes[0])
    few, many = empty_bins(sizes[2]), empty_bins(sizes[1])
    all_cells, slab = empty_cells(mu_s.size * nu.size), empty_slab(source)
    where = np.empty(mu_s.size * nu.size, np.intp)
    all_once = np.empty(8 * where.size, _f4)
    later, row = np.empty(4 * where.size, _f4), np.empty(table.shape[1], _f4)
    for i in range(mu.shape[0]):
        for j in range(mu.shape[1]):
            count = _distinct_cells(mu[i, j], mu_s, nu, all_cells, where)
            cells = some_cells(all_cells, 0, count)
            fill_bins(air, altitude[i], mu[i, j], hits[j], steps, many)
            once = all_once[: 8 * count]
            gather_first(air, altitude[i], mu[i, j], many, cells, table, row, once)
            merge_steps(air, altitude[i], mu[i, j], steps, few)
            later[:] = ZERO
            gather_later(air, altitude[i], few, cells, source, slab, later)
            _store(nu, where, once, later, first, scattering[i, j], mie[i, j])


@inner
def _distinct_cells(mu, mu_s, nu, cells, where):  # type: ignore[no-untyped-def]
    """Cells of all allowed nu and mu_s without repetition; `where` (nu * mu_s,) each is."""
    count = 0
    for n in range(nu.size):
        for k in range(mu_s.size):
            sines = math.sqrt((1.0 - mu) * (1.0 + mu) * (1.0 - mu_s[k]) * (1.0 + mu_s[k]))
            cosine = min(max(nu[n], mu * mu_s[k] - sines), mu * mu_s[k] + sines)
            index = n * mu_s.size + k
            if n > 0 and _f4(cosine) == cells.nu[where[index - mu_s.size]]:
                where[index] = where[index - mu_s.size]
            else:
                cells.mu_s[count], cells.nu[count] = mu_s[k], cosine
                where[index] = count
                count += 1
    return count


@inner
def _store(nu, where, once, later, first, scattering, mie):  # type: ignore[no-untyped-def]
    """One ray of both tables (nu, mu_s, C): later orders over Rayleigh's phase function.

    That is of the node's own nu, which a look-up multiplies by, also where mu and mu_s do not allow
    it and the light is that of the nearest nu that they do: over the phase function there, as
    published, look-ups between such a node and another err by up to 8 % of all light. The
    harmonics' sum may fall below zero by a trace where there is almost no light.
    """
    suns, lanes = scattering.shape[1], min(scattering.shape[2] - first, 4)
    rayleigh_phase = _f4(3.0 / (16.0 * math.pi))
    for index in range(where.size):
        n, cosine = where[index], _f4(nu[index // suns])
        inverse = ONE / (rayleigh_phase * (ONE + cosine * cosine))
        for c in range(lanes):
            total = once[4 * n + c] + max(later[4 * n + c], ZERO) * inverse
            scattering[index // suns, index % suns, first + c] = total
            mie[index // suns, index % suns, first + c] = once[once.size // 2 + 4 * n + c]
