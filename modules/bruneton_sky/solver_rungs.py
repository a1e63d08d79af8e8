"""Sizes and tolerances of the solver, from a draft to a solution that takes seconds.

Each rung changes the real-time sizes of the atmosphere. Its largest sources of error, found by
making one size after another converged: by day the directions of the source function, in twilight
the suns, then the bins of rays, and last directions and altitudes together.
"""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Literal, get_args

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.solver import SolverSizes, order_tolerance, real_time_sizes
from bruneton_sky.solver.sizes import LATER

SolverRung = Literal["draft", "usual", "fine", "finer", "finest"]
SOLVER_RUNGS: tuple[SolverRung, ...] = get_args(SolverRung)
_MOST: Mapping[str, int] = MappingProxyType(
    {
        "altitude": 10,
        "mu_s": 32,
        "direction_mu": 16,
        "direction_azimuth": 8,
        "later_azimuth": 8,
        "degree": 10,
        "source_mu": 24,
        "source_azimuth": 12,
        "node_bins": 12,
        "polarised_mu": 8,
        "polarised_azimuth": 4,
    }
)
# Polarised orders of a draft: Q and U of light scattered once leave 0.4 to 0.7 % of luminance
# by day (scalar transfer 1.2 to 1.7 %), those of all orders 0.1 to 0.4 % in a quarter more time.
_DRAFT_POLARISED_ORDERS = 1
# The same in clear air and in haze: twilight needs as many bins in both.
_FINE = {
    "mu_s": 96,
    "later_azimuth": 12,
    "source_mu": 64,
    "source_azimuth": 24,
    "steps": 96,
    "node_bins": 24,
    "multiple_bins": 24,
    "polarised_mu": 16,
    "polarised_azimuth": 8,
    "polarised_bins": 14,
}
_FINER = {
    **_FINE,
    "mu_s": 128,
    "direction_azimuth": 16,
    "source_mu": 96,
    "source_azimuth": 32,
    "later_azimuth": 16,
    "steps": 144,
    "node_bins": 36,
    "multiple_bins": 36,
}
_FINEST = {
    **_FINER,
    "altitude": 28,
    "direction_mu": 40,
    "direction_azimuth": 20,
}
# Lower bounds.
_LEAST: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {"fine": _FINE, "finer": _FINER, "finest": _FINEST}
)
# Factors on the tolerance of the orders.
_ORDERS: Mapping[SolverRung, float] = MappingProxyType(
    {"draft": 2.0, "usual": 1.0, "fine": 0.5, "finer": 0.25, "finest": 0.25}
)
# Orders in `counted_work`.
_COUNTED_ORDERS = 8


def rung_sizes(atmosphere: Atmosphere, rung: SolverRung = "usual") -> SolverSizes:
    """The solver's sizes of a rung for an atmosphere."""
    usual = real_time_sizes(atmosphere)
    if rung == "usual":
        return usual
    if rung == "draft":
        fewer = {k: min(getattr(usual, k), size) for k, size in _MOST.items()}
        return replace(usual, polarised_orders=_DRAFT_POLARISED_ORDERS, **fewer)
    least = _LEAST[rung]
    larger = {k: max(getattr(usual, k), size) for k, size in least.items()}
    later = max(usual.bins_of(LATER), least["node_bins"])
    return replace(usual, **larger, higher_azimuth=None, higher_bins=later)


def rung_tolerance(atmosphere: Atmosphere, rung: SolverRung = "usual") -> float:
    """The change of all light by another order below which no more orders are added."""
    return order_tolerance(atmosphere) * _ORDERS[rung]


def counted_work(sizes: SolverSizes) -> float:
    """Bins that rays between nodes pass in eight orders, and harmonics summed in the source."""
    nodes = sizes.altitude * sizes.mu_s
    azimuths = sizes.direction_azimuth + sum(
        sizes.azimuths_of(order) * sizes.bins_of(order) / sizes.node_bins
        for order in range(3, _COUNTED_ORDERS + 1)
    )
    bins = nodes * sizes.direction_mu * azimuths * sizes.node_bins
    return bins + nodes * sizes.source_mu * sizes.source_azimuth * (sizes.degree + 1) ** 2
