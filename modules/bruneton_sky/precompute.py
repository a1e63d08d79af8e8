"""Tables of an atmosphere's light, made by the fast solver or on the GPU, or read from disk."""

import math
from collections.abc import Callable
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import make_ray, y_at_top
from bruneton_sky.optical_path import exponential_path, layered_path
from bruneton_sky.tables.cache import TableCache
from bruneton_sky.tables.parametrisations import node_coordinates, transmittance_state
from bruneton_sky.tables.sizes import TableSizes, refuse_fog, table_shapes
from bruneton_sky.tables.tables import Tables
from vrut_lite.arguments import as_count, check_choice, check_type, shown

Backend = Literal["cpu", "gpu"]
_MOST_ORDERS = 1000
# Values of one table: a gigabyte in single precision, 80 times the published table.
_MOST_VALUES = 1 << 28
Progress = Callable[[float], None]
# Share of the CPU's time done after solving, and after the irradiance; marching takes the rest.
_SOLVED, _IRRADIANCE = 0.2, 0.25


def precompute(
    atmosphere: Atmosphere,
    orders: int = 4,
    backend: Backend = "cpu",
    sizes: TableSizes | None = None,
    progress: Progress | None = None,
    cache: TableCache | None = None,
) -> Tables:
    """The tables of an atmosphere, in the parametrisation of 2017.

    Their accuracy is stated in `Tables`; for 0.5 % use `bruneton_sky.solve`.

    Args:
        orders: how often light is scattered or reflected at most, 1 to 1000. The irradiance of
            the GPU's tables is, as published, of one order less, that of the CPU's is not.
        backend: "cpu" is the fast solver (`bruneton_sky.solver`); "gpu" the thesis's pipeline
            (`bruneton_sky.gpu_pipeline`) in an OpenGL context of its own, which becomes the
            thread's: a thread that has a context uses `GpuPipeline` itself.
        sizes: of the tables; by default those published.
        progress: called with the share done, from 0 to 1.
        cache: read first, and written.

    Raises:
        ValueError: for no order at all, another backend, fog, a table of more than 2^28 values, or
            tables too large for a GPU.
        UserError: there is no OpenGL for the GPU.
    """
    check_type("atmosphere", atmosphere, Atmosphere)
    orders = as_count("orders", orders, 1, _MOST_ORDERS)
    check_choice("backend", backend, get_args(Backend))
    refuse_fog(atmosphere)
    size = TableSizes() if sizes is None else sizes
    check_type("sizes", size, TableSizes)
    if progress is not None and not callable(progress):
        raise ValueError(f"progress must be a function of the share done, not {shown(progress)}")
    if cache is not None:
        check_type("cache", cache, TableCache)
    for name, shape in table_shapes(atmosphere, size).items():
        as_count(f"the number of values of the table {name}", math.prod(shape), 1, _MOST_VALUES)
    recipe = (backend, atmosphere, orders, size)
    # Arrays made in single precision stay so.
    arrays: dict[str, Any] | None = None if cache is None else cache.get(recipe)
    if arrays is None or _shapes(arrays) != table_shapes(atmosphere, size):
        make = _on_cpu if backend == "cpu" else _on_gpu
        arrays = make(atmosphere, orders, size, progress or _nobody)
        if cache is not None:
            cache.put(recipe, arrays)
    elif progress is not None:
        progress(1.0)
    return Tables(
        atmosphere=atmosphere, sizes=size, orders=orders, parametrisation="2017", **arrays
    )


def _shapes(arrays: dict[str, Any]) -> dict[str, tuple[int, ...]]:
    return {name: array.shape for name, array in arrays.items()}


def _nobody(_share: float) -> None:
    pass


def _on_gpu(
    atmosphere: Atmosphere, orders: int, sizes: TableSizes, progress: Progress
) -> dict[str, Any]:
    from bruneton_sky.gpu_pipeline import GpuPipeline

    with GpuPipeline(sizes=sizes) as pipeline:
        tables = pipeline.run(atmosphere, orders, progress)
    return {name: getattr(tables, name) for name in table_shapes(atmosphere, sizes)}


def _on_cpu(
    atmosphere: Atmosphere, orders: int, sizes: TableSizes, progress: Progress
) -> dict[str, Any]:
    from bruneton_sky.solver import irradiance_table, march_tables, solve

    field = solve(atmosphere, orders, progress=lambda share: progress(_SOLVED * share))
    irradiance = irradiance_table(field, sizes)
    progress(_IRRADIANCE)
    scattering, single_mie = march_tables(field, sizes)
    progress(1.0)
    return {
        "transmittance": transmittance_table(atmosphere, sizes),
        "irradiance": irradiance,
        "scattering": scattering,
        "single_mie": single_mie,
    }


def transmittance_table(atmosphere: Atmosphere, sizes: TableSizes) -> NDArray[np.float64]:
    """The transmittance (altitude, mu, C) to the top of the atmosphere, in closed form."""
    air, shape = atmosphere, (sizes.transmittance_altitude, sizes.transmittance_mu)
    altitude, mu = transmittance_state(air, shape, *np.ix_(*map(node_coordinates, shape)))
    ray = make_ray(air.ground_radius_m, altitude, mu)
    scatterers = air.scatterers()
    # The last of the rays grazes the ground: none of them ends there.
    end_y = y_at_top(ray, air.top_altitude_m)
    paths = (
        *(exponential_path(ray, air.top_altitude_m, end_y, k.scale_height_m) for k in scatterers),
        layered_path(ray, end_y, air.absorber_altitude_m, air.absorber_density),
    )
    extinction = *(kind.extinction for kind in scatterers), air.absorption_extinction
    return np.exp(-np.tensordot(np.stack(paths), np.asarray(extinction), axes=(0, 0)))
