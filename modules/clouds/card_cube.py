"""The sum of sky and clouds as programs of a card: the twin of `sky_under_clouds`.

The card gets the processor's own numbers: the noises with their means, the light in the clouds, and
the tables. Importing this module imports numba.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from clouds.drawing.block import CLOUDS
from clouds.drawing.layer_textures import CloudSurroundings, ShadowPlane, packed_numbers
from clouds.model.cloud_density_kernels import Field
from clouds.model.cloud_field import cloud_field, noise_array
from clouds.model.cloud_grid import LEAST_SINE
from clouds.model.cloud_layers import air_share, lights_on
from clouds.model.cloud_light import ClearLight
from clouds.model.cloud_march_kernels import Lights
from clouds.model.cloud_transport import transport_tables
from clouds.model.cloud_view import light_volume_of
from clouds.model.cloud_view import lights_on as lights_of_march
from clouds.sky_under_clouds import air_kinds, from_nearest, light_of
from vrut_lite.array import Array
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.messages.gpu_job import GpuPass, UniformValue
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.numeric_types import Vector
from vrut_lite.sky.shader_text import floats, shader_source

_GROUP = 8
# As cloud_cube.comp and cloud_buffers.glsl bind and size them.
_NUMBERS, _NOISES, _DEPTHS, _DIFFUSE, _TRANSPORT, _TABLES, _AIR = range(7)
_LEVELS = 12


def cloud_passes(
    layers: tuple[CloudLayer, ...], light: ClearLight, eye_m: Vector, size: int, scale: float
) -> tuple[GpuPass, ...]:
    """Programs that put layers, from low to high, before the sky in image unit 0, over `scale`.

    Layers come from the nearest on; the images at units 2 and 3 carry what they leave.

    Args:
        layers: the clouds.
        light: of the clear sky.
        eye_m: below the clouds.
        size: edge of the cube map.
        scale: of its texels.
    """
    air = Array(
        np.array([[*per_m, scale_m] for scale_m, per_m in air_kinds(light.haze)], np.float32)
    )
    lit_layers = from_nearest(layers, lights_on(layers, light), eye_m[1])
    groups = -(-size // _GROUP)
    passes = []
    for number, (layer, light_on) in enumerate(lit_layers):
        field = cloud_field(layer, eye_m)
        lights = lights_of_march(layer, light_on, eye_m, 0.5 * np.pi / size)
        uniforms: dict[str, UniformValue] = {
            **_table_uniforms(field, lights),
            "is_first": int(number == 0),
            "is_last": int(number == len(lit_layers) - 1),
            "air_lit": floats(air_share(layer, light_on, light, eye_m[1])),
            "inverse_scale": floats(1.0 / scale)[0],
        }
        depths, diffuse = _volume_arrays(layer, eye_m, light_on.sun_direction)
        buffers = (
            (_NUMBERS, _numbers(layer, light_on, eye_m, size)),
            (_NOISES, noise_array(layer)),
            (_DEPTHS, depths),
            (_DIFFUSE, diffuse),
            (_TRANSPORT, _transport()),
            (_TABLES, _flat(lights.phase, lights.suns)),
            (_AIR, air),
        )
        passes.append(
            GpuPass(
                compute_shader=_shader(),
                uniforms=uniforms,
                groups=(groups, groups, 6),
                buffers=buffers,
            )
        )
    return tuple(passes)


def clouds_on_card(
    layers: tuple[CloudLayer, ...], clear: SkyLightChanged, eye_m: Vector, size: int, scale: float
) -> tuple[GpuPass, ...]:
    """`cloud_passes` under the light of a clear sky."""
    return cloud_passes(layers, light_of(clear), eye_m, size, scale)


def _numbers(layer: CloudLayer, light: ClearLight, eye_m: Vector, size: int) -> Array:
    """The numbers of a layer's block; what shades surfaces alone has no meaning here."""
    eye = np.asarray(eye_m, float)
    around = CloudSurroundings(eye_m=eye, ground_level_m=0.0, pixel_rad=0.5 * np.pi / size)
    # The light volume lies around the eye.
    plane = ShadowPlane(
        centre_m=eye[[0, 2]], near_m=1.0, growth=0.0, least_sine=LEAST_SINE, texels=1
    )
    packed = packed_numbers(CLOUDS, layer, light, light.by_sky, around, plane, 0.0)
    return Array(np.frombuffer(packed, np.float32).copy())


def _table_uniforms(field: Field, lights: Lights) -> dict[str, UniformValue]:
    """How the tables of cloud_buffers.glsl are laid out."""
    levels = np.zeros((3, _LEVELS, 2), int)
    levels[:, : field.levels.shape[1]] = field.levels
    edges, columns = lights.volume.depths.shape[:2]
    return {
        "noise_levels": tuple(levels.ravel().tolist()),
        "noise_last": floats(field.last),
        "volume_shape": (columns, edges),
        "table_nodes": (lights.phase.shape[1], lights.suns.shape[1]),
    }


# The same objects again, so that they need not be sent to the card again.
@lru_cache(maxsize=4)
def _volume_arrays(layer: CloudLayer, eye_m: Vector, sun: Vector) -> tuple[Array, Array]:
    volume = light_volume_of(layer, eye_m, sun)
    # Copies: an `Array` may not be written to, and kernels are compiled for those that may.
    return Array(volume.depths.copy()), Array(volume.diffuse.copy())


@lru_cache(maxsize=1)
def _transport() -> Array:
    return Array(transport_tables().source.copy())


def _flat(*tables: NDArray[np.floating]) -> Array:
    return Array(np.concatenate([table.ravel() for table in tables]).astype(np.float32))


@lru_cache(maxsize=1)
def _shader() -> str:
    text = shader_source("cloud_cube.comp", "clouds")
    whole = text.replace("//!clouds\n", CLOUDS.glsl_of_buffer(_NUMBERS))
    # Without comments: the text is in every journal, and four tenths of it are comments.
    lines = (line.partition("//")[0].rstrip() for line in whole.splitlines())
    return "\n".join(filter(None, lines)) + "\n"
