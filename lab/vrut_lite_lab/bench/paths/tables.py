"""Bruneton's tables: the published pipeline and the fast solver, by orders and sizes."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from bruneton_sky import Tables, TableSizes, precompute
from bruneton_sky.published.gpu_pipeline import GpuPipeline
from bruneton_sky.published.pipeline.pipeline import run_pipeline
from numpy.typing import NDArray

from vrut_lite_lab.bench.bench_path import (
    PICTURE_NORM,
    BenchPath,
    Errors,
    Group,
    Work,
    relative_errors,
)
from vrut_lite_lab.bench.gl import gl_owner, gl_read_back_clock, missing_gl
from vrut_lite_lab.bench.skies import DEMO, Condition, air, conditions, sky_directions
from vrut_lite_lab.bench.sky_truth import exact_skies, in_words

SIZES = {
    "quarter": TableSizes(
        transmittance_altitude=16, transmittance_mu=64, irradiance_altitude=8, irradiance_mu_s=16,
        altitude=8, mu=32, nu=8, mu_s=8,
    ),
    "half": TableSizes(
        transmittance_altitude=32, transmittance_mu=128, irradiance_altitude=8, irradiance_mu_s=32,
        altitude=16, mu=64, nu=8, mu_s=16,
    ),
    "published": TableSizes(),
    "double": TableSizes(
        transmittance_altitude=128, transmittance_mu=512, irradiance_altitude=32,
        irradiance_mu_s=128, altitude=64, mu=256, nu=16, mu_s=64,
    ),
}  # fmt: skip
ORDERS, QUICK_ORDERS = (2, 6, 10), ()
_USUAL_ORDERS = 4


def groups(quick: bool) -> list[Group]:
    """The one group."""
    sizes = ("quarter", "published") if quick else tuple(SIZES)
    paths = [_solver_path(quick, _USUAL_ORDERS, size) for size in sizes]
    paths += [_solver_path(quick, n, "published") for n in (QUICK_ORDERS if quick else ORDERS)]
    paths.append(_plain_path(quick, "quarter"))
    left_out = {}
    if missing_gl():
        left_out["the published pipeline on the GPU"] = missing_gl()
    else:
        on_gpu = ("quarter",) if quick else ("quarter", "published")
        paths += [_gpu_path(quick, size) for size in on_gpu]
    return [
        Group(
            name="tables",
            title="Tables of all scattering, Bruneton's air of 2017",
            unit="all tables of an atmosphere, three wavelengths",
            norm=f"{PICTURE_NORM} (of the sky looked up in the tables)",
            truth=in_words(quick),
            paths=tuple(paths),
            left_out=left_out,
        )
    ]


def _solver_path(quick: bool, orders: int, size: str) -> BenchPath:
    family = "fast solver, by size" if orders == _USUAL_ORDERS else "fast solver, by orders"
    work = partial(precompute, air(DEMO), orders, "cpu", SIZES[size])
    return _path(quick, "fast solver", family, orders, size, lambda: work)


def _plain_path(quick: bool, size: str) -> BenchPath:
    name = "published pipeline, numpy float64"
    work = partial(run_pipeline, air(DEMO), SIZES[size], _USUAL_ORDERS)
    return _path(quick, name, name, _USUAL_ORDERS, size, lambda: work)


def _gpu_path(quick: bool, size: str) -> BenchPath:
    name = "published pipeline, GPU shaders"
    made = _path(quick, name, name, _USUAL_ORDERS, size, partial(_prepare_gpu, size))
    return replace(made, clock=gl_read_back_clock(), device="GPU", batch="GPU")


def _prepare_gpu(size: str) -> Work:
    pipeline = gl_owner().call(lambda context: GpuPipeline(context, SIZES[size]))
    return lambda: gl_owner().call(lambda _: pipeline.run(air(DEMO), _USUAL_ORDERS))


def _path(
    quick: bool, name: str, family: str, orders: int, size: str, prepare: Callable[[], Work]
) -> BenchPath:
    sizes = SIZES[size]
    return BenchPath(
        name=f"{name}, {orders} orders, {size} size",
        family=family,
        parameters={
            "orders": orders,
            **{field: getattr(sizes, field) for field in sizes.__dataclass_fields__},
        },
        prepare=prepare,
        error=partial(_error, quick),
    )


def _error(quick: bool, tables: Tables) -> dict[str, Errors]:
    exact = exact_skies(DEMO, quick)
    return {
        each.name: relative_errors(_looked_up(tables, each), exact[each.name])
        for each in conditions(quick)
    }


def _looked_up(tables: Tables, condition: Condition) -> NDArray[np.float64]:
    """The picture's sky (n, 3)."""
    atmosphere = tables.atmosphere
    camera_m = np.array([0.0, atmosphere.ground_radius_m + condition.height_m, 0.0])
    views = sky_directions(atmosphere, condition.height_m)
    return np.maximum(tables.radiance_rgb(camera_m, views, condition.sun), 0.0)
