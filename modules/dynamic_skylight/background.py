"""The full sphere: sky above the horizon, lit ground below."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamic_skylight.twilight import HourSky
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance
from vrut_lite.numeric_types import Float32Array, FloatArray

SIDE_FACES = (0, 1, 4, 5)
BOTTOM_FACE = 3


def ground_radiance(
    sky_cube: Float32Array,
    sun_irradiance_rgb: FloatArray,
    apparent_elevation_rad: float,
    albedo: ArrayLike,
) -> FloatArray:
    """Radiance (3,) of level Lambertian ground, W m^-2 sr^-1: albedo, () or (3,), / pi times E.

    E is the sky's irradiance (from the upper half of a cube map, in world axes) plus the direct
    sun's (given on a plane that faces it) times the sine of its elevation.
    """
    sun = sun_irradiance_rgb * max(np.sin(apparent_elevation_rad), 0.0)
    total: FloatArray = horizontal_irradiance(sky_cube) + sun
    return np.asarray(albedo) / np.pi * total


def sphere(
    sky: HourSky,
    ground_rgb: FloatArray,
    size: int,
    sun_azimuth_rad: float,
) -> Float32Array:
    """Cube map (6, size, size, 3) of sky and ground, world axes, without the sun's disc.

    The azimuth is the world's (from -Z, clockwise from above). In cubes of odd size the middle
    row, which straddles the horizon, is ground.
    """
    cube = sky.cube_map(size, sun_azimuth_rad)
    fill_ground(cube, ground_rgb)
    return cube


def fill_ground(cube: Float32Array | NDArray[np.float16], ground_rgb: FloatArray) -> None:
    """Set every texel of a contiguous cube at or below the horizon to the ground's radiance."""
    size = cube.shape[1]
    # By rows of texels: numpy is slow at rows of three numbers.
    rows, row = cube.reshape(6, size, 3 * size), np.tile(ground_rgb.astype(cube.dtype), size)
    assert np.may_share_memory(rows, cube)
    rows[BOTTOM_FACE] = row
    for face in SIDE_FACES:
        rows[face, size // 2 :] = row
