"""Light maps of a scene under the sun in many places, in the dark night, and by its lamps.

Light is linear in its sources: sunlight, moonlight, the night's glow and lamps add up, and the
moon's is the sun's in the moon's place times a factor, as in the sky itself (`sky_at_night.py`).
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from light_transport.public import (
    Illumination,
    MirrorRays,
    SceneTransport,
    TransportSizes,
    first_rays,
    mirror_parts,
    quality_for,
    surfaces_of,
)
from numpy.typing import NDArray

from share.cloud_maps import CloudMaps
from share.shared_scene import direction_of
from share.sky_table import SkyTable
from share.sun_places import SunPlaces
from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance, irradiance_coefficients
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector, vector
from vrut_lite.sky.night_glow import glow_cube

# Edge of the cube maps that light the scene: cells of the sky are coarser.
_CUBE = 64
# Texels and faces of probes up to which a page stays small enough to be sent.
MOST_VALUES = 400_000
_BLACK = (0.0, 0.0, 0.0)
# Rays of a texel over those of the program's light map, whose noise shows as blotches on even walls
# and was most of the error of a page's lux. Four times the rays make an hour a quarter slower.
_MORE_RAYS = 4
# Ratio of a page's texels to those of the program's light map, whose stills add points in view.
# Light below a street's sills changes within a quarter of a metre; texels were half a metre wide.
# Broken clouds need a second set of coefficients: pages stay below 15 MB.
_MORE_TEXELS, _MORE_UNDER_CLOUDS = 3.0, 2.5


def traced(
    scene: SceneOpened, tolerance: float, texels: int | None, cloudy: bool = False
) -> tuple[SceneTransport, MirrorRays | None]:
    """A scene's transport, and the surroundings of its glossy parts.

    It has `_MORE_RAYS` times the rays of a tolerance, kept on disk, and without `texels`
    `_MORE_TEXELS` times its texels, under clouds `_MORE_UNDER_CLOUDS` times. The transport has no
    such surroundings: the page draws them each hour.

    Raises:
        UserError: the scene has no surfaces, or its light map is too large for a page.
    """
    if not scene.triangles:
        raise UserError("the scene has no surfaces: there is no light on them to share")
    quality = quality_for(tolerance)
    more = round((_MORE_UNDER_CLOUDS if cloudy else _MORE_TEXELS) * quality.texels)
    wanted = texels or max(quality.texels, min(more, MOST_VALUES // 2))
    sizes = TransportSizes(None, wanted, quality.patch_texels, quality.bounces_left)
    surfaces = surfaces_of(scene)
    found = SceneTransport.of_scene(scene, surfaces, sizes)
    values = len(MapValues.of(found).where)
    if values > MOST_VALUES:
        raise UserError(
            f"the light map has {values:,} texels, more than the {MOST_VALUES:,} that fit into a "
            f"page: reduce them, as by --texels {max(wanted // 2, 1000)}"
        )
    found.add_mirrors(mirror_parts(scene, surfaces))
    mirrors, found.mirrors = found.mirrors, None
    # Patches follow from the first round, and so do kept rays: the first two are the module's own.
    for rays in (first_rays(found.rows), quality.rays, _MORE_RAYS * quality.rays):
        found.add_cached_rays(rays - found.rays)
    return found, mirrors


@dataclass(frozen=True, eq=False)
class MapValues:
    """The values of a light map that a page keeps: its used texels, then its probes' faces.

    `size_px` is the width and height of the map, `where` (T,) the places of used texels in it, row
    by row, and `probes` the shape (nz, ny, nx, 6) of the probes, or None.
    """

    size_px: tuple[int, int]
    where: NDArray[np.int64]
    probes: tuple[int, ...] | None

    @classmethod
    def of(cls, transport: SceneTransport) -> "MapValues":
        """The values of a transport's map."""
        laid = transport.layout_message
        used = transport.texels.row_of.ravel() >= 0
        probes = None if laid.probes is None else (*laid.probes.counts[::-1], 6)
        width, height = laid.size_px
        return cls((width, height), np.flatnonzero(used), probes)

    def __len__(self) -> int:
        return len(self.where) + (0 if self.probes is None else int(np.prod(self.probes)))

    def taken(self, texels: Float32Array, probes: Float32Array | None) -> Float32Array:
        """Values (T, C) of a map (height, width, C) and of probes (nz, ny, nx, 6, C)."""
        found = texels.reshape(-1, texels.shape[-1])[self.where]
        if probes is None:
            return found
        return np.concatenate([found, probes.reshape(-1, probes.shape[-1])])


def illumination(
    table: SkyTable, true_rad: float, apparent_rad: float, azimuth_rad: float
) -> Illumination:
    """The light of the sun in a place, by the table of the sky."""
    cube = table.cube(_CUBE, true_rad, azimuth_rad)
    layer, share = table.place(true_rad)
    albedo = (1.0 - share) * table.albedo_rgb[layer] + share * table.albedo_rgb[layer + 1]
    return Illumination(
        sky=cube,
        ground_radiance_rgb=vector(table.mixed(table.ground, true_rad)),
        ground_albedo_rgb=vector(albedo),
        key_direction=direction_of(azimuth_rad, apparent_rad),
        key_irradiance_rgb=vector(table.mixed(table.key, true_rad)),
        open_sky=irradiance_coefficients(cube),
    )


def glow_illumination(glow: Float32Array | None, albedo_rgb: FloatArray) -> Illumination:
    """The light of a night's glow (rows, columns, 3); darkness for None."""
    ground = np.zeros(3)
    cube = np.zeros((6, _CUBE, _CUBE, 3), np.float32)
    if glow is not None:
        ground = albedo_rgb / np.pi * horizontal_irradiance(glow_cube(Array(glow), _CUBE, _BLACK))
        cube = glow_cube(Array(glow), _CUBE, vector(ground))
    return Illumination(
        sky=cube,
        ground_radiance_rgb=vector(ground),
        ground_albedo_rgb=vector(albedo_rgb),
        key_direction=(0.0, 1.0, 0.0),
        key_irradiance_rgb=_BLACK,
        open_sky=irradiance_coefficients(cube),
    )


class CloudyLight(NamedTuple):
    """The light of a sky behind clouds without sunlight, and of all sunlight of a clear sky."""

    by_sky: Illumination
    by_rays: Illumination


def behind_clouds(
    clear: Illumination,
    maps: CloudMaps,
    coefficients: FloatArray | Float32Array,
) -> CloudyLight:
    """The light of a clear hour behind clouds; `coefficients` (K, 3) of the clouds' own, in
    W m^-2 sr^-1 of a step."""
    size = clear.sky.shape[1]
    direction = texel_directions(size)
    above = direction[..., 1] > 0.0
    towards = np.asarray(clear.key_direction)
    key = np.asarray(clear.key_irradiance_rgb)
    cube = np.zeros(clear.sky.shape, np.float32)
    suns = [(towards, key)] if towards[1] > 0.0 else []
    cube[above] = maps.sky(direction[above], clear.sky[above].astype(float), coefficients, suns)
    white = np.asarray(clear.ground_albedo_rgb) / np.pi
    ground = white * horizontal_irradiance(cube)
    return CloudyLight(
        _lit(clear, cube, ground, _BLACK),
        _lit(clear, np.zeros_like(cube), white * key * max(towards[1], 0.0), vector(key)),
    )


def _lit(
    clear: Illumination, sky: Float32Array, ground_rgb: FloatArray, key_rgb: Vector
) -> Illumination:
    """The light of a sky whose lower half is overwritten by the ground's radiance."""
    sky[texel_directions(sky.shape[1])[..., 1] <= 0.0] = ground_rgb
    return Illumination(
        sky=sky,
        ground_radiance_rgb=vector(ground_rgb),
        ground_albedo_rgb=clear.ground_albedo_rgb,
        key_direction=clear.key_direction,
        key_irradiance_rgb=key_rgb,
        open_sky=irradiance_coefficients(sky),
    )


@dataclass(frozen=True, eq=False)
class LightMaps:
    """Light (T, 3) on the values of a map, W m^-2: without the key light's own.

    Attributes:
        by_sun: (S + R, T, 3), at the places, as shares of `level_rgb` (S, 3); behind clouds that of
            the sky alone, then at the first R places that of a clear sun's rays, which the page
            dims by what passes the clouds.
        by_glow: (T, 3), of a moonless night.
        by_lamps: (T, 3), of lamps and surfaces that glow, their direct light too.
        sky_share: (S, T) float16, share of the open sky's irradiance that arrives.
    """

    by_sun: Float32Array
    level_rgb: FloatArray
    by_glow: Float32Array
    by_lamps: Float32Array
    sky_share: NDArray[np.float16]


def light_maps(
    transport: SceneTransport,
    values: MapValues,
    table: SkyTable,
    places: SunPlaces,
    apparent_of: Callable[[float], float],
    night: Illumination,
    clouds: CloudMaps | None,
    tracked: Callable[[Iterable[int]], Iterable[int]],
) -> LightMaps:
    """The light maps of a scene, `night` being the light of a moonless one."""

    def light(hour: Illumination) -> Float32Array:
        found = transport.light(hour)
        return values.taken(found.texels, found.probes)

    albedo = table.albedo_rgb[-1]
    by_lamps = light(glow_illumination(None, albedo))[:, :3]
    by_glow = np.maximum(light(night)[:, :3] - by_lamps, 0.0)
    count = len(places.heights)
    # In dusk next to none of a sun's light is that of its rays.
    rays = places.first_of_dusk if clouds is not None and clouds.any_sun else 0
    by_sun, levels = np.empty((count + rays, len(values), 3), np.float32), np.empty((count, 3))
    share = np.empty((count, len(values)), np.float16)
    for number in tracked(range(count)):
        height = float(places.heights[number])
        hour = illumination(table, height, apparent_of(height), float(places.azimuths[number]))
        levels[number] = level = table.level(height)
        if clouds is not None:
            north_rad = float(places.azimuths[number]) + places.north_offset_rad
            own = clouds.coefficients(height, north_rad) * level
            hour, by_rays = behind_clouds(hour, clouds, own)
            if number < rays:
                found = light(by_rays)[:, :3]
                by_sun[count + number] = np.maximum(found - by_lamps, 0.0) / level
        found = light(hour)
        by_sun[number] = np.maximum(found[:, :3] - by_lamps, 0.0) / level
        share[number] = found[:, 3]
    lamps = by_lamps + _drawn_lamps(transport, values)
    return LightMaps(by_sun, levels, by_glow, lamps, share)


def _drawn_lamps(transport: SceneTransport, values: MapValues) -> Float32Array:
    """Direct light (T, 3) of the lamps that a frame draws with their shadow maps."""
    cache = transport.cache
    if cache.lamps is None:
        return np.zeros((len(values), 3), np.float32)
    rows = np.vstack([cache.lamps.drawn, np.zeros((1, 3), np.float32)])
    texels = len(transport.texels.pixel)
    shown = np.where(cache.shown < texels, cache.shown, len(rows) - 1)
    probes = None
    if values.probes is not None:
        count = int(np.prod(values.probes))
        probes = rows[texels : texels + count].reshape(*values.probes, 3)
    return values.taken(rows[shown], probes)
