"""The shaders of the precomputation, compiled for table sizes and usable for any atmosphere."""

from typing import Any

from bruneton_sky.published.pipeline.setting import (
    DENSITY_ZENITH_ANGLES,
    IRRADIANCE_ZENITH_ANGLES,
    RAY_INTERVALS,
    TRANSMITTANCE_INTERVALS,
)
from bruneton_sky.tables.sizes import TableSizes
from vrut_lite.sky.shader_text import shader_source

NAMES = (
    "transmittance",
    "direct_irradiance",
    "single_scattering",
    "scattering_density",
    "indirect_irradiance",
    "multiple_scattering",
)
# Texels of a work group, as in the shaders.
FLAT_GROUP, DENSITY_GROUP, RAY_GROUP = 8, 128, 64
_VERSION = "#version 430\n"
_VEC4_BYTES = 16
# Shared memory of a work group that every OpenGL 4.3 has.
_SHARED_BYTES = 32768


def check_sizes(sizes: TableSizes) -> None:
    """Check that the shaders can make these tables.

    Raises:
        ValueError: a work group's shared memory has no room for them.
    """
    needed = _shared_bytes(sizes)
    if needed > _SHARED_BYTES:
        raise ValueError(
            f"nu or irradiance_mu_s of the tables is too large for a GPU: {needed} bytes of "
            f"shared memory are needed, {_SHARED_BYTES} are sure to be there"
        )


def compile_programs(context: Any, sizes: TableSizes) -> dict[str, Any]:
    """The compute shaders by name."""
    constants = _constants(sizes)
    return {name: context.compute_shader(_source(name, constants)) for name in NAMES}


def _shared_bytes(sizes: TableSizes) -> int:
    """Shared memory of `scattering_density`, the largest."""
    light = 2 * DENSITY_ZENITH_ANGLES * sizes.nu * _VEC4_BYTES
    angles = DENSITY_ZENITH_ANGLES * (_VEC4_BYTES + 4 + 2 * 8)
    return light + angles + sizes.irradiance_mu_s * _VEC4_BYTES


def _constants(sizes: TableSizes) -> str:
    values = {
        "TRANSMITTANCE_INTERVALS": TRANSMITTANCE_INTERVALS,
        "RAY_INTERVALS": RAY_INTERVALS,
        "DENSITY_ZENITH_ANGLES": DENSITY_ZENITH_ANGLES,
        "IRRADIANCE_ZENITH_ANGLES": IRRADIANCE_ZENITH_ANGLES,
        "IRRADIANCE_AZIMUTHS": 2 * IRRADIANCE_ZENITH_ANGLES,
        "TRANSMITTANCE_ALTITUDE": sizes.transmittance_altitude,
        "TRANSMITTANCE_MU": sizes.transmittance_mu,
        "IRRADIANCE_ALTITUDE": sizes.irradiance_altitude,
        "IRRADIANCE_MU_S": sizes.irradiance_mu_s,
        "ALTITUDE": sizes.altitude,
        "MU": sizes.mu,
        "NU": sizes.nu,
        "MU_S": sizes.mu_s,
    }
    return "".join(f"#define {name} {value}\n" for name, value in values.items())


def _source(name: str, constants: str) -> str:
    text = shader_source(f"pipeline_{name}.comp", "bruneton_sky.published")
    return text.replace(_VERSION, _VERSION + constants, 1)
