"""The light of a volume of air as a job for the GPU; the solved field is uploaded once.

The CPU computes the matter along the rays, row by row, the GPU the light of all columns.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bruneton_sky.air_volume.kernels import SLICE_FLOATS, pack_slices
from bruneton_sky.air_volume.volume import AirSizes, Matter, matter_before, volume_of
from bruneton_sky.field_tables import table_of_field
from bruneton_sky.sky_view.table import channel_phases
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.source_field import source_of_group
from bruneton_sky.solver.wavelength_groups import LANES, groups_of_air
from vrut_lite.array import Array
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_job import GpuJob, GpuTexture, Number
from vrut_lite.sky.shader_text import floats, shader_source

if TYPE_CHECKING:
    from bruneton_sky.solver.later_order_kernels import Source

_GROUP = 8
# Kinds of particles that the shader keeps apart, at most: see `particles.kinds_of`.
_KINDS = 4


class _FieldOnGpu(NamedTuple):
    """A field's tables as buffers by binding, and the uniforms of their shapes."""

    buffers: tuple[tuple[int, Array], ...]
    uniforms: dict[str, Number | tuple[Number, ...]]


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
    matter = matter_before(field, altitude_m, sun_direction, reach_m, count)
    tables = _on_gpu(field)
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
        buffers=(*_buffers_of(field, matter), *tables.buffers),
        output="3d",
        size=size,
        # Single precision: the brightest node is not known before the job has run.
        format="rgba32f",
        groups=(-(-count.columns // _GROUP), -(-rows // _GROUP), 1),
        read_back=read_back,
    )
    awaited = GpuTexture(size=size, format=made.format, recipe=made.recipe)
    return made, volume_of(field, matter, sun_direction, awaited, 1.0)


def _buffers_of(field: SourceField, matter: Matter) -> tuple[tuple[int, Array], ...]:
    """The buffers that change with sun and observer, by binding."""
    (air,), rays = groups_of_air(field.thinned), matter.rays
    slices = np.zeros((*matter.centre.shape[1:3], SLICE_FLOATS), dtype=np.float32)
    pack_slices(
        air, matter.distance_m, matter.centre[0], matter.weight[0], matter.colours[0], slices
    )
    radius = air.ground_radius_m + rays.altitude_m
    above = rays.altitude_m * (radius + air.ground_radius_m) / (radius * radius)
    rows = np.stack([radius, above, rays.mu, np.zeros_like(radius)], axis=-1)
    suns = np.stack([rays.mu_s, rays.nu], axis=-1)
    angles = _angles(field, matter.grid.observer_altitude_m)
    return (1, Array(slices)), (2, _floats(rows)), (3, _floats(suns)), (7, angles)


# Kept while sun and observer move: neither made nor uploaded again.
@table_of_field
def _on_gpu(field: SourceField) -> _FieldOnGpu:
    source, transmittance = source_of_group(field, 0), field.transmittance[0]
    suns = source.rayleigh.shape[2] // LANES
    (air,) = groups_of_air(field.thinned)
    return _FieldOnGpu(
        buffers=(
            (4, Array(transmittance.view())),
            (5, Array(_or_one(source.rayleigh).view())),
            (6, Array(_or_one(source.mie).view())),
            (8, _floats(_bends(source))),
        ),
        uniforms={
            "transmittances": (transmittance.shape[0], transmittance.shape[1] // LANES),
            "altitudes": (source.rayleigh.shape[0], source.mie.shape[0]),
            "directions": (suns, source.azimuth_cosine.size, source.mie.shape[1]),
            "sun_grid": floats(source.grid),
            "solar_irradiance": floats(air.solar_irradiance),
            "anisotropy": floats([air.anisotropy])[0],
        },
    )


# One while the sun moves: not uploaded again.
@table_of_field
def _angles(field: SourceField, altitude_m: float) -> Array:
    """The shader's `Phases` (n, 20)."""
    phases = channel_phases(field, altitude_m)
    lanes = phases.lanes[0]
    # Kinds that share a phase function are one.
    spare = np.tile(lanes[:, :LANES], _KINDS - lanes.shape[1] // LANES)
    channels = np.pad(phases.channels, ((0, 0), (0, 1)))
    return Array(np.concatenate([lanes, spare, channels], axis=1).astype(np.float32))


def _bends(source: "Source") -> NDArray[np.float32]:
    """The shader's `Bends` (altitudes, suns, 2); of a dark field one altitude's more."""
    bend = source.bend if source.bend.size else np.zeros((2, source.bend.shape[1]), np.float32)
    return np.stack(np.broadcast_arrays(bend, source.pace), axis=-1)


def _or_one(table: NDArray[np.float32]) -> NDArray[np.float32]:
    """The table, or four zeros: an empty buffer cannot be made."""
    return table if table.size else np.zeros(LANES, dtype=np.float32)


def _floats(values: NDArray[np.floating]) -> Array:
    return Array(values.astype(np.float32))
