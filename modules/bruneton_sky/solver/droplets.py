"""Aerosol and fog's droplets together: their mean phase function where they scatter.

Kernels know one kind of particle besides molecules. Where fog has a phase function of its own,
theirs is the mean by what each scatters: at each altitude in orders two and up, at the eye's in
light that is shown scattered once. Rays in float64 (`ray_light`) keep both apart.
"""

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import aerosol_phase
from bruneton_sky.solver.delta_m import forward_share, kept_coefficients, thinned
from vrut_lite.numeric_types import FloatArray

_TINY = 1e-300


def droplets_at(atmosphere: Atmosphere, degree: int, altitude_m: ArrayLike) -> FloatArray:
    """Share (..., C) of the droplets in what particles scatter at altitudes (...,)."""
    return _share(atmosphere, degree, altitude_m, False)


def droplets_above(atmosphere: Atmosphere, degree: int, altitude_m: ArrayLike) -> FloatArray:
    """The same of all that lies above."""
    return _share(atmosphere, degree, altitude_m, True)


def _share(atmosphere: Atmosphere, degree: int, altitude_m: ArrayLike, column: bool) -> FloatArray:
    height = np.asarray(altitude_m, dtype=float)[..., None]
    if not atmosphere.has_droplets:
        return np.zeros((*height.shape[:-1], len(atmosphere.wavelength_nm)))
    air = thinned(atmosphere, degree)
    _, haze, fog = air.by_kind(
        kind.scattering
        * np.exp(-height / kind.scale_height_m)
        * (kind.scale_height_m if column else 1.0)
        for kind in air.scatterers()
    )
    return np.asarray(fog / np.maximum(fog + haze, _TINY))


def shown_phase(
    atmosphere: Atmosphere, degree: int, nu: ArrayLike, share: FloatArray
) -> FloatArray:
    """Phase function (n, C), per unit of what thinned air scatters, of cosines (n,).

    `share` (C,): of the droplets.
    """
    haze = aerosol_phase(atmosphere, nu) / (1.0 - forward_share(atmosphere, degree))
    if not share.any():
        return haze
    assert atmosphere.fog_table is not None
    return np.asarray((1.0 - share) * haze + share * atmosphere.fog_table(nu))


def mixed_coefficients(atmosphere: Atmosphere, degree: int, altitude_m: FloatArray) -> FloatArray:
    """Legendre coefficients (altitudes or 1, degree + 1, C) of particles without the peak."""
    haze = kept_coefficients(atmosphere, degree).T[None]
    if not atmosphere.has_droplets:
        return haze
    assert atmosphere.fog_table is not None
    fog = atmosphere.fog_table.coefficients(degree).T[None]
    share = droplets_at(atmosphere, degree, altitude_m)[:, None]
    return np.asarray((1.0 - share) * haze + share * fog)
