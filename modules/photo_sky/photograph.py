"""The sun found in a panorama of the sky and taken out of it, so that nothing counts twice.

Pixels are the photograph's own unit of radiance; directions are world axes with the panorama's
middle column north: what turns it and scales it comes later.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from photo_sky.read_gltf import GltfSun
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.numeric_types import FloatArray

# Light within this angle of the brightest pixel may be the sun's: the disc, its blur in the lens.
_SUN_REACH_RAD = float(np.radians(6.0))
# The ring around it says how bright the sky is beside the sun.
_RING_RAD = float(np.radians(10.0))
# Light above so many times the ring's luminance is the sun's.
_ABOVE_RING = 3.0
# Less than this share of all light on level ground is a bright cloud, no sun.
_LEAST_SHARE = 0.02
# Blue over red, of a sun above the air with room for a camera's white balance.
_BLUEST = 2.0
# Finer than this, pixels are averaged.
_MOST_ROWS = 2048


@dataclass(frozen=True, eq=False)
class Photograph:
    """A sky without its sun, and the sun.

    Attributes:
        sky: radiance (h, 2 h, 3), where the sun stood no brighter than the edge of its glow.
        sun_direction: unit vector (3,), or None where no sun is seen.
        sun_irradiance: (3,) on a plane that faces the sun; its luminance and the sky's sum to what
            the photograph has, on every plane that the whole sun lights.
    """

    sky: FloatArray
    sun_direction: FloatArray | None
    sun_irradiance: FloatArray

    @cached_property
    def level_irradiance(self) -> FloatArray:
        """Irradiance (3,) of sky and sun on level ground."""
        total = horizontal_irradiance(self.sky)
        if self.sun_direction is not None:
            total = total + self.sun_irradiance * max(float(self.sun_direction[1]), 0.0)
        return total


def photograph_of(pixels: FloatArray) -> Photograph:
    """Find the sun of a panorama (h, 2 h, 3), and take it out."""
    picture = _reduced(pixels)
    height = len(picture)
    directions = lat_long_directions(height)
    seen = luminance(picture)
    seen[height // 2 :] = 0.0
    row, column = np.unravel_index(int(np.argmax(seen)), seen.shape)
    cosine = directions @ directions[row, column]
    above = directions[..., 1] > 0.0
    near = above & (cosine > np.cos(_SUN_REACH_RAD))
    ring = above & (cosine <= np.cos(_SUN_REACH_RAD)) & (cosine > np.cos(_RING_RAD))
    none = Photograph(np.maximum(picture, 0.0), None, np.zeros(3))
    if not ring.any():
        return none
    # The rest is as bright as the glow's edge, so that no hole shows. Values below 0 beside the sun
    # come from sharpening: with the sun's values they sum to its light.
    edge = _ABOVE_RING * np.maximum(np.median(picture[ring], axis=0), 0.0)
    spoiled = near & ((picture <= 0.0) | (picture > edge)).any(axis=-1)
    excess = np.where(spoiled[..., None], picture - edge, 0.0)
    weight = solid_angles(height)[:, None]
    moment = np.einsum("ij,ijk->k", luminance(excess) * weight, directions)
    length = float(np.linalg.norm(moment))
    if length == 0.0:
        return none
    direction = moment / length
    # Irradiance of a plane that faces the sun: a wide glow counts by its cosine.
    faced = weight * np.maximum(directions @ direction, 0.0)
    facing = np.einsum("ijc,ij->c", excess, faced)
    level = float(luminance(facing)) * direction[1]
    if level < _LEAST_SHARE * float(luminance(horizontal_irradiance(picture))):
        return none
    return Photograph(np.maximum(picture - excess, 0.0), direction, _as_a_sun(facing))


def with_sun(pixels: FloatArray, sun: GltfSun, cd_m2_per_unit: float) -> Photograph:
    """A panorama (h, 2 h, 3) without a sun in it, and the sun that its file states."""
    in_units = sun.illuminance_lx / cd_m2_per_unit
    return Photograph(_reduced(pixels), sun.direction, in_units)


def _as_a_sun(irradiance: FloatArray) -> FloatArray:
    """The sun's light, white of the same luminance where it is bluer than any sun.

    Files packed with loss may keep the disc in one channel alone, and less than none in another.
    """
    red, _, blue = irradiance
    of_a_sun = irradiance.min() >= 0.0 and blue <= _BLUEST * red
    return irradiance if of_a_sun else np.full(3, float(luminance(irradiance)))


def solid_angles(height: int) -> FloatArray:
    """Solid angle (height,) of a pixel in each row of a panorama, in sr."""
    edges = np.cos(np.linspace(0.0, np.pi, height + 1))
    return (edges[:-1] - edges[1:]) * np.pi / height


def horizontal_irradiance(picture: FloatArray) -> FloatArray:
    """Irradiance (3,) on level ground by the upper half of a panorama; exact for its pixels."""
    height = len(picture)
    edges = np.cos(np.linspace(0.0, np.pi, height + 1)[: height // 2 + 1])
    weight = 0.5 * (edges[:-1] ** 2 - edges[1:] ** 2) * np.pi / height
    return np.einsum("ijc,i->c", picture[: height // 2], weight)


def _reduced(pixels: FloatArray) -> FloatArray:
    """Whole blocks of pixels averaged, until there are few enough; by solid angle."""
    block = 1
    while len(pixels) > _MOST_ROWS * block and len(pixels) % (2 * block) == 0:
        block *= 2
    if block == 1:
        return np.array(pixels)
    height = len(pixels) // block
    weight = solid_angles(len(pixels)).reshape(height, block, 1)
    rows = pixels.reshape(height, block, 2 * height, block, 3).mean(axis=3)
    return (rows * weight[..., None]).sum(axis=1) / weight.sum(axis=1)[..., None]
