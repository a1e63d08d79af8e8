"""The light of a volume of air as a job for the GPU; the solved field is uploaded once.

The CPU computes the matter along the rays, row by row, the GPU the light of all columns. Matter is
the same under any sun, and of sun and moon: it is computed once an eye and reach.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.air_volume.kernels import SLICE_FLOATS, pack_slices
from bruneton_sky.air_volume.volume import AirSizes, Matter, matter_before, volume_of
from bruneton_sky.field_on_card import (
    PHASES_BINDING,
    field_on_card,
    phases_on_card,
    single_array,
)
from bruneton_sky.field_tables import table_of_field
from bruneton_sky.sky_view.table import channel_phases
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.wavelength_groups import groups_of_air
from vrut_lite.array import Array
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_job import GpuJob, GpuTexture
from vrut_lite.sky.air_volume import node_rays
from vrut_lite.sky.shader_text import shader_source

_GROUP = 8


def air_volume_job(
    field: SourceField,
    altitude_m: float,
    sun_direction: ArrayLike,
    reach_m: float,
    module: str,
    job: str,
    sizes: AirSizes | None = None,
    read_back: bool = False,
) -> tuple[GpuJob, AirVolume]:
    """A job that makes the light of `air_volume`, and the volume that waits for its texture.

    Args:
        field: the solved atmosphere, of four wavelengths at most.
        altitude_m, sun_direction, reach_m, sizes: as for `air_volume`.
        module, job: names of the module that asks and of the job.
        read_back: whether the result is an array (3 * slices, rows, columns, 4), not a texture.
    """
    count = sizes or AirSizes()
    packed = _packed(field, float(altitude_m), float(reach_m), count)
    height = float(np.asarray(sun_direction, dtype=float)[1])
    rays = node_rays(packed.matter.grid, count.columns, min(max(height, -1.0), 1.0))
    suns = np.stack([rays.mu_s, rays.nu], axis=-1)
    tables = field_on_card(field)
    rows = count.rows_above + count.rows_below
    size = (count.columns, rows, 3 * count.slices)
    made = GpuJob(
        module=module,
        job=job,
        compute_shader=shader_source("air_volume.comp", "bruneton_sky"),
        uniforms={
            **tables.uniforms,
            "shape": (count.slices, rows, count.columns),
        },
        buffers=(
            (1, packed.slices),
            (2, packed.rows),
            (3, single_array(suns)),
            (PHASES_BINDING, _angles(field, packed.matter.grid.observer_altitude_m)),
            *tables.buffers,
        ),
        output="3d",
        size=size,
        # Single precision: the brightest node is not known before the job has run.
        format="rgba32f",
        groups=(-(-count.columns // _GROUP), -(-rows // _GROUP), 1),
        read_back=read_back,
    )
    awaited = GpuTexture(size=size, format=made.format, recipe=made.recipe)
    return made, volume_of(field, packed.matter, sun_direction, awaited, 1.0)


class _PackedMatter(NamedTuple):
    """The matter of a volume, and the shader's `Slices` and `Rows` of it."""

    matter: Matter
    slices: Array
    rows: Array


@table_of_field
def _packed(
    field: SourceField, altitude_m: float, reach_m: float, sizes: AirSizes
) -> _PackedMatter:
    # Under any sun.
    matter = matter_before(field, altitude_m, (0.0, 1.0, 0.0), reach_m, sizes)
    (air,), rays = groups_of_air(field.thinned), matter.rays
    slices = np.zeros((*matter.centre.shape[1:3], SLICE_FLOATS), dtype=np.float32)
    pack_slices(
        air, matter.distance_m, matter.centre[0], matter.weight[0], matter.colours[0], slices
    )
    radius = air.ground_radius_m + rays.altitude_m
    above = rays.altitude_m * (radius + air.ground_radius_m) / (radius * radius)
    rows = np.stack([radius, above, rays.mu, np.zeros_like(radius)], axis=-1)
    return _PackedMatter(matter, Array(slices), single_array(rows))


# One while the sun moves: not uploaded again.
@table_of_field
def _angles(field: SourceField, altitude_m: float) -> Array:
    """The shader's `Phases` (n, 20)."""
    phases = channel_phases(field, altitude_m)
    return phases_on_card(phases.lanes[0], phases.channels)
