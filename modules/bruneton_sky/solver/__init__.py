"""The fast solver of multiple scattering: ray bins, spherical harmonics, one march.

`solve` finds the source function of all orders on a coarse grid, where a ray is a few bins and
scattering a product of harmonics; `multiple_scattering` looks at it from one place.
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
