"""Frozen clouds as they are seen under a sun in many places, from which their maps are made."""

import math
from collections.abc import Callable, Iterable
from dataclasses import replace

import msgspec
import numpy as np
from light_transport.public import Illumination
from scipy.ndimage import convolve1d

from share.cloud_maps import COARSE, FINE, CloudMaps, CloudSamples, cloud_maps, map_directions
from share.frozen_clouds import FrozenClouds
from share.shared_scene import direction_of
from share.sky_table import SkyTable
from share.sun_places import SunPlaces
from vrut_lite.array import Array
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import sample_cube, texel_directions
from vrut_lite.geometry.encoding import decode_float16, encode_float16
from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged, SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector, vector

_SOURCE = "share"
_BLACK = (0.0, 0.0, 0.0)
_UP = (0.0, 1.0, 0.0)
# Edges (texels) of the cubes in which the clouds are seen by each sun, and once for `kept`: a sun
# takes 1.3 s of CPU a layer.
_CUBE, _KEPT_CUBE = 64, 128
# Elevation of the sun for `kept`, which depends on it a little.
_KEPT_SUN_RAD = math.radians(45.0)
# Radiance of an even sky that outshines the clouds, by which `kept` is measured.
_OUTSHINES = 2.0**24


def clear_light(
    cube: FloatArray | Float32Array, key: KeyLightChanged, lamps: Vector
) -> SkyLightChanged:
    """The light of a clear sky's cube (6, n, n, 3) with the ground's radiance in its lower half."""
    texels, scale = encode_float16(cube)
    ground = vector(np.asarray(cube, float)[texel_directions(len(cube[0]))[..., 1] < 0.0][0])
    harmonics = Array(irradiance_coefficients(np.asarray(cube, float)).astype(np.float32))
    radiance = SkyRadianceChanged(
        cube=Array(texels), radiance_scale=scale, ground_radiance_rgb=ground, source=_SOURCE
    )
    return SkyLightChanged(
        background=_background(radiance),
        key_light=key,
        ambient=AmbientChanged(irradiance_sh_rgb=harmonics, lamps_rgb=lamps, source=_SOURCE),
        radiance=radiance,
        source=_SOURCE,
    )


def _background(radiance: SkyRadianceChanged) -> BackgroundChanged:
    """The same sky for an eye on the ground."""
    return BackgroundChanged(
        cube=radiance.cube,
        radiance_scale=radiance.radiance_scale,
        ground_radiance_rgb=radiance.ground_radiance_rgb,
        source=_SOURCE,
    )


def _radiance(light: SkyLightChanged) -> FloatArray:
    assert light.radiance is not None
    found = decode_float16(light.radiance.cube.values, light.radiance.radiance_scale)
    return found.astype(float)


def _sky_under(
    clouds: FrozenClouds, cube: FloatArray | Float32Array, key: KeyLightChanged, lamps: Vector
) -> FloatArray:
    """Radiance (6, n, n, 3) of a clear sky's cube behind clouds."""
    return _radiance(clouds.light_under(clear_light(cube, key, lamps), len(cube[0])))


def _sun(
    clouds: FrozenClouds, table: SkyTable, true_rad: float, apparent_rad: float, azimuth_rad: float
) -> KeyLightChanged:
    """The sun in a place of a clear sky."""
    return msgspec.structs.replace(
        clouds.key_light,
        body="sun",
        direction=direction_of(azimuth_rad, apparent_rad),
        irradiance_rgb=vector(table.mixed(table.key, true_rad)),
    )


def _kept(clouds: FrozenClouds, table: SkyTable, size: int) -> FloatArray:
    """Share (6, size, size, 1) of the clear sky's light that is left, the mean of its colours."""
    key = _sun(clouds, table, _KEPT_SUN_RAD, _KEPT_SUN_RAD, 0.0)
    clear = clear_light(table.cube(size, _KEPT_SUN_RAD, 0.0), key, _BLACK)
    even = Array(np.ones((6, size, size, 3), np.float16))
    assert clear.radiance is not None
    bright = msgspec.structs.replace(clear.radiance, cube=even, radiance_scale=_OUTSHINES)
    found = clouds.light_under(
        msgspec.structs.replace(clear, background=_background(bright), radiance=bright), size
    )
    return np.clip(luminance(_radiance(found)) / _OUTSHINES, 0.0, 1.0)[..., None]


def maps_of(
    clouds: FrozenClouds,
    table: SkyTable,
    where: SunPlaces,
    apparent_of: Callable[[float], float],
    night: Illumination,
    lamps: Vector,
    tracked: Callable[[Iterable[int], int], Iterable[int]],
) -> CloudMaps:
    """The maps of frozen clouds.

    Args:
        where: the location, by the places of its light maps.
        night: the clear light of a moonless night.
        lamps: radiance of the lands around by their lamps then.
    """
    places = replace(where, declinations=3, hours=24, dusk_azimuths=4)
    direction = map_directions(COARSE).reshape(-1, 3)
    # As coarse as the skies: else light of gaps would remain in the components as a pale square.
    kept = _sampled(_kept(clouds, table, _CUBE), direction)
    suns, keys, lights = [], [], []
    count = len(places.heights)
    for number in tracked(range(count), count):
        true_rad, azimuth = float(places.heights[number]), float(places.azimuths[number])
        key = _sun(clouds, table, true_rad, apparent_of(true_rad), azimuth)
        cube, level = table.cube(_CUBE, true_rad, azimuth), table.level(true_rad)
        sky = _sky_under(clouds, cube, key, _BLACK)
        lights.append(_sampled(sky, direction) - kept * _sampled(cube, direction))
        lights[-1] /= level
        suns.append(key.direction)
        keys.append(np.asarray(key.irradiance_rgb) / level)
    # A moon without light: a sun below the horizon would light clouds aloft.
    dark = msgspec.structs.replace(
        clouds.key_light, body="moon", direction=_UP, irradiance_rgb=_BLACK
    )
    by_night = _sky_under(clouds, np.asarray(night.sky), dark, lamps)
    seen = CloudSamples(
        direction=direction,
        suns=np.array(suns),
        key=np.stack(keys),
        light=np.stack(lights),
        by_night=_sampled(by_night, direction) - kept * _sampled(night.sky, direction),
    )
    fine = _sampled(_kept(clouds, table, _KEPT_CUBE), map_directions(FINE).reshape(-1, 3))
    return cloud_maps(places, seen, _passed(clouds), fine.reshape(FINE, FINE))


def _passed(clouds: FrozenClouds) -> FloatArray:
    """T (FINE, FINE) in the mean over the width of a node: clouds' edges are sharper."""
    between = 2 * FINE - 1
    direction = map_directions(between).reshape(-1, 3)
    found = clouds.transmittance(direction).reshape(between, between)
    for axis in (0, 1):
        found = convolve1d(found, [0.25, 0.5, 0.25], axis, mode="nearest")
    return np.asarray(found[::2, ::2])


def _sampled(cube: FloatArray | Float32Array, direction: FloatArray) -> FloatArray:
    """Values (n, C) of a cube (6, m, m, C), kept a texel above the ground in its lower half."""
    lifted = direction.copy()
    lifted[:, 1] = np.maximum(lifted[:, 1], 1.0 / len(cube[0]))
    lifted /= np.linalg.norm(lifted, axis=1, keepdims=True)
    return sample_cube(cube, lifted)
