"""The light of an hour on a scene whose rays are traced."""

import numpy as np
from numpy.typing import NDArray

from light_transport.hour.gather import patches_gathered, sky_gathered
from light_transport.hour.illumination import HourLight, Illumination
from light_transport.hour.key_lattice import directions_around
from light_transport.hour.key_light import free_rays, lit_shares, patch_means
from light_transport.hour.mirror_light import cubes, texel_radiance
from light_transport.hour.patch_transfer import direct_sky, radiosity
from light_transport.hour.sky_visibility import open_luminance, scaled, to_shares
from light_transport.layout.probe_places import without_buried
from light_transport.ray_scene import RayScene
from light_transport.rays.ray_starts import scratch
from light_transport.rays.sky_nodes import NODES, node_radiances
from light_transport.surfaces.surfaces import GROUND
from light_transport.transport_cache import Finished, as_map, meet_rays, smoothed
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import Float32Array, FloatArray

# Orientations that the open sky hardly lights are lit by what stands around: so much is enough of
# the brightest orientation's light to tell how light changes as a surface bends.
_LEAST_OF_SKY = 0.05


def hour_light(scene: RayScene, finished: Finished, hour: Illumination) -> HourLight:
    """The light of an hour; some rays must have been added."""
    assert scene.patches is not None
    shares = key_shares(scene, finished, hour)
    column_light = _node_light(scene, hour)
    light = np.empty((scene.rows, 4), np.float32)
    scene.over_rows(scene.rows, lambda a, b: sky_gathered(scene.table, column_light, a, b, light))
    _bounce(scene, finished, hour, shares, light, column_light)
    light = light[: len(scene.orientation)]
    scene.over_rows(
        len(light), lambda a, b: patches_gathered(scene.table, column_light, a, b, light)
    )
    texels = len(scene.texels.pixel)
    open_sky = open_luminance(hour.open_sky)
    # Where a surface bends, light changes as the open sky's does: what is left is smooth.
    bends = np.maximum(open_sky, _LEAST_OF_SKY * open_sky.max())
    scaled(light[:texels], 1.0 / bends, scene.orientation)
    smoothed(scene, light[:texels], finished.smoothing)
    np.maximum(light, 0.0, out=light)
    meet_rays(scene, light[:texels], finished.borders)
    scaled(light[:texels], bends, scene.orientation)
    if finished.lamps is not None:
        # It has no noise that is to be smoothed, and edges that are not.
        light[:, :3] += finished.lamps.baked[: len(light)]
    to_shares(light, open_sky, scene.orientation)
    return HourLight(
        as_map(light[:texels], finished.shown),
        _as_probes(scene, finished, light[texels:]),
        finished.visible_sky,
        _as_cubes(scene, finished, hour, light[:texels], column_light, shares),
    )


def column_light_of(scene: RayScene, finished: Finished, hour: Illumination) -> Float32Array:
    """What a ray brings from each column (C, 4): pi L and, of the sky alone, its luminance."""
    found = _node_light(scene, hour)
    light = np.empty((scene.rows, 4), np.float32)
    scene.over_rows(scene.rows, lambda a, b: sky_gathered(scene.table, found, a, b, light))
    _bounce(scene, finished, hour, key_shares(scene, finished, hour), light, found)
    return found


def key_shares(scene: RayScene, finished: Finished, hour: Illumination) -> Float32Array:
    """Visible share of the key light times its cosine (N,), of the rows that are asked."""
    share = np.zeros(scene.rows, np.float32)
    if not np.any(np.asarray(hour.key_irradiance_rgb) > 0.0):
        return share
    shadows, towards = finished.key_shadows, np.asarray(hour.key_direction, np.float64)
    ray = shadows.rays.ray

    def cast(directions: FloatArray) -> NDArray[np.uint8]:
        reached = np.empty((len(directions), scene.rows), np.uint8)
        scene.over_rows(
            scene.rows,
            lambda a, b: free_rays(
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


def _node_light(scene: RayScene, hour: Illumination) -> Float32Array:
    """What a ray brings from each column (C, 4): pi L of nodes and its luminance.

    It is 0 of patches, for `_bounce` to fill in; the fourth channel is of the sky alone.
    """
    assert scene.patches is not None
    column_light = np.zeros((NODES + len(scene.patches.area) + 1, 4), np.float32)
    radiances = np.pi * node_radiances(hour.sky, hour.ground_radiance_rgb)
    column_light[:NODES, :3], column_light[:NODES, 3] = radiances, luminance(radiances)
    return column_light


def _bounce(
    scene: RayScene,
    finished: Finished,
    hour: Illumination,
    shares: Float32Array,
    sky_light: Float32Array,
    column_light: Float32Array,
) -> None:
    """Fill in what patches send, by the sky's light (N, 4) on rows and all bounces."""
    assert scene.patches is not None
    patches = scene.patches
    direct = np.empty((len(patches.area), 3), np.float32)
    direct_sky(patches, scene.table.valid, sky_light, direct)
    means = patch_means(patches, finished.key_shadows.rays, shares)
    direct += means[:, None] * np.asarray(hour.key_irradiance_rgb, np.float32)
    if finished.lamps_on_patches is not None:
        direct += finished.lamps_on_patches
    reflectance = patches.reflectance_rgb.copy()
    reflectance[patches.on_ground] = hour.ground_albedo_rgb
    column_light[NODES:-1, :3] = radiosity(
        finished.exchange, direct, patches.emitted_rgb, reflectance, scene.bounces_left
    )


def _as_probes(scene: RayScene, finished: Finished, light: Float32Array) -> Float32Array | None:
    if scene.probes is None:
        return None
    nx, ny, nz = scene.probes.counts
    buried = ~finished.good[len(scene.texels.pixel) :][: len(light)].reshape(nz, ny, nx, 6)
    return without_buried(light.reshape(nz, ny, nx, 6, 4), np.asarray(buried.any(axis=-1)))


def _as_cubes(
    scene: RayScene,
    finished: Finished,
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
    texels = int(np.searchsorted(seen, len(scene.texels.pixel)))
    radiance = np.empty((len(seen), 3), np.float32)
    texel_radiance(
        seen[:texels],
        scene.surfaces.part,
        (scene.surfaces.reflectance_rgb, scene.surfaces.emitted_rgb),
        scene.colour_of,
        (light, finished.source),
        (shares, finished.key_shadows.rays.ray, scene.links),
        np.array([hour.ground_albedo_rgb, hour.key_irradiance_rgb], np.float32),
        radiance,
    )
    if finished.lamps is not None:
        triangle = scene.colour_of[seen[:texels]]
        radiance[:texels] += (
            reflectance_of(scene, hour)[triangle] * finished.lamps.drawn[seen[:texels]] / np.pi
        )
    column = scene.patches.column_of[NODES + seen[texels:]]
    radiance[texels:] = column_light[column, :3] / np.float32(np.pi)
    return cubes(scene.mirrors, radiance)


def reflectance_of(scene: RayScene, hour: Illumination) -> Float32Array:
    """Of the triangles of `surfaces` (F, 3), the ground's in this hour included."""
    reflectance = scene.surfaces.reflectance_rgb.copy()
    reflectance[scene.surfaces.part == GROUND] = hour.ground_albedo_rgb
    return reflectance
