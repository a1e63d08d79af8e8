"""Cells: the suns for which a ray is looked along, all at once.

A cell is one sun as seen from a ray: its zenith cosine mu_s at the ray's start, and the cosine
nu of the angle between them, which stays the same along the ray. Cells come in long arrays, so
that the compiler works on sixteen at a time: a first pass finds where each lies in a table, a
second adds what is there, taking the four wavelengths of a cell as one register.

Importing this module imports numba.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.njit import njit

_OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": True}
# For kernels that only kernels call: without the wrappers for Python they compile faster.
_NO_WRAPPERS: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
fast = njit(nogil=True, **_OPTIONS)
inner = njit(**_NO_WRAPPERS, **_OPTIONS)
_f4 = np.float32
ZERO, HALF, ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)


class Cells(NamedTuple):
    """Arrays over cells (n,), float32 but for `offset`.

    `mu_s`, `nu`: the suns. The rest is scratch of the passes: `offset` into a table, the
    shares `along` and `across` of the next nodes, and `shadow_from`, `shadow_to`, the
    distances between which the ray lies in the planet's shadow.
    """

    mu_s: NDArray[np.float32]
    nu: NDArray[np.float32]
    offset: NDArray[np.int32]
    along: NDArray[np.float32]
    across: NDArray[np.float32]
    shadow_from: NDArray[np.float32]
    shadow_to: NDArray[np.float32]


@inner
def empty_cells(count):  # type: ignore[no-untyped-def]
    """Room for so many cells."""
    return Cells(
        np.empty(count, _f4), np.empty(count, _f4), np.empty(count, np.int32),
        np.empty(count, _f4), np.empty(count, _f4), np.empty(count, _f4), np.empty(count, _f4),
    )  # fmt: skip


@inner
def some_cells(cells, start, stop):  # type: ignore[no-untyped-def]
    """The cells from `start` to before `stop`."""
    return Cells(
        cells.mu_s[start:stop], cells.nu[start:stop], cells.offset[start:stop],
        cells.along[start:stop], cells.across[start:stop],
        cells.shadow_from[start:stop], cells.shadow_to[start:stop],
    )  # fmt: skip


@inner
def fill_cells(mu, sun, turn_cosine, cells):  # type: ignore[no-untyped-def]
    """All suns (n,) at all azimuths from the view, azimuth first, as seen along mu."""
    sine = math.sqrt(max((1.0 - mu) * (1.0 + mu), 0.0))
    for k in range(sun.size):
        across = sine * math.sqrt(max((1.0 - sun[k]) * (1.0 + sun[k]), 0.0))
        for p in range(turn_cosine.size):
            cells.mu_s[p * sun.size + k] = sun[k]
            cells.nu[p * sun.size + k] = mu * sun[k] + across * turn_cosine[p]
