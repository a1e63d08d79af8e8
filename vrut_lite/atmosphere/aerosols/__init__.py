"""Optical properties of particles in the air: extinction, scattering and phase functions.

`optics` is the result that skies take, `phase_table` its phase function. `types` makes it from
OPAC's `components`, `mie` from a size distribution and a refractive index.
"""

from vrut_lite.atmosphere.aerosols.optics import AerosolOptics, optics_of_aerosol
from vrut_lite.atmosphere.aerosols.phase_table import PhaseTable
from vrut_lite.atmosphere.aerosols.types import OPAC_TYPES, mixture_optics, type_optics

__all__ = [
    "OPAC_TYPES",
    "AerosolOptics",
    "PhaseTable",
    "mixture_optics",
    "optics_of_aerosol",
    "type_optics",
]
