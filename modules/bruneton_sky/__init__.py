"""The sky of a spherical atmosphere: Rayleigh and Mie scattering, ozone, ground to space.

After Bruneton and Neyret 2008 and Bruneton 2017, for any number of wavelengths and any sun:
`solve` for the accurate sky of all orders, for every observer; `precompute` for tables of it;
`single_scattering` without preparation.
"""

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.precompute import precompute
from bruneton_sky.presets import earth_spectral, preset
from bruneton_sky.single_scattering import single_scattering
from bruneton_sky.solved_sky import SolvedSky, solve
from bruneton_sky.tables.sizes import TableSizes
from bruneton_sky.tables.tables import Tables

__all__ = [
    "Atmosphere",
    "SolvedSky",
    "TableSizes",
    "Tables",
    "earth_spectral",
    "precompute",
    "preset",
    "single_scattering",
    "solve",
]
