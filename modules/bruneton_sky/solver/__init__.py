"""The fast solver of multiple scattering: ray bins, spherical harmonics, one march.

`solve` finds the source function of all orders on a coarse grid, where a ray is a few bins and
scattering a product of harmonics; `multiple_scattering` is its radiance at one place.

In reading order: `sizes`, `wavelength_groups` and `grid` say what is computed; `orders` adds order
after order on `nodes`, between which `node_kernels` carries light and where `scattering_operator`
scatters it; `source_field` is the result and `view` what one sees of it. Compiled code: a ray is
`ray_kernels`, its matter in bins `bin_kernels`, many suns at once `cell_kernels`, the light of the
bins `first_order_kernels` and `later_order_kernels`.
"""

from bruneton_sky.solver.orders import MOST_ORDERS, order_tolerance, real_time_sizes, solve
from bruneton_sky.solver.sizes import SolverSizes
from bruneton_sky.solver.source_field import SourceField
from bruneton_sky.solver.view import (
    ground_irradiance,
    multiple_scattering,
    single_scattering_fast,
)

__all__ = [
    "MOST_ORDERS",
    "SolverSizes",
    "SourceField",
    "ground_irradiance",
    "multiple_scattering",
    "order_tolerance",
    "real_time_sizes",
    "single_scattering_fast",
    "solve",
]
