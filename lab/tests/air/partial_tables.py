"""Tables of any sizes, filled by the solver only at the nodes that are looked at."""

import numpy as np
from bruneton_sky.published.precompute import transmittance_table
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.source_field import source_of_group
from bruneton_sky.solver.view_kernels import march_rays
from bruneton_sky.solver.wavelength_groups import groups_of_air
from bruneton_sky.tables.interpolate import neighbours
from bruneton_sky.tables.parametrisations import (
    Coordinates,
    State,
    node_coordinates,
    parametrisation_of,
)
from bruneton_sky.tables.rays import moved
from bruneton_sky.tables.sizes import TableSizes, table_shapes
from bruneton_sky.tables.tables import Tables

from vrut_lite.numeric_types import FloatArray

YEAR = "2017"


def empty_tables(field: SourceField, sizes: TableSizes) -> Tables:
    """The transmittance, and no light yet; untouched memory is never allocated."""
    shapes = table_shapes(field.atmosphere, sizes)
    dark = {
        name: np.zeros(shapes[name], np.float32)
        for name in ("irradiance", "scattering", "single_mie")
    }
    return Tables(
        atmosphere=field.atmosphere,
        sizes=sizes,
        orders=field.orders_done,
        parametrisation=YEAR,
        transmittance=transmittance_table(field.atmosphere, sizes),
        **dark,  # type: ignore[arg-type]
    )


def fill_along(
    field: SourceField,
    tables: Tables,
    altitude_m: float,
    view: FloatArray,
    sun: FloatArray,
    distance_m: FloatArray,
) -> None:
    """Fill in what `radiance_to_point` looks at before points (n,) in world axes.

    The view must meet neither the ground nor the end of the air before the points.
    """
    cosines = view[1], sun[1], view @ sun
    here = State(*(np.array([float(v)]) for v in (altitude_m, *cosines)), np.array([False]))
    for metres in (0.0, *distance_m):
        _fill(field, tables, moved(field.atmosphere, here, np.array([metres])))


def _fill(field: SourceField, tables: Tables, state: State) -> None:
    """Fill the nodes about a state that a look-up takes: two along each axis, of suns four."""
    form, shape = parametrisation_of(YEAR), tables.sizes.scattering_shape
    at = form.to_coordinates(field.atmosphere, tables.sizes, state)
    before = [int(neighbours(place, size)[0][0]) for place, size in zip(at, shape, strict=True)]
    nodes = [first + np.arange(2) for first in before[:3]]
    nodes.append(min(max(before[3] - 1, 0), shape[3] - 4) + np.arange(4))
    axes = (node_coordinates(size)[some] for size, some in zip(shape, nodes, strict=True))
    there = form.to_state(field.atmosphere, tables.sizes, Coordinates(*np.ix_(*axes)))
    scattering, mie = (np.empty((2, 2, 2, 4, 4), np.float32) for _ in range(2))
    own, (air,) = field.sizes, groups_of_air(field.atmosphere)
    march_rays(
        air, there.altitude_m.ravel(), np.ascontiguousarray(there.mu.reshape(2, 2)),
        there.hits_ground.ravel(), there.mu_s.ravel(), there.nu.ravel(),
        field.transmittance[0], source_of_group(field, 0),
        (own.steps, own.single_bins, own.multiple_bins), 0, scattering, mie,
    )  # fmt: skip
    tables.scattering[np.ix_(*nodes)], tables.single_mie[np.ix_(*nodes)] = scattering, mie
