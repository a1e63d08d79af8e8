"""Q and U of light that arrives at the solver's nodes: see `polarisation`.

The plane of a ray and the planet's centre is fixed along the ray, so that Q and U of its bins add
up as radiance does. The ground reflects light without polarisation and is left out.

Importing this module imports numba.
"""

import math

import numpy as np

from bruneton_sky.solver.cell_kernels import (
    ONE,
    ZERO,
    add_four,
    empty_cells,
    fast,
    fill_cells,
    inner,
)
from bruneton_sky.solver.first_order_kernels import apply_phases, gather_first
from bruneton_sky.solver.later_order_kernels import (
    Slab,
    add_mie,
    cell_extremes,
    empty_slab,
    place_cells,
    repeat_weights,
    set_bend,
    suns_in_sight,
)
from bruneton_sky.solver.node_kernels import bins_at

_f4 = np.float32
_TWO = np.float32(2.0)
_TINY = 1e-12


@fast
def first_polarised(air, altitude, mu, bins, table, sun, turn_cosine, phase, out):  # type: ignore[no-untyped-def]
    """Q and U (2, altitudes, mu, turns * suns * 4) of light scattered once.

    Arguments as for `node_kernels.first_radiance`; `phase` (altitudes or 1, n, 5) are P12.
    """
    cells = empty_cells(sun.size * turn_cosine.size)
    once, row = np.empty(8 * cells.nu.size, _f4), np.empty(table.shape[1], _f4)
    for i in range(mu.shape[0]):
        for q in range(mu.shape[1]):
            here = bins_at(bins, i, q, bins.centre.shape[2])
            fill_cells(mu[i, q], sun, turn_cosine, cells)
            gather_first(air, altitude[i], mu[i, q], here, cells, table, row, once)
            apply_phases(cells, phase[min(i, len(phase) - 1)], once, out[0, i, q])
            _turn_planes(mu[i, q], sun, turn_cosine, out[0, i, q], out[1, i, q])


@inner
def _turn_planes(mu, sun, turn_cosine, q, u):  # type: ignore[no-untyped-def]
    """From P12 light in `q`, by the scattering plane, to Q and U by the vertical plane.

    With chi from the direction of rising zenith angle (theta) to the scattering plane, which holds
    the sun: Q = cos(2 chi) P12, U = sin(2 chi) P12, tan(chi) = phi.sun / theta.sun.
    """
    sine = math.sqrt(max((1.0 - mu) * (1.0 + mu), 0.0))
    for p in range(turn_cosine.size):
        cosine = turn_cosine[p]
        turn_sine = math.sqrt(max((1.0 - cosine) * (1.0 + cosine), 0.0))
        for k in range(sun.size):
            across = math.sqrt(max((1.0 - sun[k]) * (1.0 + sun[k]), 0.0))
            theta, phi = mu * across * cosine - sine * sun[k], -across * turn_sine
            inverse = 1.0 / max(theta * theta + phi * phi, _TINY)
            double_cosine = _f4((theta * theta - phi * phi) * inverse)
            double_sine = _f4(2.0 * theta * phi * inverse)
            n = 4 * (p * sun.size + k)
            for c in range(4):
                light = q[n + c]
                q[n + c], u[n + c] = light * double_cosine, light * double_sine


@fast
def next_polarised(air, altitude, mu, bins, source, particles, sun, turn_cosine, out):  # type: ignore[no-untyped-def]
    """Q and U (2, altitudes, mu, turns * suns * 4) of light of a source function.

    `source` gives the molecules' light, the axes and the bends between suns; `particles` (2,
    altitudes, mu, azimuths, suns * 4): Q, and U over the sine of the azimuth.
    """
    cells, slab_q = empty_cells(sun.size * turn_cosine.size), empty_slab(source)
    slab_u = Slab(np.empty_like(slab_q.light), slab_q.rows, slab_q.bend, slab_q.tilt)
    out[:] = ZERO
    for i in range(mu.shape[0]):
        for q in range(mu.shape[1]):
            here = bins_at(bins, i, q, bins.centre.shape[2])
            fill_cells(mu[i, q], sun, turn_cosine, cells)
            extremes = cell_extremes(cells)
            for b in range(here.centre.shape[0]):
                if here.centre[b, 3] > 0.0:
                    first, last = suns_in_sight(air, altitude[i], here, b, extremes, source)
                    _blend(air, here, b, source, particles, 4 * first, 4 * last + 4, slab_q, slab_u)
                    place_cells(air, altitude[i], here, b, source, cells)
                    _add_cells(slab_q, slab_u, source, cells, out[0, i, q], out[1, i, q])


@inner
def _blend(air, bins, b, source, particles, low, high, slab_q, slab_u):  # type: ignore[no-untyped-def]
    """Fill the slabs' columns from `low` to `high` with Q, and U over the sine, of bin b."""
    mu = bins.centre[b, 2]
    i, u = set_bend(air, bins.centre[b, 1], source, low, high, slab_q)
    if source.rayleigh.shape[0] > 0:
        _set_molecules(source, i, u, mu, bins.weight[b, 0], low, high, slab_q, slab_u)
    else:
        slab_q.light[:] = ZERO
        slab_u.light[:] = ZERO
    if particles.shape[1] > 0:
        add_mie(particles[0], i, u, mu, bins.weight[b, 1], low, high, slab_q)
        add_mie(particles[1], i, u, mu, bins.weight[b, 1], low, high, slab_u)


@inner
def _set_molecules(source, i, u, mu, weight, low, high, slab_q, slab_u):  # type: ignore[no-untyped-def]
    """Q, and U over sin(phi), of molecules (see `polarisation`), polynomials in cos(phi)."""
    below, above = source.rayleigh[i], source.rayleigh[i + 1]
    b1, b2, b3 = below[1][low:high], below[2][low:high], below[3][low:high]
    a1, a2, a3 = above[1][low:high], above[2][low:high], above[3][low:high]
    row1, row2 = slab_q.rows[0][low:high], slab_q.rows[1][low:high]
    row3, weights = slab_q.rows[2][low:high], slab_q.rows[3][low:high]
    repeat_weights(weight, weights)
    far = _f4(u)
    near = ONE - far
    for n in range(row1.size):
        row1[n] = weights[n] * (near * b1[n] + far * a1[n])
        row2[n] = weights[n] * (near * b2[n] + far * a2[n])
        row3[n] = weights[n] * (near * b3[n] + far * a3[n])
    across = max((1.0 - mu) * (1.0 + mu), 0.0)
    sine = math.sqrt(across)
    k1, k2, k3 = _f4(-3.0 * across), _f4(sine * mu), _f4(1.0 + mu * mu)
    k4, k5 = _f4(-sine), _f4(4.0 * mu)
    columns = slab_q.rows.shape[1]
    for t in range(source.azimuth_cosine.size):
        cosine, start = source.azimuth_cosine[t], t * columns
        out_q, out_u = (
            slab_q.light[start + low : start + high],
            slab_u.light[start + low : start + high],
        )
        q2, q3, u3 = cosine * k2, (ONE - _TWO * cosine * cosine) * k3, cosine * k5
        for n in range(out_q.size):
            out_q[n] = k1 * row1[n] + q2 * row2[n] + q3 * row3[n]
            out_u[n] = k4 * row2[n] + u3 * row3[n]


@inner
def _add_cells(slab_q, slab_u, source, cells, out_q, out_u):  # type: ignore[no-untyped-def]
    """Add a bin's Q and U to the cells, as `later_order_kernels._add_cells` does radiance."""
    next_row, suns = np.uintp(slab_q.rows.shape[1]), np.int32(slab_q.rows.shape[1] // 4)
    per_turn = ONE / _f4(source.azimuth_cosine.size - 1)
    for n in range(cells.offset.size):
        place, offset = np.uintp(4 * n), np.uintp(cells.offset[n])
        sun, k, t = np.uintp(cells.sun[n]), cells.along[n], cells.across[n]
        tilted = ONE + slab_q.tilt[sun] * (ONE - k - k)
        moved = source.pace[sun] * cells.moved[n]
        level = ONE - slab_q.bend[sun] * (tilted * k * (ONE - k) - moved)
        k *= level
        w11 = k * t
        w10, w01 = t * level - w11, k - w11
        w00 = level - k - w10
        add_four(out_q, place, slab_q.light, offset, next_row, w00, w01, w10, w11)
        # The sine of the azimuth, of which the place is the sine of half of it.
        half = (_f4((cells.offset[n] // np.int32(4)) // suns) + t) * per_turn
        sine = _TWO * half * math.sqrt(max((ONE - half) * (ONE + half), ZERO))
        add_four(
            out_u, place, slab_u.light, offset, next_row,
            sine * w00, sine * w01, sine * w10, sine * w11,
        )  # fmt: skip
