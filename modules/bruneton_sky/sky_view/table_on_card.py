"""The sky-view table of an observer on the ground by a graphics card, and the cube drawn from it.

The matter along the table's rays is the same under any sun: the processor computes it once an
atmosphere, and again where twilight needs other bins. A moved sun brings uniforms alone.
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
    bands_array,
    cube_pass,
    look_up_uniforms,
)
from bruneton_sky.sky_view.rays import table_rows
from bruneton_sky.sky_view.table import (
    NODE,
    aerosol_bands,
    bands_in_groups,
    colours_of,
    table_sizes,
)
from bruneton_sky.sky_view.table_kernels import pack_rows
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.packed_bins import BIN_FLOATS
from bruneton_sky.solver.wavelength_groups import groups_of_air
from vrut_lite.array import Array
from vrut_lite.messages.gpu_job import GpuJob
from vrut_lite.sky.shader_text import floats, shader_source

_BINS_BINDING, _ROWS_BINDING = 2, 3
_GROUP = 8


class _Matter(NamedTuple):
    """The bins of a table's rows, the rows (n, 4) of the shader, and `SkyViewRays.depth`."""

    bins: Array
    rows: Array
    depth: NDArray[np.float64]


def standing_sky_job(
    field: SourceField,
    sun_direction: NDArray[np.float64],
    size: int,
    ground_radiance_rgb: ArrayLike,
    scale: float,
    module: str,
    job: str,
    finer: float = 1.0,
    read_back: bool = False,
) -> GpuJob:
    """A job that makes the cube map of `fill_cube` of the table of an observer on the ground.

    Args:
        field: the solved atmosphere, of four wavelengths at most.
        sun_direction: unit vector (3,) in world axes.
        size: edge in texels.
        ground_radiance_rgb: (3,), below the horizon.
        scale: radiance is the texels' value times this.
        module, job: names of the module that asks and of the job.
        finer: as for `sky_view`.
        read_back: whether the result is an array, not a texture.
    """
    mu_s = float(np.clip(sun_direction[1], -1.0, 1.0))
    shape, counts = table_sizes(field.atmosphere, 0.0, mu_s, finer)
    rows, _, columns = shape
    matter, tables = _matter(field, shape, counts), field_on_card(field)
    phases, bands = _phases(field)
    return GpuJob(
        module=module,
        job=job,
        compute_shader=shader_source("sky_view_table.comp", PACKAGE),
        uniforms={
            **tables.uniforms,
            "table": (columns, rows),
            "counts": counts[1:],
            "sun": floats([mu_s, np.sqrt((1.0 - mu_s) * (1.0 + mu_s))]),
            "colours": floats(colours_of(field)[0]),
        },
        buffers=(
            (_BINS_BINDING, matter.bins),
            (_ROWS_BINDING, matter.rows),
            (PHASES_BINDING, phases),
            *tables.buffers,
        ),
        output="cube",
        size=size,
        format="rgba32f",
        groups=(-(-columns // _GROUP), -(-rows // _GROUP), 1),
        read_back=read_back,
        then=(
            cube_pass(
                look_up_uniforms(shape, matter.depth, sun_direction),
                ((BANDS_BINDING, bands),),
                size,
                ground_radiance_rgb,
                scale,
            ),
        ),
        shared=((NODES_BINDING, NODE * rows * columns),),
    )


@table_of_field
def _matter(
    field: SourceField, shape: tuple[int, int, int], counts: tuple[int, int, int]
) -> _Matter:
    (air,) = groups_of_air(field.thinned)
    # Rays on the ground do not depend on the sun.
    rays = table_rows(field.atmosphere, 0.0, 1.0, *shape)
    bins = np.zeros((len(rays.mu), counts[1] + counts[2], BIN_FLOATS), np.float32)
    pack_rows(air, rays.altitude_m, rays.mu, counts, bins)
    sine = np.sqrt((1.0 - rays.mu) * (1.0 + rays.mu))
    radius = np.full_like(sine, air.ground_radius_m)
    rows = np.stack([radius, np.zeros_like(sine), rays.mu, sine], axis=-1)
    return _Matter(Array(bins), single_array(rows), rays.depth)


@table_of_field
def _phases(field: SourceField) -> tuple[Array, Array]:
    """Phase functions of the particles' kinds over their mean, and the aerosol's bands."""
    kinds = bands_in_groups(field, 0.0)[1][0]
    bands = bands_array(aerosol_bands(field, 0.0))
    return phases_on_card(kinds, np.zeros((len(kinds), 3), np.float32)), bands
