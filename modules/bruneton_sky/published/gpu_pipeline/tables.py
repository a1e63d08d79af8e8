"""Precomputed tables as textures, and reading them back as arrays."""

from typing import Any, NamedTuple, Self

import numpy as np

from bruneton_sky.published.gpu_pipeline.air_buffer import LANES
from bruneton_sky.tables.sizes import TableSizes
from vrut_lite.numeric_types import FloatArray


class GpuTables(NamedTuple):
    """Tables of up to four wavelengths, RGBA32F, owned by the caller.

    The flat ones are (x: mu or mu_s, y: altitude); the four axes of the others are packed in
    three: x = nu * sizes.mu_s + mu_s, y = mu, z = altitude.

    Attributes:
        optical_depth: to the top of the atmosphere, -log of the transmittance.
        irradiance, scattering, single_mie: as in `Tables`.
    """

    optical_depth: Any
    irradiance: Any
    scattering: Any
    single_mie: Any

    @classmethod
    def empty(cls, context: Any, sizes: TableSizes) -> Self:
        """Textures without content."""
        return cls(
            flat_texture(context, sizes.transmittance_altitude, sizes.transmittance_mu),
            flat_texture(context, sizes.irradiance_altitude, sizes.irradiance_mu_s),
            scattering_texture(context, sizes),
            scattering_texture(context, sizes),
        )

    def release(self) -> None:
        """Free the memory."""
        for texture in self:
            texture.release()


def flat_texture(context: Any, rows: int, columns: int) -> Any:
    """A texture for a table (altitude, mu or mu_s)."""
    return context.texture((columns, rows), LANES, dtype="f4")


def scattering_texture(context: Any, sizes: TableSizes) -> Any:
    """A texture for a scattering table."""
    shape = sizes.nu * sizes.mu_s, sizes.mu, sizes.altitude
    return context.texture3d(shape, LANES, dtype="f4")


def read_flat(texture: Any, count: int) -> FloatArray:
    """A flat table (altitude, mu or mu_s, count) of the first wavelengths."""
    return _read(texture, texture.size[::-1], count)


def read_scattering(texture: Any, sizes: TableSizes, count: int) -> FloatArray:
    """A scattering table (altitude, mu, nu, mu_s, count) of the first wavelengths."""
    return _read(texture, sizes.scattering_shape, count)


def _read(texture: Any, shape: tuple[int, ...], count: int) -> FloatArray:
    values = np.frombuffer(texture.read(), np.float32).reshape(*shape, LANES)
    return values[..., :count].astype(float)
