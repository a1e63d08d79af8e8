"""Latitude-longitude and fisheye panoramas, and unfolded cubes, from a cube map."""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.cube_map import sample_cube
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu


def lat_long_directions(height: int, north_offset_rad: float = 0.0) -> NDArray[np.float64]:
    """World directions (height, 2 height, 3); north in the middle, zenith on the top row."""
    azimuth = ((np.arange(2 * height) + 0.5) / height - 1.0) * np.pi
    elevation = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    enu = direction_from_angles(azimuth[None, :], elevation[:, None])
    return world_from_enu(enu, north_offset_rad)


def fisheye_directions(
    size: int, north_offset_rad: float = 0.0
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """World directions (size, size, 3) of an equidistant fisheye, and which pixels lie inside.

    Looking up with north at the top: east is on the left, as on a star chart.
    """
    c = (2.0 * np.arange(size) + 1.0) / size - 1.0
    right, up = np.meshgrid(c, -c)
    radius = np.hypot(right, up)
    azimuth = np.arctan2(-right, up)
    elevation = 0.5 * np.pi * (1.0 - np.minimum(radius, 1.0))
    enu = direction_from_angles(azimuth, elevation)
    return world_from_enu(enu, north_offset_rad), radius <= 1.0


def sample_sky(cube: NDArray[np.floating], direction: NDArray[np.floating]) -> NDArray[np.float64]:
    """Look-up (..., 3) of a sky's cube map (6, n, n, 3) at world directions (..., 3).

    Directions are kept half a texel away from the horizon on their own side of it: linear
    filtering across it would mix sky and ground into a grey band.
    """
    d = np.array(direction, dtype=np.float64)
    row = np.maximum(np.abs(d[..., 0]), np.abs(d[..., 2])) / cube.shape[1]
    d[..., 1] = np.where(d[..., 1] >= 0.0, np.maximum(d[..., 1], row), np.minimum(d[..., 1], -row))
    return sample_cube(cube, d)


def unfold_cube(cube: NDArray[np.floating]) -> NDArray[np.floating]:
    """The faces (6, n, n, C) as a cross (3 n, 4 n, C), as seen from inside, north in the middle.

    The row of the horizon reads west, north, east, south; the zenith is above north. What
    lies outside the cross is zero.
    """
    n = cube.shape[1]
    cross = np.zeros((3 * n, 4 * n, cube.shape[-1]), cube.dtype)
    # Seen from inside the cube OpenGL's faces are mirror images. Flip the sides left to right,
    # zenith and nadir top to bottom, which also puts their northern rows next to north's face.
    for column, face in enumerate((1, 5, 0, 4)):
        cross[n : 2 * n, column * n : (column + 1) * n] = cube[face][:, ::-1]
    cross[:n, n : 2 * n] = cube[2][::-1]
    cross[2 * n :, n : 2 * n] = cube[3][::-1]
    return cross
