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

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import mie_phase
from bruneton_sky.solver.scattering_operator import phase_coefficients
from vrut_lite.numeric_types import FloatArray


@lru_cache(maxsize=8)
def forward_shares(atmosphere: Atmosphere, degree: int) -> Mapping[str, FloatArray]:
    """f (C,) of all kinds of particles: the share of the light that each scatters which
    counts as not scattered; none of droplets'."""
    none = np.zeros(len(atmosphere.wavelength_nm))
    shares = {
        name: np.maximum(_chi(atmosphere, name, degree + 1)[:, -1], 0.0)
        if atmosphere.mie_table is not None
        else none
        for name in ("aerosol", "aloft", "stratosphere")
    }
    fog = none if atmosphere.has_droplets else shares["aerosol"]
    return MappingProxyType({**shares, "fog": fog})


def kept_coefficients(atmosphere: Atmosphere, degree: int, name: str = "aerosol") -> FloatArray:
    """The coefficients (C, degree + 1) of a kind's phase function without the peak."""
    peak = forward_shares(atmosphere, degree)[name][:, None]
    return np.asarray((_chi(atmosphere, name, degree)[:, : degree + 1] - peak) / (1.0 - peak))


@lru_cache(maxsize=8)
def thinned(atmosphere: Atmosphere, degree: int) -> Atmosphere:
    """The air without its forward peaks (delta-M); droplets with a separate phase function stay."""
    changed: dict[str, Any] = {}
    for name, peak in forward_shares(atmosphere, degree).items():
        field = "mie" if name == "aerosol" else name
        scattering = np.asarray(getattr(atmosphere, f"{field}_scattering"))
        lost = peak * scattering
        if lost.any():
            extinction = np.asarray(getattr(atmosphere, f"{field}_extinction"))
            changed[f"{field}_scattering"] = tuple(scattering - lost)
            changed[f"{field}_extinction"] = tuple(extinction - lost)
    return replace(atmosphere, **changed) if changed else atmosphere


@lru_cache(maxsize=32)
def _chi(atmosphere: Atmosphere, name: str, degree: int) -> FloatArray:
    """Coefficients (C, degree + 1) of a kind's whole phase function."""
    table = atmosphere.table_of(name)
    if table is not None:
        return table.coefficients(degree)
    one = phase_coefficients(lambda nu: mie_phase(atmosphere, nu), degree)
    return np.broadcast_to(one, (len(atmosphere.wavelength_nm), degree + 1))
