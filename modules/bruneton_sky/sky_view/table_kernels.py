"""Light along the rows of a sky-view table: the solver's ray bins, shared by a row's columns.

Spectra become colours here, row by row, while they are at hand. Importing this module imports
numba.
"""

import math

import numpy as np

from bruneton_sky.solver.bin_kernels import (
    Bins,
    empty_steps,
    fill_steps,
    merge_steps,
)
from bruneton_sky.solver.cell_kernels import (
    ONE,
    ZERO,
    add_four,
    empty_cells,
    fast,
    inner,
    making,
    set_suns,
)
from bruneton_sky.solver.first_order_kernels import gather_first
from bruneton_sky.solver.later_order_kernels import empty_slab, gather_later, sun_place
from bruneton_sky.solver.packed_bins import pack_bin

_f4 = np.float32
_SMALLEST = np.float32(1e-30)
_RAYLEIGH = np.float32(3.0 / (16.0 * math.pi))


@fast
def fill_row_bins(air, altitude, mu, hits, steps, fine, coarse):  # type: ignore[no-untyped-def]
    """Fill the bins of rays (rows,): `fine` for light scattered once, `coarse` for more.

    `steps`: how many fine steps they are merged of. `end` is that of the fine bins alone.
    """
    scratch = empty_steps(air, steps)
    for i in range(mu.size):
        fill_steps(air, altitude[i], mu[i], hits[i], scratch, fine.end[i])
        merge_steps(air, altitude[i], mu[i], scratch, _of_row(fine, i))
        merge_steps(air, altitude[i], mu[i], scratch, _of_row(coarse, i))


@making
def _of_row(bins, i):  # type: ignore[no-untyped-def]
    """The bins of one ray."""
    return Bins(bins.edge[i], bins.centre[i], bins.weight[i], bins.end[i])


@fast
def add_rows(  # type: ignore[no-untyped-def]
    air,
    altitude,
    mu,
    hits,
    mu_s,
    nu,
    transmittance,
    source,
    fine,
    coarse,
    colour,
    bands,
    kinds,
    ground,
    nodes,
):
    """Add the colours of four wavelengths along rays (rows,), for cells (rows, columns) of suns.

    `transmittance`, `source`: of a group of wavelengths of a `SourceField`. `fine`, `coarse`: see
    `fill_row_bins`. `colour` (4 * 4,): linear sRGB of the wavelengths.
    `bands` (4 * 4,): what of each is in each of the aerosol's bands. `kinds` (angles, kinds * 4):
    phase functions of the particles' kinds over that of the bands.
    `ground`: `GroundColours` of the group. `nodes` (rows, columns * 8) takes what the table
    holds, not yet as roots.
    """
    cells, slab = empty_cells(mu_s.shape[1]), empty_slab(source)
    row = np.empty(transmittance.shape[1], _f4)
    once = np.empty((4 + kinds.shape[1]) * mu_s.shape[1], _f4)
    more = np.empty(4 * mu_s.shape[1], _f4)
    for i in range(mu.size):
        set_suns(cells, mu_s[i], nu[i])
        own = _of_row(fine, i)
        gather_first(air, altitude[i], mu[i], own, cells, transmittance, row, once)
        more[:] = ZERO
        gather_later(air, altitude[i], _of_row(coarse, i), cells, source, slab, more)
        if kinds.shape[1] > 4:
            join_kinds(nu[i], kinds, once)
        _add_colours(once, more, nu[i], colour, bands, nodes[i])
        if hits[i]:
            _add_ground(air, altitude[i], mu_s[i], nu[i], own.end, ground, nodes[i])


@fast
def pack_rows(air, fine, coarse, out):  # type: ignore[no-untyped-def]
    """The bins of rays (rows,), see `fill_row_bins`, in the layout of shaders.

    `out` (rows, bins, BIN_FLOATS), zeros, takes the fine bins, then the coarse ones.
    """
    share, once = np.empty((4, 4)), fine.centre.shape[1]
    for i in range(len(out)):
        _pack(air, _of_row(fine, i), share, out[i, :once])
        _pack(air, _of_row(coarse, i), share, out[i, once:])


@inner
def _pack(air, bins, share, out):  # type: ignore[no-untyped-def]
    for b in range(len(out)):
        if bins.centre[b, 3] > 0.0:
            start, stop = bins.edge[b], bins.edge[b + 1]
            pack_bin(air, start, stop, bins.centre[b], bins.weight[b], share, out[b])


@inner
def join_kinds(nu, kinds, once):  # type: ignore[no-untyped-def]
    """Weigh the light of the particles' kinds in `once` by `kinds` (angles, kinds * 4), and put
    their sum in place of the first."""
    scale, last, cells = _f4(len(kinds) - 1), len(kinds) - 2, 4 * nu.size
    for n in range(nu.size):
        place = math.sqrt(max((ONE - nu[n]) * _f4(0.5), ZERO)) * scale
        i = min(int(place), last)
        far = place - _f4(i)
        for c in range(4):
            total = ZERO
            for k in range(kinds.shape[1] // 4):
                here, beside = kinds[i, 4 * k + c], kinds[i + 1, 4 * k + c]
                total += once[(k + 1) * cells + 4 * n + c] * (here + far * (beside - here))
            once[cells + 4 * n + c] = total


@inner
def _add_colours(once, more, nu, colour, bands, nodes):  # type: ignore[no-untyped-def]
    """Light scattered once by molecules and by aerosol, and more, as colours and bands."""
    none, far = np.uintp(0), np.uintp(8)
    for n in range(nu.size):
        phase = _RAYLEIGH * (ONE + nu[n] * nu[n])
        p, m = 4 * n, 4 * nu.size + 4 * n
        # The harmonics' sum may fall below zero by a trace where there is almost no light.
        add_four(
            nodes, np.uintp(8 * n), colour, none, far,
            phase * once[p] + max(more[p], ZERO),
            phase * once[p + 1] + max(more[p + 1], ZERO),
            phase * once[p + 2] + max(more[p + 2], ZERO),
            phase * once[p + 3] + max(more[p + 3], ZERO),
        )  # fmt: skip
        add_four(
            nodes, np.uintp(8 * n + 4), bands, none, far,
            once[m], once[m + 1], once[m + 2], once[m + 3],
        )  # fmt: skip


@inner
def _add_ground(air, altitude, mu_s, nu, end, ground, nodes):  # type: ignore[no-untyped-def]
    """The ground where a ray ends, seen through the air before it; `end`: see `Bins`."""
    radius = air.ground_radius_m
    start, along = _f4((radius + altitude) / radius), _f4(end[4] / radius)
    t0, t1, t2, t3 = _f4(end[0]), _f4(end[1]), _f4(end[2]), _f4(end[3])
    grid, last, light, far = ground.grid, ground.mu_s.size - 2, ground.light, np.uintp(8)
    for n in range(nu.size):
        sun = min(max(start * mu_s[n] + along * nu[n], -ONE), ONE)
        place = sun_place(sun, grid[0], grid[1], grid[2], grid[3]) * _f4(last + 1)
        i = min(int(place), last)
        rise = max(ground.mu_s[i + 1] - ground.mu_s[i], _SMALLEST)
        share = min(max((sun - ground.mu_s[i]) / rise, ZERO), ONE)
        near = ONE - share
        place, here, next_one = np.uintp(8 * n), np.uintp(16 * i), np.uintp(16 * i + 16)
        add_four(nodes, place, light, here, far, near * t0, near * t1, near * t2, near * t3)
        add_four(nodes, place, light, next_one, far, share * t0, share * t1, share * t2, share * t3)


@fast
def finish_rows(nu, phase, colour, nodes):  # type: ignore[no-untyped-def]
    """Turn the light (rows, columns * 8) into fourth roots; `phase`, `colour`: `AerosolBands`.

    A low sun's light off aerosol may lie outside the gamut, where bands are colours: what it lacks
    the rest makes up for.
    """
    scale, last = _f4(len(phase) - 1), len(phase) - 2
    for i in range(nu.shape[0]):
        for n in range(nu.shape[1]):
            node = nodes[i, 8 * n : 8 * n + 8]
            place = math.sqrt(max((ONE - nu[i, n]) * _f4(0.5), ZERO)) * scale
            k = min(int(place), last)
            far = place - _f4(k)
            for band in range(4):
                lacking = min(node[4 + band], ZERO)
                if lacking < ZERO:
                    here = phase[k, band] + far * (phase[k + 1, band] - phase[k, band])
                    for c in range(3):
                        node[c] += here * lacking * colour[band, c]
            for c in range(8):
                node[c] = math.sqrt(math.sqrt(max(node[c], ZERO)))
