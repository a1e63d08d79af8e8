"""Aerosol in its layers and fog's droplets together: their phase functions where they scatter.

Orders two and up know one kind of particle besides molecules: its phase function is the mean by
what each kind scatters at an altitude. Light that is shown scattered once keeps the kinds apart
along its ray; it is kept over a phase function that changes as fast with the angle as theirs, the
mean of all that lies above the eye.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import particles_phase
from bruneton_sky.solver.delta_m import forward_shares, kept_coefficients, thinned
from bruneton_sky.solver.wavelength_groups import in_lanes
from vrut_lite.numeric_types import FloatArray

# Nodes of the phase functions in sqrt((1 - nu) / 2): linear interpolation errs by 1e-5 at g = 0.8.
_PHASE_NODES = 1024
_TINY = 1e-300


def kinds_of(atmosphere: Atmosphere) -> tuple[str, ...]:
    """The kinds whose light is kept apart: one for all where they share a phase function."""
    if not atmosphere.mixed:
        return ("aerosol",)
    more = ("fog",) * atmosphere.foggy + ("stratosphere",) * atmosphere.has_stratosphere
    return "aerosol", "aloft", *more


def shares_at(atmosphere: Atmosphere, degree: int, altitude_m: ArrayLike) -> FloatArray:
    """Share (..., kinds, C) of each kind in what particles scatter at altitudes (...,)."""
    return _shares(atmosphere, degree, altitude_m, False)


def shares_above(atmosphere: Atmosphere, degree: int, altitude_m: ArrayLike) -> FloatArray:
    """The same of all that lies above."""
    return _shares(atmosphere, degree, altitude_m, True)


def _shares(atmosphere: Atmosphere, degree: int, altitude_m: ArrayLike, column: bool) -> FloatArray:
    height = np.asarray(altitude_m, dtype=float)[..., None]
    kinds, count = kinds_of(atmosphere), len(atmosphere.wavelength_nm)
    scattered = np.zeros((*height.shape[:-1], len(kinds), count))
    if len(kinds) == 1:
        return scattered + 1.0
    for kind in thinned(atmosphere, degree).particles():
        # Far above an exponential layer its density is too small a number.
        within = np.minimum(height, 600.0 * kind.scale_height_m)
        amount = kind.column_above(within) if column else kind.density(within)
        scattered[..., kinds.index(kind.name), :] = kind.scattering * amount
    return np.asarray(scattered / np.maximum(scattered.sum(axis=-2, keepdims=True), _TINY))


def kind_phases(atmosphere: Atmosphere, degree: int, nu: FloatArray) -> FloatArray:
    """Phase functions (kinds, n, C) of cosines (n,), per unit of scattering in thinned air."""
    peaks = forward_shares(atmosphere, degree)
    return np.stack(
        [particles_phase(atmosphere, k, nu) / (1.0 - peaks[k]) for k in kinds_of(atmosphere)]
    )


def shown_phase(
    atmosphere: Atmosphere, degree: int, nu: FloatArray, shares: FloatArray
) -> FloatArray:
    """The mean (n, C) of `kind_phases` by shares (kinds, C)."""
    return np.asarray((shares[:, None] * kind_phases(atmosphere, degree, nu)).sum(axis=0))


def phase_cosines() -> FloatArray:
    """Cosines (n,) of the nodes of phase functions in tables, uniform in sqrt((1 - nu) / 2)."""
    return np.asarray(1.0 - 2.0 * np.linspace(0.0, 1.0, _PHASE_NODES) ** 2)


def phase_tables(molecules: FloatArray, particles: list[FloatArray]) -> NDArray[np.float32]:
    """(groups, altitudes, n, 5) of the molecules' phase function (n,), and those of particles (n,
    C) at each altitude."""
    lanes = in_lanes(np.stack(particles))
    both = np.broadcast_to(molecules[:, None], (*lanes.shape[:3], 1)), lanes
    return np.concatenate(both, axis=-1).astype(np.float32)


def mixed_coefficients(atmosphere: Atmosphere, degree: int, altitude_m: FloatArray) -> FloatArray:
    """Legendre coefficients (altitudes or 1, degree + 1, C) of particles without the peak."""
    kinds = kinds_of(atmosphere)
    if len(kinds) == 1:
        return kept_coefficients(atmosphere, degree).T[None]
    each = np.stack([kept_coefficients(atmosphere, degree, kind).T for kind in kinds])
    shares = shares_at(atmosphere, degree, altitude_m)
    return np.asarray((shares[:, :, None] * each).sum(axis=1))
