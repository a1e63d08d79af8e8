"""Order after order of scattering on the solver's nodes."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.solver.delta_m import forward_shares, thinned
from bruneton_sky.solver.grid import reaches_night
from bruneton_sky.solver.nodes import (
    NodeLight,
    Nodes,
    fed_phase_tables,
    make_nodes,
    make_transmittance,
)
from bruneton_sky.solver.sizes import LATER, SolverSizes
from bruneton_sky.solver.source_field import SourceField
from bruneton_sky.solver.wavelength_groups import (
    LANES,
    WavelengthGroup,
    groups_of_air,
    is_hazy,
    is_thick_haze,
    wavelengths_of_groups,
)
from vrut_lite.arguments import as_count, as_number, check_type

Lanes = NDArray[np.float32]
Progress = Callable[[float], None]
# Largest ratio of an order to the one before: where little light leaves, the series must converge.
_LARGEST_RATIO = 0.99
# Orders by default without the tail, and at most before the tail is added.
_FEW_ORDERS, MOST_ORDERS = 4, 20
# Orders are added until one changes the estimate of all of them by less than this for every sun,
# those below the horizon too, where orders count most. The rest is smaller by day (0.05 % of the
# sky at turbidity 3, 0.2 % at 4); in thick haze and fog orders fall off slowly: it is larger.
_ORDER_TOLERANCE, _THICK_TOLERANCE, _FOG_TOLERANCE = 0.02, 0.01, 0.005

# Altitudes are spread by the root of the height: those of air of the first top serve for as dense
# nodes in deeper air, up to so much deeper.
_USUAL_TOP_M, _MOST_DEEPER = 60_000.0, 2.0
# Share of scattered light beyond 16 degrees of harmonics from which on 24 are kept: dust has 0.13,
# salt 0.12, continental aerosol 0.02. Of dust from 300 km the rms error falls from 0.6 to 0.2 %.
# These harmonics need azimuths to match: with the sun 80 degrees from the zenith 12 azimuths leave
# 0.6 to 0.8 % rms of luminance and 4 to 5 % at most (salt, dust, depths 0.2 to 0.8), 20 for the
# first light and 12 for the second 0.1 and 0.5 %, for a quarter more time. With 24 azimuths of the
# source function what is left falls from 0.36 to 0.26 % rms (dust, depth 0.3).
_SHARP = 0.05
_SHARP_SIZES = {
    "degree": 24,
    "direction_azimuth": 20,
    "later_azimuth": 12,
    "source_azimuth": 24,
}
# Sizes for suns to 18.5 degrees down, at least: their light scattered once comes from a thin
# sunlit layer at the ends of long rays, of which haze hides more.
_NIGHT_SIZES = {"mu_s": 64, "direction_mu": 26, "steps": 96, "node_bins": 64, "higher_bins": 18}
_HAZY_NIGHT_SIZES = {**_NIGHT_SIZES, "node_bins": 52, "higher_bins": 14}


class _Sum(NamedTuple):
    """The light of all orders, and the ratio of the last two."""

    light: NodeLight
    ratio: Lanes
    orders_done: int
    bins_left_out: int = 0


def solve(
    atmosphere: Atmosphere,
    orders: int | None = None,
    sizes: SolverSizes | None = None,
    all_orders: bool = False,
    tolerance: float | None = None,
    progress: Progress | None = None,
) -> SourceField:
    """The source function of light scattered twice to `orders` times.

    Reflection by the ground counts as scattering. Scattering and the travel from node to node
    conserve energy but for interpolation: the light at the nodes is neither fitted nor scaled.

    Args:
        atmosphere: any number of wavelengths.
        orders: highest order of scattering; 1 leaves the field dark. By default 4; with
            `all_orders` as many as the tolerance needs, 20 at most.
        sizes: of the discretisation; by default `real_time_sizes`.
        all_orders: add all orders beyond as a geometric series, whose ratio is that of the
            last two orders, for each sun and wavelength. It takes three orders or more. After
            four orders a sky by day still errs by several percent in haze (optical depth 0.2) and
            by tens of percent in thick haze (0.8): few orders suit clear air only.
        tolerance: stop after an order that changes the sum, with the orders beyond if these are
            added, by less than this share for every sun and wavelength. By default none if
            `orders` are named, else `order_tolerance`.
        progress: called with the share done, from 0 to 1.

    Raises:
        ValueError: orders are not from 1 to 1000, or the tolerance not from 0 to 1.
    """
    check_type("atmosphere", atmosphere, Atmosphere)
    if orders is None and all_orders and tolerance is None:
        tolerance = order_tolerance(atmosphere)
    tolerance = 0.0 if tolerance is None else tolerance
    orders = (MOST_ORDERS if all_orders else _FEW_ORDERS) if orders is None else orders
    orders = as_count("orders of scattering", orders, 1, 1000)
    tolerance = as_number("tolerance of the orders", tolerance, 0.0, 1.0)
    size = sizes or real_time_sizes(atmosphere)
    groups = groups_of_air(thinned(atmosphere, size.degree))
    transmittance = [make_transmittance(air) for air in groups]
    sums, sources, polarised = [], [], []
    for index, air in enumerate(groups):
        nodes = make_nodes(atmosphere, air, size, index)
        phase = fed_phase_tables(atmosphere, size.degree, nodes.altitude_m)[index]

        def tell(done: int, index: int = index) -> None:
            if progress is not None:
                # How many orders there will be is not known.
                progress((index + 1.0 - 0.5 ** (done - 1)) / len(groups))

        done = _sum_orders(nodes, transmittance[index], phase, orders, tolerance, all_orders, tell)
        sums.append(done)
        sources.append(nodes.source(done.light))
        polarised.append(nodes.polarised_source(done.light))
        if progress is not None:
            progress((index + 1) / len(groups))
    count = len(atmosphere.wavelength_nm)
    return SourceField(
        atmosphere=atmosphere,
        sizes=size,
        rayleigh=np.stack([source.rayleigh for source in sources]),
        mie=np.stack([source.mie for source in sources]),
        polarised=np.stack(polarised) if size.polarised_orders is None else None,
        transmittance=np.stack(transmittance),
        orders_done=max(done.orders_done for done in sums),
        tail_ratio=wavelengths_of_groups([done.ratio for done in sums], count),
        skipped=_skipped(groups, orders, sums),
    )


def order_tolerance(atmosphere: Atmosphere) -> float:
    """The tolerance of the orders for a picture of this air."""
    if atmosphere.foggy:
        return _FOG_TOLERANCE
    return _THICK_TOLERANCE if is_thick_haze(atmosphere) else _ORDER_TOLERANCE


def real_time_sizes(atmosphere: Atmosphere) -> SolverSizes:
    """The sizes for a picture of this air.

    Deep air has more altitudes, as dense at the ground; that of low suns has more suns, steps and
    bins. Dust and salt, of whose sharp phase functions delta-M takes much away, have more harmonics
    and azimuths.
    """
    if atmosphere.foggy:
        sizes = SolverSizes.in_fog()
    else:
        sizes = SolverSizes.in_haze() if is_hazy(atmosphere) else SolverSizes.in_clear_air()
    deeper = min(max(atmosphere.top_altitude_m / _USUAL_TOP_M, 1.0), _MOST_DEEPER)
    sharp = forward_shares(atmosphere, sizes.degree)["aerosol"].max() > _SHARP
    sizes = replace(
        sizes,
        altitude=math.ceil(sizes.altitude * math.sqrt(deeper)),
        **(_SHARP_SIZES if sharp else {}),
    )
    if not reaches_night(atmosphere):
        return sizes
    known = {**vars(sizes), "mu_s": 0, "higher_bins": sizes.bins_of(LATER)}
    least = _HAZY_NIGHT_SIZES if is_hazy(atmosphere) else _NIGHT_SIZES
    return replace(sizes, **{k: max(known[k], size) for k, size in least.items()})


def _sum_orders(
    nodes: Nodes,
    transmittance: Lanes,
    phase: Lanes,
    orders: int,
    tolerance: float,
    all_orders: bool,
    tell: Callable[[int], None],
) -> _Sum:
    suns = nodes.suns.mu_s.size
    none = np.zeros((suns, LANES), dtype=np.float32)
    if orders == 1 or not nodes.air.scattering.any():
        shape = len(nodes.altitude_m), nodes.operator.degree.size, suns * LANES
        return _Sum(NodeLight(np.zeros(shape, dtype=np.float32)), none, 1)
    radiance, last = nodes.first_light(transmittance, phase)
    total, ratio, done = last, none, 2
    estimate = _amount(total)
    while done < orders:
        tell(done)
        before, known = last, estimate
        radiance, last = nodes.next_light(last, radiance, done + 1)
        total = _plus(total, last)
        done += 1
        if all_orders:
            ratio = np.minimum(_quotient(_amount(last), _amount(before)), _LARGEST_RATIO)
        estimate = _amount(total) + _amount(last) * _series(ratio)
        if _quotient(np.abs(estimate - known), estimate).max() < tolerance:
            break
    total = _plus(total, last, _series(ratio).reshape(-1))
    return _Sum(total, ratio, done, nodes.bins_left_out)


def _plus(light: NodeLight, more: NodeLight, factor: Lanes | float = 1.0) -> NodeLight:
    """Light and `factor` times more of it, which may have only the first harmonics, or no Q, U."""
    radiance, polarised = light.radiance.copy(), light.polarised
    radiance[:, : more.radiance.shape[1]] += factor * more.radiance
    if polarised is not None and more.polarised is not None:
        polarised = polarised + factor * more.polarised
    return NodeLight(radiance, polarised)


def _series(ratio: Lanes) -> Lanes:
    """The orders beyond one, in units of that one."""
    return ratio / (1.0 - ratio)


def _amount(light: NodeLight) -> Lanes:
    """The light of each sun and wavelength at all nodes, (suns, 4)."""
    return np.maximum(light.radiance[:, 0].sum(axis=0), 0.0).reshape(-1, LANES)


def _quotient(part: Lanes, whole: Lanes) -> Lanes:
    return np.divide(part, whole, out=np.zeros_like(part), where=whole > 0)


def _skipped(groups: list[WavelengthGroup], orders: int, sums: list[_Sum]) -> dict[str, int]:
    """Counts of groups of wavelengths without a term, and of orders and bins not needed."""
    return {
        "molecules": sum(not air.scattering[0].any() for air in groups),
        "aerosol": sum(not air.scattering[1:].any() for air in groups),
        "absorber": sum(not air.extinction[2].any() for air in groups),
        "ground": sum(not air.ground_albedo.any() for air in groups),
        "orders": sum(orders - done.orders_done for done in sums),
        "bins": sum(done.bins_left_out for done in sums),
    }
