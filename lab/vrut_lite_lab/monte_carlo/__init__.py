"""A backward Monte Carlo path tracer, the reference for tables and solver.

Importing this package imports numba.
"""

from vrut_lite_lab.monte_carlo.radiance import (
    BATCHES,
    MonteCarloEstimate,
    enter_atmosphere,
    monte_carlo_irradiance,
    monte_carlo_leaving,
    monte_carlo_radiance,
    monte_carlo_stokes,
    unscattered_share,
)

__all__ = [
    "BATCHES",
    "MonteCarloEstimate",
    "enter_atmosphere",
    "monte_carlo_irradiance",
    "monte_carlo_leaving",
    "monte_carlo_radiance",
    "monte_carlo_stokes",
    "unscattered_share",
]
