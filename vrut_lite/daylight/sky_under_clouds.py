"""The light of a clear sky and of the clouds before it, summed.

Radiance along a ray: clear sky x (T + (1 - T) a) + clouds x t. T is the clouds' transmittance, t
that of the air before them, and a the share of the clear sky's light that this air sends. The air
is that of molecules alone. Importing this module imports numba.
"""

from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.daylight.cloud_density import PLANET_RADIUS_M
from vrut_lite.daylight.cloud_light import ClearLight
from vrut_lite.daylight.cloud_view import clouds_seen, sun_share
from vrut_lite.daylight.clouds import CloudLayer
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged
from vrut_lite.daylight.sky_light import SkyLightChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.geometry.cube_map import reduce_cube, texel_directions
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.geometry.spherical_harmonics import (
    horizontal_irradiance,
    irradiance_coefficients,
)
from vrut_lite.numeric_types import FloatArray, Vector

# Rayleigh scattering at sea level at 635, 550 and 465 nm, where linear sRGB has its weight.
_RAYLEIGH_PER_M = np.array([6.6e-6, 1.19e-5, 2.36e-5])
_SCALE_HEIGHT_M = 8000.0
# Of an eye higher than this share of the clouds' base, light is looked up from the ground too.
_NEAR_GROUND = 0.1
_GROUND_CUBE_SIZE = 32


class Viewpoint(NamedTuple):
    """From where the sum is seen, and where its light falls: a level square around the middle.

    `eye_m` has its height over the scene's `middle_m`, which lies on the ground.
    """

    eye_m: Vector
    middle_m: Vector
    half_width_m: float


def light_under_clouds(
    layer: CloudLayer,
    background: BackgroundChanged,
    key_light: KeyLightChanged,
    ambient: AmbientChanged,
    view: Viewpoint,
    size: int,
    source: str,
) -> SkyLightChanged:
    """The sum of a clear sky and a layer of clouds, its cube map about `size` texels an edge.

    Raises:
        ValueError: the clear sky's cube map has never left the GPU.
    """
    if not isinstance(background.cube, Array):
        raise ValueError("the sum of sky and clouds needs the sky as an array")
    clear = background.cube.values.astype(np.float32) * np.float32(background.radiance_scale)
    if clear.shape[1] > size:
        clear = reduce_cube(clear, size)
    harmonics = np.asarray(ambient.irradiance_sh_rgb.values, dtype=float)
    light = ClearLight(key_light.direction, key_light.irradiance_rgb, harmonics)
    share = sun_share(layer, key_light.direction, view.middle_m, view.half_width_m)
    upper = texel_directions(clear.shape[1])[..., 1] > 0.0
    cube = np.array(clear, dtype=float)
    cube[upper] = _seen(layer, light, clear, upper, view.eye_m)
    added = cube - clear
    if view.eye_m[1] - view.middle_m[1] > _NEAR_GROUND * layer.base_m:
        added = _added_on_ground(layer, light, view.middle_m)
    on_ground = _ground_share(light, share, horizontal_irradiance(added))
    ground_rgb = on_ground * background.ground_radiance_rgb
    added[texel_directions(added.shape[1])[..., 1] <= 0.0] = (
        ground_rgb - background.ground_radiance_rgb
    )
    summed = harmonics + irradiance_coefficients(added)
    cube[~upper] = _seen(layer, light, clear * on_ground, ~upper, view.eye_m)
    texels, scale = encode_float16(cube)
    through_to_eye = sun_share(layer, key_light.direction, view.eye_m, 0.0)
    seen_rgb = background.seen_sun_irradiance_rgb or key_light.irradiance_rgb
    return SkyLightChanged(
        background=msgspec.structs.replace(
            background,
            cube=Array(texels),
            radiance_scale=scale,
            ground_radiance_rgb=_vector(ground_rgb),
            view=None,
            seen_sun_irradiance_rgb=_vector(through_to_eye * np.asarray(seen_rgb)),
            source=source,
        ),
        key_light=msgspec.structs.replace(
            key_light,
            irradiance_rgb=_vector(share * np.asarray(key_light.irradiance_rgb)),
            source=source,
        ),
        ambient=AmbientChanged(irradiance_sh_rgb=Array(summed.astype(np.float32)), source=source),
        layers=("clouds",),
        source=source,
    )


def _seen(
    layer: CloudLayer,
    light: ClearLight,
    clear: NDArray[np.floating],
    part: NDArray[np.bool_],
    eye_m: Vector,
) -> FloatArray:
    """Radiance (n, 3) of a clear sky (6, size, size, 3) behind clouds, of those texels."""
    size = clear.shape[1]
    directions = texel_directions(size)[part]
    seen = clouds_seen(layer, light, eye_m, directions, 0.5 * np.pi / size)
    before, all_of_it = _air_depths(eye_m[1], directions[:, 1], seen.distance_m)
    air_share = -np.expm1(-before) / np.maximum(-np.expm1(-all_of_it), 1e-9)
    transmittance = seen.transmittance[:, None]
    kept = transmittance + (1.0 - transmittance) * np.clip(air_share, 0.0, 1.0)
    return np.asarray(clear[part] * kept + seen.radiance * np.exp(-before))


def _air_depths(
    eye_altitude_m: float, mu: FloatArray, distance_m: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Optical depths (n, 3) of molecules up to clouds (n,), and up to ground or space.

    mu (n,): the rays' zenith cosines.
    """
    horizontal_m = distance_m * np.sqrt(np.maximum(1.0 - mu * mu, 0.0))
    far_altitude_m = eye_altitude_m + distance_m * mu + horizontal_m**2 / (2.0 * PLANET_RADIUS_M)
    before = distance_m * _mean_density(eye_altitude_m, far_altitude_m)
    # Along the horizon there is as much air as along 38 scale heights.
    upward = _SCALE_HEIGHT_M * np.exp(-eye_altitude_m / _SCALE_HEIGHT_M)
    downward = _SCALE_HEIGHT_M * -np.expm1(-eye_altitude_m / _SCALE_HEIGHT_M)
    whole = np.where(mu > 0.0, upward, downward) / np.maximum(np.abs(mu), 1.0 / 38.0)
    return before[:, None] * _RAYLEIGH_PER_M, whole[:, None] * _RAYLEIGH_PER_M


def _mean_density(from_m: float, to_m: FloatArray) -> FloatArray:
    """Mean density (n,) of air between altitudes, relative to sea level."""
    rise = (np.maximum(to_m, 0.0) - from_m) / _SCALE_HEIGHT_M
    level = np.abs(rise) < 1e-6
    mean = np.where(level, 1.0, -np.expm1(-rise) / np.where(level, 1.0, rise))
    return np.asarray(np.exp(-from_m / _SCALE_HEIGHT_M) * mean)


def _added_on_ground(layer: CloudLayer, light: ClearLight, place_m: Vector) -> FloatArray:
    """What clouds add to an even sky (6, n, n, 3) of the same irradiance, seen from the ground."""
    even = light.by_sky / np.pi
    clear = np.broadcast_to(even, (6, _GROUND_CUBE_SIZE, _GROUND_CUBE_SIZE, 3))
    upper = texel_directions(_GROUND_CUBE_SIZE)[..., 1] > 0.0
    added = np.zeros(clear.shape)
    added[upper] = _seen(layer, light, clear, upper, place_m) - even
    return added


def _ground_share(light: ClearLight, sun_share: float, added: FloatArray) -> FloatArray:
    """Light (3,) on level ground, relative to a clear sky's; `added` (3,) to the sky's."""
    now = sun_share * light.by_sun + np.maximum(light.by_sky + added, 0.0)
    return np.asarray(now / light.on_ground)


def _vector(values: FloatArray) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
