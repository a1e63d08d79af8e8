"""The fast solver of multiple scattering: ray bins, spherical harmonics, one march.

`solve` finds the source function of all orders on a coarse grid, where a ray is a few bins and
scattering a product of harmonics; `multiple_scattering` is its radiance at one place.

In reading order: `sizes`, `wavelength_groups` and `grid` define the computation; `orders` adds
order after order on `nodes`, between which `node_kernels` transports light and where
`scattering_operator` scatters it; `source_field` is the result and `view` its radiance for one
observer. Compiled code: `ray_kernels` for a ray, `bin_kernels` for its matter in bins,
`cell_kernels` for many suns at once, `first_order_kernels` and `later_order_kernels` for the light
of the bins. `polarisation` explains Q and U, which `polarised_nodes` and `polarisation_kernels`
carry along.
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
