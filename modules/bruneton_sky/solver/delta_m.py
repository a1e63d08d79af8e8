"""Light scattered nearly straight on counts as not scattered: Wiscombe's delta-M method.

The solver scatters by Legendre coefficients up to a degree; a phase function with a sharp peak
toward the sun has more. The share f of it that those left out would have, chi of the next degree,
is taken as light that goes straight on: extinction loses f times the scattering, scattering
becomes 1 - f of itself, and each coefficient (chi - f) / (1 - f) (Wiscombe 1977). So air is thinner
for scattered light, for the beam that feeds it, and for surfaces seen through it, which are wider
than the peak. Light scattered once is shown with the whole phase function on these depths (Nakajima
and Tanaka 1988); the sun's disc is seen through the air as it is.

Phase functions in closed form have no such peak (f is 0.03 for Cornette and Shanks' at g = 0.8):
they stay as they are.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import mie_phase
from bruneton_sky.solver.scattering_operator import phase_coefficients
from vrut_lite.numeric_types import FloatArray


@lru_cache(maxsize=8)
def forward_share(atmosphere: Atmosphere, degree: int) -> FloatArray:
    """f (C,): the share of scattered light that counts as not scattered."""
    if atmosphere.mie_table is None:
        return np.zeros(len(atmosphere.wavelength_nm))
    return np.maximum(_chi(atmosphere, degree + 1)[:, -1], 0.0)


def kept_coefficients(atmosphere: Atmosphere, degree: int) -> FloatArray:
    """The phase function's coefficients (C, degree + 1) without the peak."""
    peak = forward_share(atmosphere, degree)[:, None]
    return np.asarray((_chi(atmosphere, degree)[:, : degree + 1] - peak) / (1.0 - peak))


@lru_cache(maxsize=8)
def thinned(atmosphere: Atmosphere, degree: int) -> Atmosphere:
    """The air without the light that goes straight on; droplets of their own lose none."""
    peak = forward_share(atmosphere, degree)
    if not peak.any():
        return atmosphere
    haze, mist = np.asarray(atmosphere.mie_scattering), np.asarray(atmosphere.fog_scattering)
    of_fog = 0.0 * peak if atmosphere.has_droplets else peak
    return replace(
        atmosphere,
        mie_scattering=tuple((1.0 - peak) * haze),
        mie_extinction=tuple(np.asarray(atmosphere.mie_extinction) - peak * haze),
        fog_scattering=tuple((1.0 - of_fog) * mist),
        fog_extinction=tuple(np.asarray(atmosphere.fog_extinction) - of_fog * mist),
    )


@lru_cache(maxsize=16)
def _chi(atmosphere: Atmosphere, degree: int) -> FloatArray:
    """Coefficients (C, degree + 1) of the whole phase function."""
    if atmosphere.mie_table is not None:
        return atmosphere.mie_table.coefficients(degree)
    one = phase_coefficients(lambda nu: mie_phase(atmosphere, nu), degree)
    return np.broadcast_to(one, (len(atmosphere.wavelength_nm), degree + 1))
