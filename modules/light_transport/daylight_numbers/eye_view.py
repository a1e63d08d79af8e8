"""What an eye sees: luminances over its hemisphere, and the sun and its mirror images as discs."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.bake import Bake
from light_transport.daylight_numbers.glass import Glass
from light_transport.daylight_numbers.mirrored_sun import Flats, mirrored_suns
from light_transport.daylight_numbers.sensor_rays import OPEN_GROUND, SKY, ends_of, tree_with_glass
from light_transport.hour.gather import patches_gathered, sky_gathered
from light_transport.hour.illumination import Illumination
from light_transport.rays.sky_nodes import NODES
from light_transport.surfaces.surfaces import GROUND
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.cube_map import sample_cube
from vrut_lite.numeric_types import Float32Array, FloatArray

EDGE_PX = 320
# Of the sun's disc; its mean radius is 0.2666 degrees.
SUN_SR = 6.8e-5
_OFF = 1e-5
_UP = np.array([0.0, 1.0, 0.0])


class Eye(NamedTuple):
    """Where an eye is (3,), in metres, and where it looks, a unit vector (3,); world axes."""

    place_m: FloatArray
    towards: FloatArray

    @property
    def axes(self) -> FloatArray:
        """Unit vectors (3, 3): to the right, up and ahead."""
        along = _UP if abs(self.towards[1]) < 0.999 else np.array([0.0, 0.0, 1.0])
        right = np.cross(self.towards, along)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(right, self.towards), self.towards])


class EyeView(NamedTuple):
    """What is seen, a row a direction (N), in the eye's axes: right, up, ahead.

    Attributes:
        directions: (N, 3) unit vectors; solid_angle_sr: (N,).
        radiance_rgb: (N, 3), W m^-2 sr^-1, without discs of the sun.
        pixel: (N, 2) row and column of each in an angular fisheye of EDGE_PX.
        sun_directions: (K, 3) of discs of the sun, straight and mirrored; sun_irradiance: (K, 3)
            W m^-2 that each sends on a plane that faces it.
    """

    directions: FloatArray
    solid_angle_sr: FloatArray
    radiance_rgb: FloatArray
    pixel: NDArray[np.integer]
    sun_directions: FloatArray
    sun_irradiance: FloatArray

    @property
    def luminance(self) -> FloatArray:
        """Of each direction (N,), cd m^-2."""
        return np.asarray(luminance(self.radiance_rgb) * LUMENS_PER_WATT)

    @property
    def sun_illuminance(self) -> FloatArray:
        """Of each disc (K,), lux on a plane that faces it."""
        return np.asarray(luminance(self.sun_irradiance) * LUMENS_PER_WATT)


def eye_view(bake: Bake, glass: Glass, flats: Flats, eye: Eye, hour: Illumination) -> EyeView:
    """What an eye sees in an hour; diffuse surfaces, and the sun in mirrors."""
    directions, solid_angle, pixel, _ = hemisphere()
    tree = tree_with_glass(bake, glass)
    place = (eye.place_m - bake.surfaces.centre_m) / bake.surfaces.radius_m
    towards = directions @ eye.axes
    origin = np.broadcast_to(place, towards.shape)
    target, share = ends_of(bake, tree, glass, origin, towards)
    rows = row_radiances(bake, glass, hour, np.unique(target[target >= 0]))
    radiance = np.zeros(towards.shape)
    sky = sample_cube(hour.sky, towards)
    for which in range(2):
        end = target[:, which, None]
        seen = np.where(end >= 0, rows[np.maximum(target[:, which], 0)], 0.0)
        seen = np.where(end == SKY, sky, seen)
        seen = np.where(end == OPEN_GROUND, np.asarray(hour.ground_radiance_rgb), seen)
        radiance += share[:, which] * seen
    sun, power = np.asarray(hour.key_direction), np.asarray(hour.key_irradiance_rgb)
    sun_towards, sun_irradiance = mirrored_suns(bake, glass, flats, eye.place_m, sun, power)
    before = sun_towards @ eye.towards > 0.0
    return EyeView(
        directions,
        solid_angle,
        radiance,
        pixel,
        sun_towards[before] @ eye.axes.T,
        sun_irradiance[before],
    )


class Hemisphere(NamedTuple):
    """Directions (N, 3) of an angular fisheye in the eye's axes, solid angles (N,), and their row
    and column (N, 2) among `edge_px` pixels an edge, up first."""

    directions: FloatArray
    solid_angle_sr: FloatArray
    pixel: NDArray[np.integer]
    edge_px: int


@lru_cache(maxsize=4)
def hemisphere(edge_px: int = EDGE_PX) -> Hemisphere:
    """All that lies before an eye."""
    middle = (2.0 * np.arange(edge_px) + 1.0) / edge_px - 1.0
    y, x = np.meshgrid(-middle, middle, indexing="ij")
    radius = np.hypot(x, y)
    inside = radius < 1.0
    x, y, radius = x[inside], y[inside], np.maximum(radius[inside], 1e-9)
    angle = 0.5 * np.pi * radius
    level = np.sin(angle) / radius
    solid = (2.0 / edge_px) ** 2 * 0.5 * np.pi * level
    directions = np.stack([x * level, y * level, np.cos(angle)], axis=1)
    return Hemisphere(directions, solid, np.argwhere(inside), edge_px)


def row_radiances(
    bake: Bake, glass: Glass, hour: Illumination, rows: NDArray[np.integer]
) -> Float32Array | FloatArray:
    """Radiance (rows of the bake, 3) of those rows that are asked for; others are 0.

    Texels have their own light, and the sun by a ray from their middle; the rest that of patches.
    """
    column_light = bake.column_light(hour)
    assert bake.patches is not None
    found = column_light[bake.patches.column_of[NODES:], :3] / np.pi
    light = np.empty((bake.rows, 4), np.float32)
    sky_gathered(bake.table, column_light, 0, bake.rows, light)
    patches_gathered(bake.table, column_light, 0, bake.rows, light)
    texels = rows[(rows < len(bake.texels.pixel))]
    texels = texels[bake.good[texels]]
    normal = bake.texels.normal[texels].astype(float)
    sun = np.asarray(hour.key_direction, float)
    cosine = normal @ sun
    lit = np.zeros((len(texels), 3))
    facing = np.flatnonzero((cosine > 0.0) & (sun[1] > 0.0))
    if len(facing) and np.any(np.asarray(hour.key_irradiance_rgb) > 0.0):
        start = bake.texels.place[texels[facing]].astype(float) + _OFF * normal[facing]
        target, share = ends_of(
            bake, tree_with_glass(bake, glass), glass, start, np.tile(sun, (len(facing), 1))
        )
        free = (target[:, 0] == SKY)[:, None] * share[:, 0] * cosine[facing, None]
        lit[facing] = free * np.asarray(hour.key_irradiance_rgb)
    triangle = bake.colour_of[texels]
    reflectance = bake.surfaces.reflectance_rgb[triangle].astype(float)
    reflectance[bake.surfaces.part[triangle] == GROUND] = hour.ground_albedo_rgb
    emitted = bake.surfaces.emitted_rgb[triangle]
    found[texels] = (emitted + reflectance * (light[texels, :3] + lit)) / np.pi
    return found
