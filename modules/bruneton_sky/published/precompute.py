"""Tables of an atmosphere's light, made by the fast solver or on the GPU, or read from disk."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import make_ray, y_at_top
from bruneton_sky.optical_path import exponential_layers_path, layered_path
from bruneton_sky.published.gpu_pipeline import GpuPipeline
from bruneton_sky.solver import SourceField, real_time_sizes, solve
from bruneton_sky.solver.source_field import source_of_group
from bruneton_sky.solver.view import sky_irradiance
from bruneton_sky.solver.view_kernels import march_rays
from bruneton_sky.solver.wavelength_groups import groups_of_air
from bruneton_sky.tables.parametrisations import (
    Coordinates,
    Year,
    irradiance_state,
    node_coordinates,
    parametrisation_of,
    transmittance_state,
)
from bruneton_sky.tables.sizes import TableSizes, refuse_untabled, table_shapes
from bruneton_sky.tables.tables import Tables
from vrut_lite.arguments import as_count, check_choice, check_type, shown
from vrut_lite.array_cache import ArrayCache
from vrut_lite.numeric_types import Float32Array, FloatArray

Backend = Literal["cpu", "gpu"]
_MOST_ORDERS = 1000
# Values of one table: 1 GiB in single precision, 80 times the published one.
_MOST_VALUES = 1 << 28
Progress = Callable[[float], None]
# Changes whenever the same recipe gives other numbers.
VERSION = 2
# Share of the CPU's time when the atmosphere is solved, and when the irradiance is done.
_SOLVED, _IRRADIANCE = 0.2, 0.25


def precompute(
    atmosphere: Atmosphere,
    orders: int = 4,
    backend: Backend = "cpu",
    sizes: TableSizes | None = None,
    progress: Progress | None = None,
    cache: ArrayCache | None = None,
) -> Tables:
    """The tables of an atmosphere, in the parametrisation of 2017.

    Their accuracy is stated in `Tables`; for 0.5 % use `bruneton_sky.solve`.

    Args:
        orders: scatterings and reflections of light at most, 1 to 1000. The irradiance of
            the GPU's tables is, as published, of one order less, that of the CPU's is not.
        backend: "cpu" is the fast solver (`bruneton_sky.solver`); "gpu" the thesis's pipeline
            (`bruneton_sky.published.gpu_pipeline`) in a new OpenGL context, which becomes the
            thread's: a thread that has a context uses `GpuPipeline` itself.
        sizes: sizes of the tables; by default those published.
        progress: called with the share done, from 0 to 1.
        cache: read first, and written.

    Raises:
        ValueError: orders or backend are not valid, there is fog, a table would have more than 2^28
            values, or the tables are too large for a GPU.
        UserError: backend is "gpu" and there is no OpenGL 4.3.
    """
    check_type("atmosphere", atmosphere, Atmosphere)
    orders = as_count("orders", orders, 1, _MOST_ORDERS)
    check_choice("backend", backend, get_args(Backend))
    refuse_untabled(atmosphere)
    size = TableSizes() if sizes is None else sizes
    check_type("sizes", size, TableSizes)
    if progress is not None and not callable(progress):
        raise ValueError(f"progress must be a function of the share done, not {shown(progress)}")
    if cache is not None:
        check_type("cache", cache, ArrayCache)
    for name, shape in table_shapes(atmosphere, size).items():
        as_count(f"the number of values of the table {name}", math.prod(shape), 1, _MOST_VALUES)
    recipe = (VERSION, backend, atmosphere, orders, size)
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
    with GpuPipeline(sizes=sizes) as pipeline:
        tables = pipeline.run(atmosphere, orders, progress)
    return {name: getattr(tables, name) for name in table_shapes(atmosphere, sizes)}


def _on_cpu(
    atmosphere: Atmosphere, orders: int, sizes: TableSizes, progress: Progress
) -> dict[str, Any]:
    scalar = replace(real_time_sizes(atmosphere), polarised_orders=0)
    field = solve(atmosphere, orders, scalar, progress=lambda share: progress(_SOLVED * share))
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
    # The last ray grazes the ground; none ends there.
    end_y = y_at_top(ray, air.top_altitude_m)
    paths = (
        *(
            exponential_layers_path(ray, air.top_altitude_m, end_y, k.exponentials)
            for k in scatterers
        ),
        layered_path(ray, end_y, air.absorber_altitude_m, air.absorber_density),
    )
    extinction = *(kind.extinction for kind in scatterers), air.absorption_extinction
    return np.exp(-np.tensordot(np.stack(paths), np.asarray(extinction), axes=(0, 0)))


def march_tables(
    field: SourceField, sizes: TableSizes | None = None, year: Year = "2017"
) -> tuple[Float32Array, Float32Array]:
    """Tables of scattering and single Mie, (altitude, mu, nu, mu_s, C) each.

    W m^-2 sr^-1 nm^-1. The first holds light scattered once by molecules without its phase
    function, and all later orders over Rayleigh's; the second light scattered once by aerosol,
    without its phase function. `year` names the parametrisation.

    Raises:
        ValueError: the atmosphere has fog.
    """
    refuse_untabled(field.atmosphere)
    size = sizes or TableSizes()
    axes = np.ix_(*(node_coordinates(count) for count in size.scattering_shape))
    at = parametrisation_of(year).to_state(field.atmosphere, size, Coordinates(*axes))
    altitude, mu_s, nu = at.altitude_m.ravel(), at.mu_s.ravel(), at.nu.ravel()
    mu = np.ascontiguousarray(at.mu.reshape(size.altitude, size.mu))
    hits = np.ascontiguousarray(np.broadcast_to(at.hits_ground, (1, size.mu, 1, 1)).ravel())
    shape = (*size.scattering_shape, len(field.atmosphere.wavelength_nm))
    scattering, mie = np.empty(shape, np.float32), np.empty(shape, np.float32)
    own = field.sizes
    for group, air in enumerate(groups_of_air(field.atmosphere)):
        march_rays(
            air, altitude, mu, hits, mu_s, nu, field.transmittance[group],
            source_of_group(field, group), (own.steps, own.single_bins, own.multiple_bins),
            4 * group, scattering, mie,
        )  # fmt: skip
    return scattering, mie


def irradiance_table(field: SourceField, sizes: TableSizes | None = None) -> FloatArray:
    """The sky's irradiance (altitude, mu_s, C) on a level surface, without the direct sun.

    Raises:
        ValueError: the atmosphere has fog.
    """
    refuse_untabled(field.atmosphere)
    size = sizes or TableSizes()
    shape = size.irradiance_altitude, size.irradiance_mu_s
    axes = np.ix_(*(node_coordinates(count) for count in shape))
    altitude, mu_s = irradiance_state(field.atmosphere, shape, *axes)
    return sky_irradiance(field, altitude.ravel(), mu_s.ravel(), field.sizes.node_bins)
