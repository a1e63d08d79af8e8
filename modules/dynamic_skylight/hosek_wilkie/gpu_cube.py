"""The Hosek-Wilkie cube map as a GPU job; the formula's numbers are its uniforms."""

from functools import lru_cache
from importlib.resources import files

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamic_skylight.hosek_wilkie.fast_formula import (
    ANGLE_POLYNOMIAL,
    EXP2M1_POLYNOMIAL,
    fold,
)
from dynamic_skylight.hosek_wilkie.formula import HORIZON_OFFSET
from dynamic_skylight.hosek_wilkie.sky import ALL_FACES, HosekWilkieSky
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.messages.gpu_job import GpuJob, TexelFormat, UniformValue, in_format

# In the order of `fold`, as the shader calls them.
_NUMBERS = (
    "zenith_base", "zenith_factor", "zenith_decay", "CD", "D", "E", "F", "G", "gap", "I", "H",
)  # fmt: skip
_GROUP = 8


def gpu_cube_job(
    module: str,
    job: str,
    sky: HosekWilkieSky,
    sun_azimuth_rad: float,
    ground_rgb: ArrayLike,
    size: int,
    scale: float,
    wanted: tuple[int, ...] = ALL_FACES,
    read_back: bool = False,
    format: TexelFormat = "rgba16f",
) -> GpuJob:
    """A job that writes sky and ground (3,), divided by `scale`, to a cube of this format.

    Faces, axes and azimuth are those of `HosekWilkieSky.cube_map`. Texels of the faces that are
    not wanted are left undefined.
    """
    groups = -(-size // _GROUP)
    return GpuJob(
        module=module,
        job=job,
        compute_shader=in_format(_shader(), format),
        uniforms=_uniforms(sky, sun_azimuth_rad, ground_rgb, scale, wanted),
        output="cube",
        size=size,
        format=format,
        groups=(groups, groups, len(wanted)),
        read_back=read_back,
    )


def _uniforms(
    sky: HosekWilkieSky,
    sun_azimuth_rad: float,
    ground_rgb: ArrayLike,
    scale: float,
    wanted: tuple[int, ...],
) -> dict[str, UniformValue]:
    numbers = fold(sky.rgb_distribution, sky.rgb_mean_radiance / scale)
    sun = world_from_enu(direction_from_angles(sun_azimuth_rad, sky.sun_elevation_rad))
    return {
        "faces": (*wanted, *(0,) * (len(ALL_FACES) - len(wanted))),
        "sun": _floats(sun),
        "ground": _floats(np.asarray(ground_rgb) / scale),
        "angle_polynomial": _floats(np.array(ANGLE_POLYNOMIAL)),
        "exp2m1_polynomial": _floats(np.array(EXP2M1_POLYNOMIAL)),
        "horizon_offset": HORIZON_OFFSET,
        **{name: _floats(column) for name, column in zip(_NUMBERS, numbers.T, strict=True)},
    }


def _floats(values: NDArray[np.floating]) -> tuple[float, ...]:
    # In single precision, as the shader reads them: the last bits of float64 differ between
    # processors and would change the job's recipe, so that a journal would not replay elsewhere.
    return tuple(float(value) for value in values.astype(np.float32))


@lru_cache(maxsize=1)
def _shader() -> str:
    return (files("dynamic_skylight") / "shaders" / "hosek_wilkie.comp").read_text("utf-8")
