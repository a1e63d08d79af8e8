"""Radiance that arrives at the solver's nodes, from all directions and for all suns.

Importing this module imports numba.
"""

import math

import numpy as np

from bruneton_sky.solver.bin_kernels import Bins, empty_steps, fill_steps, merge_steps
from bruneton_sky.solver.cell_kernels import ONE, ZERO, empty_cells, fast, fill_cells, inner, making
from bruneton_sky.solver.first_order_kernels import apply_phases, gather_first
from bruneton_sky.solver.later_order_kernels import empty_slab, gather_later, sun_place
from bruneton_sky.solver.ray_kernels import altitude_along, altitude_place, ray_length

_f4 = np.float32
# A ray gets all bins if it crosses all altitudes, or if the sun sinks by _FAR_RAD along it; and at
# least _FEWEST_BINS.
_FAR_RAD, _FEWEST_BINS = 0.1, 3


@fast
def bin_nodes(air, altitude, mu, downward, steps, bins, later):  # type: ignore[no-untyped-def]
    """Bins of the rays from all nodes, twice: as in `Bins`, with axes (altitudes, mu) before.

    A ray that crosses a part of the air gets as large a part of its bins: along it the source
    function changes as much less. Returns the number of bins left out.
    """
    scratch, left_out = empty_steps(air, steps), 0
    for i in range(mu.shape[0]):
        for q in range(mu.shape[1]):
            fill_steps(air, altitude[i], mu[i, q], downward[q], scratch, bins.end[i, q])
            for c in range(bins.end.shape[2]):
                later.end[i, q, c] = bins.end[i, q, c]
            share = _share_crossed(air, altitude[i], mu[i, q], downward[q])
            for some in (bins, later):
                most = some.centre.shape[2]
                count = min(max(int(most * share + 1.0), _FEWEST_BINS), most)
                here = bins_at(some, i, q, count)
                merge_steps(air, altitude[i], mu[i, q], scratch, here)
                _leave_rest_empty(bins_at(some, i, q, most), count)
                left_out += most - count
    return left_out


@inner
def _leave_rest_empty(bins, count):  # type: ignore[no-untyped-def]
    """Give all bins after the first `count` neither length nor matter."""
    bins.edge[count + 1 :] = bins.edge[count]
    bins.weight[count:] = 0.0
    bins.centre[count:] = 0.0
    bins.centre[count:, 0] = bins.edge[count]


@inner
def _share_crossed(air, altitude, mu, hits):  # type: ignore[no-untyped-def]
    """Share of the source function's axes that a ray crosses: altitudes, and suns by its length."""
    radius, start = air.ground_radius_m + altitude, altitude_place(air, altitude)
    suns = ray_length(air, altitude, mu, hits) / (radius * _FAR_RAD)
    if hits:
        return start + suns
    if mu >= 0.0:
        return 1.0 - start + suns
    lowest = max(altitude_along(radius, altitude, mu, -radius * mu), 0.0)
    return start + 1.0 - 2.0 * altitude_place(air, lowest) + suns


@making
def bins_at(bins, i, q, count):  # type: ignore[no-untyped-def]
    """The first `count` bins of a node's ray."""
    edge, centre = bins.edge[i, q, : count + 1], bins.centre[i, q, :count]
    return Bins(edge, centre, bins.weight[i, q, :count], bins.end[i, q])


@fast
def first_radiance(  # type: ignore[no-untyped-def]
    air, altitude, mu, downward, bins, table, sun, turn_cosine, phase, ground, grid, radiance
):
    """Light scattered once, and sunlight from the ground: (altitudes, mu, turns * suns * 4).

    `phase` (altitudes or 1, n, 5): see `apply_phases`.
    """
    cells = empty_cells(sun.size * turn_cosine.size)
    once = np.empty(8 * cells.nu.size, _f4)
    row = np.empty(table.shape[1], _f4)
    for i in range(mu.shape[0]):
        for q in range(mu.shape[1]):
            here = bins_at(bins, i, q, bins.centre.shape[2])
            fill_cells(mu[i, q], sun, turn_cosine, cells)
            gather_first(air, altitude[i], mu[i, q], here, cells, table, row, once)
            apply_phases(cells, phase[min(i, len(phase) - 1)], once, radiance[i, q])
            if downward[q]:
                _add_ground(air, altitude[i], here, cells, ground, grid, radiance[i, q])


@fast
def next_radiance(  # type: ignore[no-untyped-def]
    air, altitude, mu, downward, bins, source, sun, turn_cosine, ground, radiance
):
    """Light of a source function, and of the ground: (altitudes, mu, turns * suns * 4)."""
    cells = empty_cells(sun.size * turn_cosine.size)
    slab = empty_slab(source)
    radiance[:] = ZERO
    for i in range(mu.shape[0]):
        for q in range(mu.shape[1]):
            here = bins_at(bins, i, q, bins.centre.shape[2])
            fill_cells(mu[i, q], sun, turn_cosine, cells)
            gather_later(air, altitude[i], here, cells, source, slab, radiance[i, q])
            if downward[q]:
                _add_ground(air, altitude[i], here, cells, ground, source.grid, radiance[i, q])


@making
def _add_ground(air, altitude, bins, cells, ground, grid, out):  # type: ignore[no-untyped-def]
    """Add what the ground at the ray's end reflects: `ground` (suns, 4) is its irradiance."""
    factor, brightest = np.empty(4, _f4), ZERO
    for c in range(4):
        factor[c] = air.ground_albedo[c] / math.pi * bins.end[c]
        brightest = max(brightest, factor[c])
    if brightest == ZERO:
        return
    radius = _f4(1.0 + altitude / air.ground_radius_m)
    distance = _f4(bins.end[4] / air.ground_radius_m)
    scale, last = _f4(ground.shape[0] - 1), _f4(ground.shape[0] - 1.001)
    one = np.uintp(1)
    for n in range(cells.nu.size):
        sun = min(ONE, max(-ONE, radius * cells.mu_s[n] + distance * cells.nu[n]))
        k = min(last, sun_place(sun, grid[0], grid[1], grid[2], grid[3]) * scale)
        i = np.uintp(k)
        far = k - _f4(i)
        for c in range(4):
            value = ground[i, c] + far * (ground[i + one, c] - ground[i, c])
            out[4 * n + c] += factor[c] * value
