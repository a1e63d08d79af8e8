"""The tables of a solved atmosphere as scattered_light.glsl reads them, uploaded once.

Of an atmosphere of four wavelengths at most.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.field_tables import table_of_field
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.source_field import source_of_group
from bruneton_sky.solver.wavelength_groups import LANES, groups_of_air
from vrut_lite.array import Array
from vrut_lite.messages.gpu_job import Number
from vrut_lite.sky.shader_text import floats

if TYPE_CHECKING:
    from bruneton_sky.solver.later_order_kernels import Source

PHASES_BINDING = 7
# Kinds of particles that the shader keeps apart, at most: see `particles.kinds_of`.
_KINDS = 4


class FieldOnCard(NamedTuple):
    """A field's tables as buffers by binding, and the uniforms of their shapes."""

    buffers: tuple[tuple[int, Array], ...]
    uniforms: dict[str, Number | tuple[Number, ...]]


# Kept while sun and observer move: neither made nor uploaded again.
@table_of_field
def field_on_card(field: SourceField) -> FieldOnCard:
    """Transmittance and source functions."""
    source, transmittance = source_of_group(field, 0), field.transmittance[0]
    suns = source.rayleigh.shape[2] // LANES
    (air,) = groups_of_air(field.thinned)
    return FieldOnCard(
        buffers=(
            (4, Array(transmittance.view())),
            (5, Array(_or_one(source.rayleigh).view())),
            (6, Array(_or_one(source.mie).view())),
            (8, single_array(_bends(source))),
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


def phases_on_card(lanes: NDArray[np.float32], channels: NDArray[np.float32]) -> Array:
    """The shader's `Phases` (n, 20): functions of kinds (n, kinds * 4) and channels (n, 3)."""
    # Kinds that share a phase function are one.
    spare = np.tile(lanes[:, :LANES], _KINDS - lanes.shape[1] // LANES)
    return single_array(np.concatenate([lanes, spare, np.pad(channels, ((0, 0), (0, 1)))], axis=1))


def single_array(values: NDArray[np.floating]) -> Array:
    """The values as float32."""
    return Array(values.astype(np.float32))


def _bends(source: "Source") -> NDArray[np.float32]:
    """The shader's `Bends` (altitudes, suns, 2); of a dark field one altitude's more."""
    bend = source.bend if source.bend.size else np.zeros((2, source.bend.shape[1]), np.float32)
    return np.stack(np.broadcast_arrays(bend, source.pace), axis=-1)


def _or_one(table: NDArray[np.float32]) -> NDArray[np.float32]:
    """The table, or four zeros: an empty buffer cannot be made."""
    return table if table.size else np.zeros(LANES, dtype=np.float32)
