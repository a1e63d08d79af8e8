"""A `CloudLayer` seen by an eye, on the CPU: radiance, transmittance, and shadows.

The frame's shaders draw the same clouds finer (render/clouds). Importing this module imports numba.
"""

import os
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from clouds.model.cloud_density import (
    distance_up_m,
)
from clouds.model.cloud_density_kernels import Field, optical_depths
from clouds.model.cloud_field import cloud_field
from clouds.model.cloud_light import ClearLight, light_from_below
from clouds.model.cloud_light_volume import LightVolume, light_volume
from clouds.model.cloud_march_kernels import LOWEST_SUN, Lights, look_at_clouds
from clouds.model.cloud_transport import scatterer, transport_tables
from vrut_lite.atmosphere.aerosols.phase_table import node_places
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.atmosphere.sunlight import sunlight_at_altitude
from vrut_lite.messages.clouds import CloudLayer, Particles
from vrut_lite.numeric_types import FloatArray, Vector

_SUNS = 256
_SUN_STEPS = 96
# Places along each side of the square over which shadows are averaged.
_SQUARE = 8
# Rings, and places around each, over which the phase function of a wide ray is averaged.
_RINGS = 8
# Rays of a block, the unit of work of a thread.
_BLOCK = 4096


class SeenClouds(NamedTuple):
    """Clouds along rays (...).

    Attributes:
        radiance: (..., 3) radiance of the clouds, W m^-2 sr^-1, without the air before them.
        transmittance: (...,) for light from behind.
        distance_m: (...,) their mean distance; 0 without clouds.
    """

    radiance: FloatArray
    transmittance: FloatArray
    distance_m: FloatArray


def clouds_seen(
    layer: CloudLayer,
    light: ClearLight,
    eye_m: Vector,
    directions: NDArray[np.floating],
    pixel_rad: float,
) -> SeenClouds:
    """The clouds along rays from an eye, world axes.

    Args:
        light: of the clear sky at the ground.
        directions: (..., 3), unit vectors.
        pixel_rad: the angle that each ray stands for.
    """
    field = cloud_field(layer, eye_m)
    lights = lights_on(layer, light, eye_m, pixel_rad)
    rays = np.ascontiguousarray(directions, dtype=float).reshape(-1, 3)
    out = np.empty((len(rays), 5))

    def look(start: int) -> None:
        block = slice(start, start + _BLOCK)
        look_at_clouds(field, lights, rays[block], pixel_rad, out[block])

    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        list(pool.map(look, range(0, len(rays), _BLOCK)))
    shape = directions.shape[:-1]
    return SeenClouds(
        out[:, :3].reshape(*shape, 3), out[:, 3].reshape(shape), out[:, 4].reshape(shape)
    )


def sun_share(layer: CloudLayer, sun: Vector, middle_m: Vector, half_width_m: float) -> float:
    """Share of the sun's light that passes the layer, in the mean over a level square."""
    across = (np.arange(_SQUARE) + 0.5) * (2.0 / _SQUARE) - 1.0
    places = np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2) * half_width_m
    direction = _on_horizon(sun, middle_m[1])
    return float(_passed(layer, cloud_field(layer, middle_m), places, direction).mean())


def transmittances(
    layer: CloudLayer, eye_m: Vector, directions: NDArray[np.floating]
) -> FloatArray:
    """Transmittance (n,) of the layer for light from far away that arrives at an eye from unit
    directions (n, 3), world axes.
    """
    field, here = cloud_field(layer, eye_m), np.zeros((1, 2))
    rays = np.ascontiguousarray(directions, dtype=float)
    return np.array([_passed(layer, field, here, ray)[0] for ray in rays])


def _passed(
    layer: CloudLayer, field: Field, places_m: FloatArray, direction: FloatArray
) -> FloatArray:
    """Transmittance (n,) from places (n, 2) beside the eye in one direction."""
    altitude_m = field.eye_altitude_m
    enter_m, leave_m = (
        max(distance_up_m(altitude_m, level_m, direction[1]), 0.0)
        for level_m in (layer.base_m, layer.base_m + layer.thickness_m)
    )
    if not leave_m > enter_m:
        return np.ones(len(places_m))
    depths = optical_depths(field, places_m, direction, enter_m, leave_m, _SUN_STEPS)
    return np.asarray(np.exp(-depths))


def _on_horizon(sun: Vector, altitude_m: float) -> FloatArray:
    """The sun's direction (3,), on the horizon of this altitude where the sun is below that."""
    lowest = -float(np.sqrt(2.0 * max(altitude_m, 0.0) / GROUND_RADIUS_M))
    x, sine, z = sun
    if sine >= lowest:
        return np.array([x, sine, z])
    across = np.hypot(x, z)
    east, south = (x / across, z / across) if across > 0.0 else (1.0, 0.0)
    level = np.sqrt(1.0 - lowest * lowest)
    return np.array([east * level, lowest, south * level])


def lights_on(layer: CloudLayer, light: ClearLight, eye_m: Vector, pixel_rad: float) -> Lights:
    """All light on a layer, as the march takes it: arguments are those of `clouds_seen`."""
    row = np.linspace(0.0, 1.0, _SUNS)
    sines = LOWEST_SUN + (1.0 - LOWEST_SUN) * row * row
    levels_m = layer.base_m, layer.base_m + layer.thickness_m
    tables, sun = transport_tables(), np.asarray(light.sun_direction, dtype=float)
    return Lights(
        sun=sun,
        suns=light.sun_passed
        * np.stack(
            [sunlight_at_altitude(max(level_m, 0.0), sines, light.haze) for level_m in levels_m]
        ),
        from_above=light.by_sky / np.pi,
        from_below=light_from_below(layer, light),
        phase=_phase_seen(layer.particles, pixel_rad),
        volume=light_volume_of(layer, eye_m, light.sun_direction),
        source=tables.source,
        diffused=scatterer(layer.particles).diffused,
    )


@lru_cache(maxsize=4)
def light_volume_of(layer: CloudLayer, eye_m: Vector, sun: Vector) -> LightVolume:
    """The light in a layer around an eye, cached for the next picture of the same sun."""
    field = cloud_field(layer, eye_m)
    return light_volume(field, np.asarray(sun, dtype=float), scatterer(layer.particles).diffused)


@lru_cache(maxsize=4)
def _phase_seen(particles: Particles, pixel_rad: float) -> FloatArray:
    """The particles' phase function (3, nodes, 3) in the mean over what a ray stands for.

    A quarter of droplets' light is diffracted into less than a texel of a small cube, in which the
    middles of texels must do: the mean is over a disc of three texels.
    """
    theta = 2.0 * np.arcsin(node_places())[:, None]
    ring = np.sqrt((np.arange(_RINGS) + 0.5) / _RINGS) * pixel_rad
    around = (np.arange(_RINGS) + 0.5) / _RINGS * np.pi
    r, a = (part.ravel() for part in np.meshgrid(ring, around))
    nu = np.cos(theta) * np.cos(r) + np.sin(theta) * np.sin(r) * np.cos(a)
    place = np.sqrt(np.clip(0.5 - 0.5 * nu, 0.0, 1.0))
    parts = [
        [np.interp(place, node_places(), row).mean(axis=1) for row in part.T]
        for part in scatterer(particles).phase
    ]
    return np.ascontiguousarray(np.swapaxes(parts, 1, 2))
