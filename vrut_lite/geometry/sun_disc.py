"""Draws the sun's disc into a picture of the sky, with limb darkening and exact irradiance."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.geometry.sky_map import SkyMap
from vrut_lite.numeric_types import FloatArray

# Samples of the disc, finer than the largest maps, in which it is some twelve pixels across.
_RINGS, _SPOKES = 96, 384


def disc_samples(
    direction: ArrayLike, angular_radius_rad: float, limb_darkening_rgb: Sequence[Sequence[float]]
) -> tuple[FloatArray, FloatArray]:
    """Directions (N, 3) of equal solid angle on the disc and the share (N, 3) of light from each.

    `limb_darkening_rgb` is as in `KeyLightChanged`: (3, K), in powers of cos psi; shares add up
    to 1 in each channel.
    """
    ring = np.sqrt((np.arange(_RINGS) + 0.5) / _RINGS)
    cos_psi = np.sqrt(1.0 - ring**2)
    brightness = np.stack(
        [np.polynomial.polynomial.polyval(cos_psi, channel) for channel in limb_darkening_rgb],
        axis=-1,
    )
    share = np.repeat(np.maximum(brightness, 0.0), _SPOKES, axis=0)
    turn = (np.arange(_SPOKES) + 0.5) * (2.0 * np.pi / _SPOKES)
    angle, turn = (
        part.ravel() for part in np.meshgrid(ring * angular_radius_rad, turn, indexing="ij")
    )
    middle, right, up = _axes(np.asarray(direction, dtype=float))
    across = np.cos(turn)[:, None] * right + np.sin(turn)[:, None] * up
    directions = np.cos(angle)[:, None] * middle + np.sin(angle)[:, None] * across
    return directions, share / share.sum(axis=0)


def disc_radiance(
    sky_map: SkyMap,
    direction: ArrayLike,
    irradiance_rgb: ArrayLike,
    angular_radius_rad: float,
    limb_darkening_rgb: Sequence[Sequence[float]],
) -> NDArray[np.float32]:
    """Radiance (..., 3) of the disc alone in a picture of this projection, W m^-2 sr^-1.

    `irradiance_rgb` (3,) is that of a plane that faces the sun, from the part of the disc above
    the horizon; radiance times solid angle sums to it. Light is shared among the four pixels
    around each direction, so that its centroid stays in place.
    """
    directions, share = disc_samples(direction, angular_radius_rad, limb_darkening_rgb)
    up = directions[:, 1] >= 0.0
    # From high above the ground the sun is seen below the level too.
    kept = share * up[:, None] if up.any() else share
    energy = kept / kept.sum(axis=0) * np.asarray(irradiance_rgb, dtype=float)
    return points_radiance(sky_map, directions, energy)


def points_radiance(
    sky_map: SkyMap, directions: FloatArray, energy: FloatArray
) -> NDArray[np.float32]:
    """Radiance (..., 3) of points of light in a picture of this projection, W m^-2 sr^-1.

    `energy` (N, 3): irradiance from each of the `directions` (N, 3) on a plane that faces it;
    radiance times solid angle sums to it.
    """
    pixel, portion = sky_map.spread(directions)
    solid_angle = sky_map.solid_angles()
    lit, place = np.unique(pixel, return_inverse=True)
    picture = np.zeros((solid_angle.size, 3), np.float32)
    for channel in range(3):
        light = np.bincount(place.ravel(), (portion * energy[:, channel, None]).ravel())
        picture[lit, channel] = light / np.maximum(solid_angle.ravel()[lit], np.finfo(float).tiny)
    return picture.reshape(*solid_angle.shape, 3)


def _axes(middle: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The direction and two unit vectors at right angles to it."""
    helper = np.array([1.0, 0.0, 0.0]) if abs(middle[1]) > 0.9 else np.array([0.0, 1.0, 0.0])
    right = np.cross(middle, helper)
    right /= np.linalg.norm(right)
    return middle, right, np.cross(right, middle)
