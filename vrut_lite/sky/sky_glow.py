"""Sums the light of a clear sky and of glows behind its clouds."""

from typing import TypeVar

import msgspec
import numpy as np

from vrut_lite.array import Array
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.geometry.spherical_harmonics import (
    evaluate_irradiance,
    horizontal_irradiance,
    irradiance_coefficients,
)
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.sky import BackgroundChanged, SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.night_glow import glow_cube

Sky = TypeVar("Sky", BackgroundChanged, SkyRadianceChanged)
_UP = (0.0, 1.0, 0.0)
_DARK: Vector = (0.0, 0.0, 0.0)
# Edge of the cube by which a glow's irradiance is integrated.
_LIGHT_SIZE = 64


def with_glow(clear: SkyLightChanged, glow: Array, source: str) -> SkyLightChanged:
    """A clear sky with a glow added.

    The ground's radiance grows by as much as the light on it.

    Args:
        clear: the sky; its background is an array.
        glow: radiance (rows, columns, 3) of the upper hemisphere; see `SkyGlowAdded`.
        source: the module that posts the sum.
    """
    added = np.asarray(glow_cube(glow, _LIGHT_SIZE, _DARK), float)
    key, harmonics = clear.key_light, clear.ambient.irradiance_sh_rgb.values
    by_key = np.asarray(key.irradiance_rgb) * max(0.0, key.direction[1])
    before = np.maximum(evaluate_irradiance(harmonics, _UP), 0.0) + by_key
    share = 1.0 + horizontal_irradiance(added) / np.maximum(before, 1e-30)
    share = np.where(before > 0.0, share, 1.0)
    lower = texel_directions(_LIGHT_SIZE)[..., 1] <= 0.0
    ground = np.asarray(clear.background.ground_radiance_rgb)
    added[lower] = ground * (share - 1.0)
    radiance = clear.radiance
    return msgspec.structs.replace(
        clear,
        background=_brightened(clear.background, glow, share),
        ambient=msgspec.structs.replace(
            clear.ambient,
            irradiance_sh_rgb=Array(
                (harmonics + irradiance_coefficients(added)).astype(np.float32)
            ),
        ),
        radiance=None if radiance is None else _brightened(radiance, glow, share),
        layers=("glow",),
        source=source,
    )


def _brightened(sky: Sky, glow: Array, share: FloatArray) -> Sky:
    """A background or a sky's radiance with the glow above the horizon and brighter ground."""
    assert not isinstance(sky.cube, GpuTexture)
    cube = np.asarray(sky.cube.values, float) * sky.radiance_scale
    size = cube.shape[1]
    lower = texel_directions(size)[..., 1] <= 0.0
    cube[lower] *= share
    cube += glow_cube(glow, size, _DARK)
    texels, scale = encode_float16(cube)
    red, green, blue = (share * np.asarray(sky.ground_radiance_rgb)).tolist()
    return msgspec.structs.replace(
        sky, cube=Array(texels), radiance_scale=scale, ground_radiance_rgb=(red, green, blue)
    )
