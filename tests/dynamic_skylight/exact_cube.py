"""What several tests of this folder share: exact skies on the texels of a cube map."""

import numpy as np

from vrut_lite.geometry.cube_map import texel_directions


def world_sun(azimuth_rad: float, elevation_rad: float) -> np.ndarray:
    """Unit world direction to a sun; azimuth from -Z towards +X."""
    horizontal = np.cos(elevation_rad)
    return np.array(
        [
            horizontal * np.sin(azimuth_rad),
            np.sin(elevation_rad),
            -horizontal * np.cos(azimuth_rad),
        ]
    )


def angles_to(direction: np.ndarray, sun: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Zenith angle and angle from the sun (...,) of unit world directions, exact at the sun."""
    theta = np.arctan2(np.hypot(direction[..., 0], direction[..., 2]), direction[..., 1])
    chord = np.linalg.norm(direction - sun, axis=-1)
    return theta, 2 * np.arcsin(np.minimum(chord / 2, 1.0))


def twin_cube(sky, size: int, azimuth_rad: float) -> np.ndarray:
    """The exact radiance on the texels of a cube map, 0 below the horizon."""
    direction = texel_directions(size)
    theta, gamma = angles_to(direction, world_sun(azimuth_rad, sky.sun_elevation_rad))
    return np.where(direction[..., 1:2] > 0, sky.radiance(theta, gamma), 0.0)


def assert_texels_agree(cube: np.ndarray, exact: np.ndarray) -> None:
    """Within 1e-5 of the larger of value and 1 % of the map's maximum."""
    allowed = 1e-5 * np.maximum(exact, 1e-2 * exact.max())
    assert np.all(np.abs(cube - exact) <= allowed)
