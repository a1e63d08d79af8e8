"""Light along the rows of a sky-view table: the solver's ray bins, shared by a row's columns.

Importing this module imports numba.
"""

import numpy as np

from bruneton_sky.solver.cells_kernels import ZERO, empty_cells, fast
from bruneton_sky.solver.ray_bins_kernels import (
    STEP_COLUMNS,
    empty_bins,
    fill_steps,
    merge_steps,
)
from bruneton_sky.solver.source_kernels import empty_slab, gather_later
from bruneton_sky.solver.sun_kernels import gather_first


@fast
def trace_rows(  # type: ignore[no-untyped-def]
    air, altitude, mu, hits, mu_s, nu, transmittance, source, counts, once, more, end
):
    """Light scattered once and more along rays (rows,), for cells (rows, columns) of suns.

    `transmittance`, `source`: of a group of wavelengths of a `SourceField`. `counts`: steps,
    bins for light scattered once, bins for more. `once` (2, rows, columns * 4) takes what
    molecules and aerosol scatter, without phase functions; `more` (rows, columns * 4); `end`
    (rows, 5) the transmittance of the rays and their lengths in m.
    """
    steps = np.empty((counts[0], STEP_COLUMNS))
    fine, coarse = empty_bins(counts[1]), empty_bins(counts[2])
    cells, slab = empty_cells(mu_s.shape[1]), empty_slab(source)
    row = np.empty(transmittance.shape[1], np.float32)
    more[:] = ZERO
    for i in range(mu.size):
        cells.mu_s[:] = mu_s[i]
        cells.nu[:] = nu[i]
        fill_steps(air, altitude[i], mu[i], hits[i], steps, end[i])
        merge_steps(air, altitude[i], mu[i], steps, fine)
        rayleigh, mie = once[0, i], once[1, i]
        gather_first(air, altitude[i], mu[i], fine, cells, transmittance, row, rayleigh, mie)
        merge_steps(air, altitude[i], mu[i], steps, coarse)
        gather_later(air, altitude[i], coarse, cells, source, slab, more[i])
