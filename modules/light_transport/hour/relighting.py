"""The light of an hour on a scene whose rays are traced.

`TransportCache` holds what all hours have in common; an hour is a gather, bounces and a smoothing.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from light_transport.hour.borders import Borders, border_light, borders_of, takes_light_of
from light_transport.hour.gather import patches_gathered, sky_gathered
from light_transport.hour.illumination import HourLight, Illumination
from light_transport.hour.key_light import (
    KeyShadows,
    directions_around,
    key_rays_of,
    lit_shares,
    patch_means,
    shadow_rays,
)
from light_transport.hour.lamp_light import (
    LampLight,
    lamp_irradiance,
    lamps_in_radii,
    patch_lamp_light,
)
from light_transport.hour.mirror_light import (
    asked_for_key_light,
    cubes,
    seen_shares,
    texel_radiance,
)
from light_transport.hour.patch_transfer import (
    PatchTransfer,
    direct_sky,
    enclosure,
    patch_transfer_of,
    radiosity,
)
from light_transport.hour.sky_visibility import (
    open_luminance,
    scaled,
    sky_moments,
    to_shares,
    visible_sky,
)
from light_transport.hour.smoothing import (
    STEPS,
    Smoothing,
    mix_at_seams,
    parted_by_sky,
    smoothed_rows,
    smoothing_of,
)
from light_transport.kernels import hot
from light_transport.layout.probe_places import without_buried
from light_transport.rays.ray_scene import RayScene
from light_transport.rays.ray_starts import scratch
from light_transport.rays.sky_nodes import NODES, node_radiances
from light_transport.surfaces.surfaces import GROUND
from vrut_lite.array import Array
from vrut_lite.geometry.colour import luminance
from vrut_lite.messages.lamps import SceneLamps
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray

# Orientations that the open sky hardly lights are lit by surfaces around: this share of the
# brightest orientation's light is the least by which light changes as a surface bends.
LEAST_OF_SKY = 0.05


@dataclass(frozen=True, eq=False)
class TransportCache:
    """Values derived from the present table of rays, the same for all hours."""

    good: BoolArray
    patch_transfer: PatchTransfer
    smoothing: Smoothing
    borders: Borders
    source: NDArray[np.int32]
    """The texel whose light each texel (N,) shows, or NOBODY."""
    shown: NDArray[np.int32]
    """The same for each texel of the map (height, width); the number of texels for none."""
    key_shadows: KeyShadows
    lamps: LampLight | None
    lamps_on_patches: Float32Array | None
    visible_sky: Array
    """See `HourLight`."""

    @property
    def memory_bytes(self) -> int:
        """Memory of all arrays."""
        parts: list[NDArray | None] = [
            *self.patch_transfer,
            *self.smoothing,
            *self.borders,
            self.good,
        ]
        parts += [self.source, self.shown]
        parts += [self.visible_sky.values, self.lamps_on_patches]
        parts += [] if self.lamps is None else [*self.lamps]
        held = sum(part.nbytes for part in parts if part is not None)
        return held + self.key_shadows.memory_bytes


def cache_of(scene: RayScene) -> TransportCache:
    """The cache of a scene some of whose rays are traced."""
    assert scene.patches is not None
    good = scene.good
    texels = len(scene.texels.pixel)
    nearness = scene.table.nearness[:texels]
    valid = scene.table.valid[:texels]
    room = (valid / np.maximum(nearness, np.float32(1e-9))).astype(np.float32)
    source = takes_light_of(scene.beside, good, valid.astype(np.float32))
    shown = np.append(source, -1)[scene.texels.row_of]
    exchange = patch_transfer_of(scene.table, scene.patches)
    lamps = None if scene.lamps is None else lamp_light(scene, scene.lamps)
    mirrored = _mirrored_texels(scene, texels)
    moments = _sky_moments(scene)
    by_room = smoothing_of(scene.texels, scene.links, scene.seams, good[:texels], room)
    smoothing = parted_by_sky(by_room, smoothed(scene, moments.copy(), by_room)[:, 3])
    sky = visible_sky(smoothed(scene, moments, smoothing), scene.texels.normal)
    shown = np.where(shown < 0, texels, shown).astype(np.int32)
    return TransportCache(
        good,
        exchange,
        smoothing,
        borders_of(scene.texels, scene.beside, source, good[:texels], room),
        source,
        shown,
        KeyShadows(key_rays_of(scene.patches, scene.table.free, enclosure(exchange), mirrored)),
        lamps,
        None if lamps is None else patch_lamp_light(scene.patches, scene.table.free, lamps),
        Array(as_map(sky, shown).astype(np.float16)),
    )


def lamp_light(scene: RayScene, lamps: SceneLamps) -> LampLight:
    """Direct irradiance of all rows by lamps, which need not be the scene's own."""
    light = LampLight(*np.empty((2, scene.rows, 3), np.float32))
    arrays = lamps_in_radii(lamps, scene.surfaces)
    scene.over_rows(
        scene.rows,
        lambda a, b: lamp_irradiance(
            scene.tree, scene.receivers, scene.table.free, arrays, scratch(), a, b, *light
        ),
    )
    return light


def _sky_moments(scene: RayScene) -> Float32Array:
    """Means (N, 4) of `sky_moments` over the rays of each texel."""
    assert scene.patches is not None
    texels = len(scene.texels.pixel)
    towards = sky_moments(NODES + len(scene.patches.area) + 1)
    moments = np.empty((texels, 4), np.float32)
    scene.over_rows(texels, lambda a, b: sky_gathered(scene.table, towards, a, b, moments))
    return moments


def _mirrored_texels(scene: RayScene, texels: int) -> NDArray[np.integer]:
    """The texels in mirrors that need a shadow ray."""
    if scene.mirrors is None:
        return np.empty(0, np.int32)
    seen = scene.mirrors.row[: np.searchsorted(scene.mirrors.row, texels)]
    return asked_for_key_light(seen, scene.texels, scene.links)


def smoothed(scene: RayScene, light: Float32Array, smoothing: Smoothing) -> Float32Array:
    """Smooth values of texels (N, 4), which are overwritten; near edges they bend as these do."""
    smooth = _after_steps(scene, light.copy(), smoothing)
    np.subtract(light, smooth, out=light)
    light = _after_steps(scene, light, smoothing)
    light *= smoothing.back
    light += smooth
    return light


def _after_steps(scene: RayScene, light: Float32Array, smoothing: Smoothing) -> Float32Array:
    """Values of texels (N, 4) after all steps; `light` is overwritten."""
    other = np.empty_like(light)
    for _ in range(STEPS):
        scene.over_rows(len(light), partial(smoothed_rows, light, other, smoothing))
        mix_at_seams(light, other, smoothing)
        light, other = other, light
    return light


def meet_rays(scene: RayScene, light: Float32Array, borders: Borders) -> None:
    """Overwrite light of texels (N, 4), means of their rays, by what border texels show."""
    shown = np.empty((len(borders.row), 4), np.float32)
    scene.over_rows(len(shown), lambda a, b: border_light(light, borders, a, b, shown))
    light[borders.row] = shown


def as_map(rows: Float32Array, shown: NDArray[np.int32]) -> Float32Array:
    """Rows (N, 4) where each texel of the map (height, width, 4) finds them."""
    found = np.empty((*shown.shape, 4), np.float32)
    _fill_map(rows, shown, found)
    return found


@hot
def _fill_map(rows, shown, found):  # type: ignore[no-untyped-def]
    for y in range(shown.shape[0]):
        for x in range(shown.shape[1]):
            row = shown[y, x]
            for k in range(4):
                found[y, x, k] = rows[row, k] if row < len(rows) else np.float32(0.0)


def hour_light(scene: RayScene, cache: TransportCache, hour: Illumination) -> HourLight:
    """The light of an hour; some rays must have been added."""
    assert scene.patches is not None
    shares = key_shares(scene, cache, hour)
    column_light, light = _bounced(scene, cache, hour, shares)
    light = light[: len(scene.orientation)]
    scene.over_rows(
        len(light), lambda a, b: patches_gathered(scene.table, column_light, a, b, light)
    )
    texels = len(scene.texels.pixel)
    open_sky = open_luminance(hour.open_sky)
    # Where a surface bends, light changes as the open sky's does: their ratio is smooth.
    bends = np.maximum(open_sky, LEAST_OF_SKY * open_sky.max())
    scaled(light[:texels], 1.0 / bends, scene.orientation)
    smoothed(scene, light[:texels], cache.smoothing)
    np.maximum(light, 0.0, out=light)
    meet_rays(scene, light[:texels], cache.borders)
    scaled(light[:texels], bends, scene.orientation)
    if cache.lamps is not None:
        # It has no noise that is to be smoothed, and edges that are not.
        light[:, :3] += cache.lamps.baked[: len(light)]
    to_shares(light, open_sky, scene.orientation)
    return HourLight(
        as_map(light[:texels], cache.shown),
        _as_probes(scene, cache, light[texels:]),
        cache.visible_sky,
        _as_cubes(scene, cache, hour, light[:texels], column_light, shares),
        column_light,
    )


def column_light_of(scene: RayScene, cache: TransportCache, hour: Illumination) -> Float32Array:
    """`HourLight.column_light` alone."""
    return _bounced(scene, cache, hour, key_shares(scene, cache, hour))[0]


def row_light(scene: RayScene, column_light: Float32Array) -> Float32Array:
    """Irradiance and luminance of the sky's part (N, 4) of all rows, means over their rays."""
    light = np.empty((scene.rows, 4), np.float32)

    def gather(first: int, last: int) -> None:
        sky_gathered(scene.table, column_light, first, last, light)
        patches_gathered(scene.table, column_light, first, last, light)

    scene.over_rows(scene.rows, gather)
    return light


def key_shares(scene: RayScene, cache: TransportCache, hour: Illumination) -> Float32Array:
    """Visible share of the key light times its cosine (N,), of the rows that are asked."""
    share = np.zeros(scene.rows, np.float32)
    if not np.any(np.asarray(hour.key_irradiance_rgb) > 0.0):
        return share
    shadows, towards = cache.key_shadows, np.asarray(hour.key_direction, np.float64)
    ray = shadows.rays.ray

    def cast(directions: FloatArray) -> NDArray[np.uint8]:
        reached = np.empty((len(directions), scene.rows), np.uint8)
        scene.over_rows(
            scene.rows,
            lambda a, b: shadow_rays(
                scene.tree, scene.receivers, ray, directions, scratch(), a, b, reached
            ),
        )
        return reached

    numbers, weights = directions_around(hour.key_direction)
    around = tuple(shadows.towards(numbers, cast))
    scene.over_rows(
        scene.rows,
        lambda a, b: lit_shares(scene.receivers, towards, around, weights, scratch(), a, b, share),
    )
    return share


def sunlit_patches(scene: RayScene, cache: TransportCache, direction: FloatArray) -> Float32Array:
    """Direct irradiance (M,) of patches by a key light of 1 W m^-2 from a unit vector (3,)."""
    assert scene.patches is not None
    shadows = cache.key_shadows.rays
    reached = np.empty((1, scene.rows), np.uint8)
    share = np.zeros(scene.rows, np.float32)
    towards = np.asarray(direction, float)
    shadow_rays(
        scene.tree, scene.receivers, shadows.ray, towards[None], scratch(), 0, scene.rows, reached
    )
    around, weights = (reached[0],) * 3, np.array([1.0, 0.0, 0.0])
    lit_shares(scene.receivers, towards, around, weights, scratch(), 0, scene.rows, share)
    return patch_means(scene.patches, shadows, share)


def _bounced(
    scene: RayScene, cache: TransportCache, hour: Illumination, shares: Float32Array
) -> tuple[Float32Array, Float32Array]:
    """`HourLight.column_light`, and the sky's light (N, 4) on rows, by `key_shares` (N,)."""
    assert scene.patches is not None
    patches = scene.patches
    column_light = np.zeros((NODES + len(patches.area) + 1, 4), np.float32)
    column_light[:NODES] = node_light(hour)
    light = np.empty((scene.rows, 4), np.float32)
    scene.over_rows(scene.rows, lambda a, b: sky_gathered(scene.table, column_light, a, b, light))
    direct = np.empty((len(patches.area), 3), np.float32)
    direct_sky(patches, scene.table.valid, light, direct)
    means = patch_means(patches, cache.key_shadows.rays, shares)
    direct += means[:, None] * np.asarray(hour.key_irradiance_rgb, np.float32)
    if cache.lamps_on_patches is not None:
        direct += cache.lamps_on_patches
    reflectance = patches.reflectance_rgb.copy()
    reflectance[patches.on_ground] = hour.ground_albedo_rgb
    column_light[NODES:-1, :3] = radiosity(
        cache.patch_transfer, direct, patches.emitted_rgb, reflectance, scene.bounces_left
    )
    return column_light, light


def node_light(hour: Illumination) -> Float32Array:
    """`HourLight.column_light` of the sky's nodes (NODES, 4)."""
    radiances = np.pi * node_radiances(hour.sky, hour.ground_radiance_rgb)
    return np.column_stack([radiances, luminance(radiances)]).astype(np.float32)


def texels_seen(scene: RayScene) -> int:
    """How many of the rows that mirrors see are texels: the first ones."""
    assert scene.mirrors is not None
    return int(np.searchsorted(scene.mirrors.row, len(scene.texels.pixel)))


def shares_of_seen(scene: RayScene, cache: TransportCache, shares: Float32Array) -> Float32Array:
    """The key light's share of the texels that mirrors see, by `key_shares` (N,)."""
    assert scene.mirrors is not None
    seen = scene.mirrors.row[: texels_seen(scene)]
    found = np.empty(len(seen), np.float32)
    seen_shares(seen, shares, cache.key_shadows.rays.ray, scene.links, found)
    return found


def buried_probes(scene: RayScene, cache: TransportCache) -> BoolArray:
    """Which probes (nz, ny, nx) lie inside bodies."""
    assert scene.probes is not None
    nx, ny, nz = scene.probes.counts
    first = len(scene.texels.pixel)
    good = cache.good[first : first + 6 * nx * ny * nz].reshape(nz, ny, nx, 6)
    return np.asarray(~good.all(axis=-1))


def _as_probes(scene: RayScene, cache: TransportCache, light: Float32Array) -> Float32Array | None:
    if scene.probes is None:
        return None
    nx, ny, nz = scene.probes.counts
    return without_buried(light.reshape(nz, ny, nx, 6, 4), buried_probes(scene, cache))


def _as_cubes(
    scene: RayScene,
    cache: TransportCache,
    hour: Illumination,
    light: Float32Array,
    column_light: Float32Array,
    shares: Float32Array,
) -> Float32Array | None:
    """Cubes (C, 6, e, e, 4) of glossy parts, by the light (N, 4) of texels."""
    if scene.mirrors is None:
        return None
    assert scene.patches is not None
    seen = scene.mirrors.row
    texels = texels_seen(scene)
    radiance = np.empty((len(seen), 3), np.float32)
    texel_radiance(
        seen[:texels],
        scene.surfaces.part,
        (scene.surfaces.reflectance_rgb, scene.surfaces.emitted_rgb),
        scene.colour_of,
        (light, cache.source),
        shares_of_seen(scene, cache, shares),
        np.array([hour.ground_albedo_rgb, hour.key_irradiance_rgb], np.float32),
        radiance,
    )
    if cache.lamps is not None:
        triangle = scene.colour_of[seen[:texels]]
        radiance[:texels] += (
            reflectance_of(scene, hour)[triangle] * cache.lamps.drawn[seen[:texels]] / np.pi
        )
    column = scene.patches.column_of[NODES + seen[texels:]]
    radiance[texels:] = column_light[column, :3] / np.float32(np.pi)
    return cubes(scene.mirrors, radiance)


def reflectance_of(scene: RayScene, hour: Illumination) -> Float32Array:
    """Reflectance (F, 3) of the triangles of `surfaces`, the ground's in this hour included."""
    reflectance = scene.surfaces.reflectance_rgb.copy()
    reflectance[scene.surfaces.part == GROUND] = hour.ground_albedo_rgb
    return reflectance
