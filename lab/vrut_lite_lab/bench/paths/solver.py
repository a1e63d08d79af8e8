"""Multiple scattering: the solver by its sizes and its orders."""

from dataclasses import asdict, replace
from functools import partial

from bruneton_sky.solver import SolverSizes, SourceField, real_time_sizes, solve
from bruneton_sky.solver_rungs import SOLVER_RUNGS, SolverRung, rung_sizes, rung_tolerance

from vrut_lite_lab.bench.bench_path import (
    PICTURE_NORM,
    BenchPath,
    Errors,
    Group,
    Work,
    relative_errors,
)
from vrut_lite_lab.bench.skies import SETTINGS, air, conditions
from vrut_lite_lab.bench.sky_truth import exact_skies, in_words, sky_rgb

ORDERS, QUICK_ORDERS = (2, 3, 4, 6, 8), (2, 4)
WITH_TAIL, QUICK_WITH_TAIL = (3, 4, 6), (4,)
SIZES = {
    "least": SolverSizes(
        altitude=10, mu_s=24, direction_mu=16, direction_azimuth=8, later_azimuth=4, degree=8,
        source_mu=16, source_azimuth=8, steps=24, node_bins=8, single_bins=12, multiple_bins=8,
    ),
    "small": SolverSizes(
        altitude=16, mu_s=32, direction_mu=24, direction_azimuth=12, later_azimuth=8, degree=12,
        source_mu=24, source_azimuth=10, steps=32, node_bins=10, single_bins=16, multiple_bins=10,
    ),
    "large": SolverSizes(
        altitude=32, mu_s=64, direction_mu=40, direction_azimuth=20, later_azimuth=12, degree=20,
        source_mu=48, source_azimuth=16, steps=72, node_bins=24, single_bins=36, multiple_bins=24,
    ),
}  # fmt: skip
QUICK_SIZES = ("least",)
# Orders that carry polarisation on; the usual sizes carry that of all orders.
POLARISED, QUICK_POLARISED = (0, 1, 2, 3), (0,)
QUICK_RUNGS: tuple[SolverRung, ...] = ("usual",)


def groups(quick: bool) -> list[Group]:
    """A group for each air."""
    return [_group(name, quick) for name in (list(SETTINGS)[:1] if quick else SETTINGS)]


def _group(name: str, quick: bool) -> Group:
    air_here = air(name)
    paths = [
        _path(
            name, quick, f"rung {rung}", "the product's rungs", None, True,
            rung_sizes(air_here, rung), rung_tolerance(air_here, rung),
        )
        for rung in (QUICK_RUNGS if quick else SOLVER_RUNGS)
    ]  # fmt: skip
    paths += [
        _path(name, quick, f"sizes {said}, all orders", "sizes, all orders", None, True, sizes)
        for said, sizes in SIZES.items()
        if not quick or said in QUICK_SIZES
    ]
    paths += [
        _path(name, quick, f"{orders} orders", "orders, none beyond", orders, False)
        for orders in (QUICK_ORDERS if quick else ORDERS)
    ]
    paths += [
        _path(name, quick, f"{orders} orders and a series", "orders, a series beyond", orders, True)
        for orders in (QUICK_WITH_TAIL if quick else WITH_TAIL)
    ]
    paths += [
        _path(
            name, quick, f"usual, {orders} polarised orders", "polarised orders", None, True,
            replace(rung_sizes(air_here), polarised_orders=orders), rung_tolerance(air_here),
        )
        for orders in (QUICK_POLARISED if quick else POLARISED)
    ]  # fmt: skip
    return Group(
        name=f"solver-{name.replace(' ', '-')}",
        title=f"Multiple scattering, {name}: the solver's sizes and orders",
        unit="a changed atmosphere, four wavelengths",
        norm=f"{PICTURE_NORM} (of all light of the sky)",
        truth=in_words(quick),
        paths=tuple(paths),
    )


def _path(
    name: str,
    quick: bool,
    said: str,
    family: str,
    orders: int | None,
    all_orders: bool,
    sizes: SolverSizes | None = None,
    tolerance: float | None = None,
) -> BenchPath:
    taken = sizes or real_time_sizes(air(name))
    return BenchPath(
        name=said,
        family=family,
        parameters={
            "orders": orders or 0,
            "all_orders": int(all_orders),
            **{name: size for name, size in asdict(taken).items() if size is not None},
        },
        prepare=partial(_prepare, name, orders, taken, all_orders, tolerance),
        error=partial(_error, name, quick),
    )


def _prepare(
    name: str,
    orders: int | None,
    sizes: SolverSizes,
    all_orders: bool,
    tolerance: float | None,
) -> Work:
    return partial(solve, air(name), orders, sizes, all_orders, tolerance)


def _error(name: str, quick: bool, field: SourceField) -> dict[str, Errors]:
    exact = exact_skies(name, quick)
    return {
        each.name: relative_errors(sky_rgb(field, name, each), exact[each.name])
        for each in conditions(quick)
    }
