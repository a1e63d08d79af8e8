"""The sky of a spherical atmosphere: Rayleigh and Mie scattering, ozone, ground to space.

After Bruneton and Neyret 2008 and Bruneton 2017, for any number of wavelengths and any sun:
`solve` for the accurate sky of all orders, for every observer; `precompute` for tables of it;
`single_scattering` without preparation.

In reading order: `atmosphere`, `gases`, `phase` and `presets` describe the air; `geometry` and
`optical_path` follow a ray through it; `quadrature` has the nodes of light scattered once, `solver`
computes all later orders, `ray_light` and `solved_sky` both along any ray; `sun_light` and
`ground_light` add sun and ground; `sky_view`, `background` and `air_volume` are the view of one
observer, `unseen_moves` the moves that do not change it; `tables` reads tables in the published
parametrisations, and `published` makes them as published, beside the rules of single scattering.
Files named `kernels` are compiled by numba.
"""

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.presets import earth_spectral, preset
from bruneton_sky.published.precompute import precompute
from bruneton_sky.published.single_scattering import single_scattering
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
