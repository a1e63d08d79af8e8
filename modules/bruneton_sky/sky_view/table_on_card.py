"""The sky-view table by a graphics card: with the cube drawn from it, or for every pixel.

The matter along the table's rays is the same under any sun: the processor computes it once an
atmosphere and altitude, and again where twilight needs other bins. A moved sun brings uniforms
alone.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.field_on_card import (
    PHASES_BINDING,
    field_on_card,
    phases_on_card,
    single_array,
)
from bruneton_sky.field_tables import table_of_field
from bruneton_sky.sky_view.gpu import (
    BANDS_BINDING,
    NODES_BINDING,
    PACKAGE,
    Uniforms,
    bands_array,
    cube_pass,
    look_up_uniforms,
    shader_of_table,
)
from bruneton_sky.sky_view.rays import SkyViewRays, table_rows
from bruneton_sky.sky_view.table import (
    NODE,
    aerosol_bands,
    bands_in_groups,
    colours_of,
    mean_above_m,
    row_bins,
    row_parts,
    table_sizes,
)
from bruneton_sky.sky_view.table_kernels import pack_rows
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.packed_bins import BIN_FLOATS
from bruneton_sky.solver.wavelength_groups import LANES, groups_of_air
from bruneton_sky.sun_light import DiscLight
from vrut_lite.array import Array
from vrut_lite.messages.gpu_job import GpuJob, GpuPass
from vrut_lite.messages.sky import ViewShader
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.shader_text import floats, shader_source

_BINS_BINDING, _ROWS_BINDING, _GROUND_BINDING = 2, 3, 9
_GROUP = 8


class CardTable(NamedTuple):
    """A table that a card makes: `program` writes so many `numbers`, those of `SkyView.nodes`.

    `look_up`: uniforms of sky_view.glsl. `depth`: as `SkyView.depth`. `bands`: its buffer of
    aerosol.
    """

    program: GpuPass
    numbers: int
    look_up: Uniforms
    depth: NDArray[np.float64]
    bands: Array


class _Matter(NamedTuple):
    """The bins of a table's rows, the shader's `Row` of each, and `SkyViewRays.depth`."""

    bins: Array
    rows: Array
    depth: NDArray[np.float64]


def table_on_card(
    field: SourceField,
    altitude_m: float,
    sun_direction: NDArray[np.float64],
    finer: float = 1.0,
) -> CardTable:
    """The table of `sky_view`, whose arguments these are, of four wavelengths at most."""
    mu_s = float(np.clip(sun_direction[1], -1.0, 1.0))
    shape, counts = table_sizes(field.atmosphere, altitude_m, mu_s, finer)
    rows, columns = shape[0] + shape[1], shape[2]
    matter, tables = _matter(field, altitude_m, shape, counts), field_on_card(field)
    phases, bands = _phases(field, mean_above_m(field.atmosphere, altitude_m))
    colours, (ground,) = colours_of(field)
    program = GpuPass(
        compute_shader=shader_source("sky_view_table.comp", PACKAGE),
        uniforms={
            **tables.uniforms,
            "table": (columns, rows),
            "sun": floats([mu_s, np.sqrt((1.0 - mu_s) * (1.0 + mu_s))]),
            "colours": floats(colours[0]),
            "ground_grid": floats(ground.grid),
        },
        groups=(-(-columns // _GROUP), -(-rows // _GROUP), 1),
        buffers=(
            (_BINS_BINDING, matter.bins),
            (_ROWS_BINDING, matter.rows),
            (PHASES_BINDING, phases),
            (_GROUND_BINDING, _ground(field)),
            *tables.buffers,
        ),
    )
    look_up = look_up_uniforms(shape, matter.depth, sun_direction)
    return CardTable(program, NODE * rows * columns, look_up, matter.depth, bands)


def table_cube_job(
    table: CardTable,
    size: int,
    ground_radiance_rgb: ArrayLike,
    scale: float,
    module: str,
    job: str,
    read_back: bool = False,
) -> GpuJob:
    """A job that makes a table, and the cube map of `fill_cube` from it.

    Args:
        table: the table.
        size: edge in texels.
        ground_radiance_rgb: (3,), below the horizon where the table has no rows there.
        scale: radiance is the texels' value times this.
        module, job: names of the module that asks and of the job.
        read_back: whether the result is an array, not a texture.
    """
    made, bands = table.program, ((BANDS_BINDING, table.bands),)
    return GpuJob(
        module=module,
        job=job,
        compute_shader=made.compute_shader,
        uniforms=made.uniforms,
        buffers=made.buffers,
        output="cube",
        size=size,
        format="rgba32f",
        groups=made.groups,
        read_back=read_back,
        then=(cube_pass(table.look_up, bands, size, ground_radiance_rgb, scale),),
        shared=((NODES_BINDING, table.numbers),),
    )


def table_view_shader(table: CardTable, disc: DiscLight) -> ViewShader:
    """The shader of `view_shader`, which makes the table before its first picture."""
    bands = ((BANDS_BINDING, table.bands),)
    shared = ((NODES_BINDING, table.numbers),)
    return shader_of_table(table.look_up, table.depth, bands, disc, (table.program,), shared)


@table_of_field
def _matter(
    field: SourceField,
    altitude_m: float,
    shape: tuple[int, int, int],
    counts: tuple[int, int, int],
) -> _Matter:
    (air,) = groups_of_air(field.thinned)
    # Rays do not depend on the sun. One in the zenith has their own angles: see `_row_table`.
    rays = table_rows(field.atmosphere, altitude_m, 1.0, *shape)
    bins, first, numbers = [], 0, np.zeros((len(rays.mu), 3))
    end = np.zeros((len(rays.mu), LANES + 1))
    for part, own_counts in row_parts(rays, counts):
        fine, coarse = row_bins(air, rays, part, own_counts)
        once, more = own_counts[1:]
        own = np.zeros((len(fine.edge), once + more, BIN_FLOATS), np.float32)
        pack_rows(air, fine, coarse, own)
        end[part] = fine.end
        numbers[part, 0] = first + (once + more) * np.arange(len(own))
        numbers[part, 1:] = once, more
        first += len(own) * (once + more)
        bins.append(own.reshape(-1, BIN_FLOATS))
    rows = _row_table(air.ground_radius_m, rays, numbers, end)
    return _Matter(Array(np.concatenate(bins)), single_array(rows), rays.depth)


def _row_table(
    ground_radius_m: float, rays: SkyViewRays, bins: FloatArray, end: FloatArray
) -> FloatArray:
    """The shader's `Row` (rows, 16): rays under a sun in the zenith, `bins` (rows, 3) and `end`
    (rows, 5) of each."""
    radius = ground_radius_m + rays.altitude_m
    above = rays.altitude_m * (radius + ground_radius_m) / (radius * radius)
    angles = [
        part
        for cosine in (rays.nu[:, 0], rays.mu_s[:, 0])
        for part in (cosine, np.sqrt((1.0 - cosine) * (1.0 + cosine)))
    ]
    along = np.where(rays.hits, end[:, LANES] / ground_radius_m, 0.0)
    start = radius, above, rays.mu, radius / ground_radius_m
    return np.column_stack([*start, *angles, bins, along, end[:, :LANES]])


@table_of_field
def _phases(field: SourceField, above_m: float) -> tuple[Array, Array]:
    """Phase functions of the particles' kinds over their mean, and the aerosol's bands."""
    kinds = bands_in_groups(field, above_m)[1][0]
    bands = bands_array(aerosol_bands(field, above_m))
    return phases_on_card(kinds, np.zeros((len(kinds), 3), np.float32)), bands


@table_of_field
def _ground(field: SourceField) -> Array:
    """The shader's `Ground` (suns * 4, 4)."""
    _, (ground,) = colours_of(field)
    colours = ground.light.reshape(-1, LANES, 4).copy()
    colours[:, 0, 3] = ground.mu_s
    return single_array(colours.reshape(-1, 4))
