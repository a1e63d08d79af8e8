"""The light of a clear sky and of the clouds before it, summed.

Radiance along a ray is a sum: the lit air before each layer adds its share of the clear sky's
light, the layer adds its own light through that air, and light from behind is multiplied by the
layer's transmittance. The air holds molecules and the key light's haze. Importing this module
imports numba.
"""

from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from clouds.model.cloud_layers import air_share, clear_light, lights_on
from clouds.model.cloud_light import ClearLight
from clouds.model.cloud_view import clouds_seen, sun_share
from vrut_lite.array import Array
from vrut_lite.atmosphere.clear_air import COLUMN_M, molecules_per_m
from vrut_lite.atmosphere.haze_layer import HazeLayer
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.geometry.cube_map import reduce_cube, texel_directions
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.geometry.spherical_harmonics import (
    horizontal_irradiance,
    irradiance_coefficients,
)
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.messages.sky import AmbientChanged, SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.numeric_types import FloatArray, Vector, vector
from vrut_lite.sky.sky_layer import Viewpoint

# Centroid wavelengths (nm) of linear sRGB.
_RGB_NM = np.array([635.0, 550.0, 465.0])


# An eye higher than this share of the clouds' base sees them otherwise than the ground does.
NEAR_GROUND = 0.1


class _OnGround(NamedTuple):
    """The summed sky (6, n, n, 3) from the ground, its harmonics (25, 3), and the ground's share.

    `share` (3,): light on level ground, relative to a clear sky's.
    """

    cube: FloatArray
    harmonics: FloatArray
    share: FloatArray


def light_under_clouds(
    layers: tuple[CloudLayer, ...], clear: SkyLightChanged, view: Viewpoint, size: int, source: str
) -> SkyLightChanged:
    """The sum of a clear sky and layers of clouds, from low to high.

    Args:
        layers: the clouds.
        clear: the clear sky, with its radiance.
        view: the eye, and the square to light.
        size: approximate edge of the background in texels.
        source: the module that posts the sum.

    Raises:
        ValueError: the clear sky's background has never left the GPU.
    """
    assert clear.radiance is not None
    sun = clear.key_light
    light = light_of(clear)
    share = _sun_share(layers, sun.direction, view.middle_m, view.half_width_m)
    on_ground = _on_ground(layers, light, clear.radiance, view.middle_m, share)
    texels, scale = encode_float16(on_ground.cube)
    radiance = SkyRadianceChanged(
        cube=Array(texels),
        radiance_scale=scale,
        ground_radiance_rgb=vector(on_ground.share * clear.radiance.ground_radiance_rgb),
        source=source,
    )
    near_ground = view.eye_m[1] - view.middle_m[1] <= NEAR_GROUND * layers[0].base_m
    if near_ground and size <= len(texels[0]):
        cube, scale = radiance.cube, radiance.radiance_scale
    else:
        seen, scale = encode_float16(_from_eye(layers, light, clear, on_ground.share, view, size))
        cube = Array(seen)
    through_to_eye = _sun_share(layers, sun.direction, view.eye_m, 0.0)
    seen_rgb = clear.background.seen_sun_irradiance_rgb or sun.irradiance_rgb
    return SkyLightChanged(
        background=msgspec.structs.replace(
            clear.background,
            cube=cube,
            radiance_scale=scale,
            ground_radiance_rgb=vector(on_ground.share * clear.background.ground_radiance_rgb),
            view=None,
            seen_sun_irradiance_rgb=vector(through_to_eye * np.asarray(seen_rgb)),
            source=source,
        ),
        key_light=msgspec.structs.replace(
            sun, irradiance_rgb=vector(share * np.asarray(sun.irradiance_rgb)), source=source
        ),
        ambient=AmbientChanged(
            irradiance_sh_rgb=Array(on_ground.harmonics.astype(np.float32)), source=source
        ),
        radiance=radiance,
        layers=("cloud layer",) * len(layers),
        source=source,
    )


def light_of(clear: SkyLightChanged) -> ClearLight:
    """The light of a clear sky on clouds."""
    ambient = clear.ambient
    return clear_light(clear.key_light, ambient.irradiance_sh_rgb.values, ambient.lamps_rgb)


def _on_ground(
    layers: tuple[CloudLayer, ...],
    light: ClearLight,
    radiance: SkyRadianceChanged,
    place_m: Vector,
    sun_share: float,
) -> _OnGround:
    clear = _radiance(radiance.cube, radiance.radiance_scale)
    upper = texel_directions(clear.shape[1])[..., 1] > 0.0
    added = np.zeros(clear.shape)
    added[upper] = sky_behind_clouds(layers, light, clear, upper, place_m) - clear[upper]
    sky = np.maximum(light.by_sky + horizontal_irradiance(added), 0.0)
    share = (sun_share * light.by_sun + sky) / light.on_ground
    added[~upper] = clear[~upper] * (share - 1.0)
    return _OnGround(clear + added, light.irradiance_sh + irradiance_coefficients(added), share)


def _from_eye(
    layers: tuple[CloudLayer, ...],
    light: ClearLight,
    clear: SkyLightChanged,
    ground_share: FloatArray,
    view: Viewpoint,
    size: int,
) -> FloatArray:
    """Radiance (6, n, n, 3) of the background with the clouds in it."""
    if not isinstance(clear.background.cube, Array):
        raise ValueError("the sum of sky and clouds needs the sky as an array")
    cube = _radiance(clear.background.cube, clear.background.radiance_scale)
    if cube.shape[1] > size:
        cube = reduce_cube(cube, size)
    lower = texel_directions(cube.shape[1])[..., 1] <= 0.0
    cube[lower] *= ground_share
    everywhere = np.ones(lower.shape, bool)
    return sky_behind_clouds(layers, light, cube, everywhere, view.eye_m).reshape(cube.shape)


def _radiance(cube: Array, scale: float) -> FloatArray:
    return np.asarray(cube.values, dtype=float) * scale


def sky_behind_clouds(
    layers: tuple[CloudLayer, ...],
    light: ClearLight,
    clear: NDArray[np.floating],
    part: NDArray[np.bool_],
    eye_m: Vector,
) -> FloatArray:
    """Radiance (n, 3) of a clear sky (6, size, size, 3) behind clouds, of those texels."""
    size = clear.shape[1]
    directions = texel_directions(size)[part]
    # Transmittance of the nearer layers, and the share of the clear sky's light of the air so far.
    passed = np.ones((len(directions), 1))
    kept, own, air_so_far = np.zeros((3, len(directions), 3))
    for layer, light_on in from_nearest(layers, lights_on(layers, light), eye_m[1]):
        seen = clouds_seen(layer, light_on, eye_m, directions, 0.5 * np.pi / size)
        before, all_of_it = _air_depths(light.haze, eye_m[1], directions[:, 1], seen.distance_m)
        share = -np.expm1(-before) / np.maximum(-np.expm1(-all_of_it), 1e-9)
        # Rays that meet no cloud have a distance of 0, which changes nothing.
        share = np.maximum(np.clip(share, 0.0, 1.0), air_so_far)
        lit = air_share(layer, light_on, light, eye_m[1])
        kept += passed * (share - air_so_far) * lit
        own += passed * seen.radiance * np.exp(-before)
        passed = passed * seen.transmittance[:, None]
        air_so_far = share
    return np.asarray(clear[part] * (kept + passed * (1.0 - air_so_far)) + own)


def _sun_share(
    layers: tuple[CloudLayer, ...], sun: Vector, middle_m: Vector, half_width_m: float
) -> float:
    """Share of the sun's light that passes all layers, in the mean over a level square."""
    shares = [sun_share(layer, sun, middle_m, half_width_m) for layer in layers]
    return float(np.prod(shares))


def from_nearest(
    layers: tuple[CloudLayer, ...], lights: tuple[ClearLight, ...], altitude_m: float
) -> list[tuple[CloudLayer, ClearLight]]:
    """Layers and the light on each, from the nearest to an altitude on."""
    lit_layers = zip(layers, lights, strict=True)
    return sorted(lit_layers, key=lambda lit: _distance_m(lit[0], altitude_m))


def air_kinds(haze: tuple[HazeLayer, ...]) -> list[tuple[float, FloatArray]]:
    """Scale height (m) and extinction (3,) per m at sea level of molecules and of low haze."""
    # Clouds lie below the stratosphere's aerosol.
    low = [layer for layer in haze if layer.peak_m is None]
    of_haze = [(layer.height_m, layer.depth_at(_RGB_NM) / layer.height_m) for layer in low]
    return [(COLUMN_M, molecules_per_m(_RGB_NM)), *of_haze]


def _distance_m(layer: CloudLayer, altitude_m: float) -> float:
    return max(layer.base_m - altitude_m, altitude_m - layer.top_m, 0.0)


def _air_depths(
    haze: tuple[HazeLayer, ...], eye_altitude_m: float, mu: FloatArray, distance_m: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Optical depths (n, 3) of the air up to clouds (n,), and up to ground or space.

    mu (n,): the rays' zenith cosines.
    """
    horizontal_m = distance_m * np.sqrt(np.maximum(1.0 - mu * mu, 0.0))
    far_altitude_m = eye_altitude_m + distance_m * mu + horizontal_m**2 / (2.0 * GROUND_RADIUS_M)
    before, whole = np.zeros((2, len(mu), 3))
    for scale_m, per_m in air_kinds(haze):
        in_m = distance_m * _mean_density(eye_altitude_m, far_altitude_m, scale_m)
        before += in_m[:, None] * per_m
        # Along the horizon there is as much as along so many scale heights.
        most = np.sqrt(0.5 * np.pi * GROUND_RADIUS_M / scale_m)
        upward = scale_m * np.exp(-eye_altitude_m / scale_m)
        downward = scale_m * -np.expm1(-eye_altitude_m / scale_m)
        through_m = np.where(mu > 0.0, upward, downward) / np.maximum(np.abs(mu), 1.0 / most)
        whole += through_m[:, None] * per_m
    return before, whole


def _mean_density(from_m: float, to_m: FloatArray, scale_m: float) -> FloatArray:
    """Mean density (n,) between altitudes, relative to sea level."""
    rise = (np.maximum(to_m, 0.0) - from_m) / scale_m
    level = np.abs(rise) < 1e-6
    mean = np.where(level, 1.0, -np.expm1(-rise) / np.where(level, 1.0, rise))
    return np.asarray(np.exp(-from_m / scale_m) * mean)
