"""The background jobs: a layout, rays, an hour, a view. Plain functions of their arguments."""

import itertools
from collections.abc import Callable
from functools import lru_cache
from threading import Lock
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from light_transport.giving_up import CancelCheck, always, unless
from light_transport.hour.illumination import Illumination
from light_transport.messages import NAME
from light_transport.rays.mirror_rays import mirror_parts
from light_transport.rays.ray_scene import BLOCK_ROWS, tree_of
from light_transport.rays.tree import Tree
from light_transport.surfaces.surfaces import Surfaces, surfaces_of
from light_transport.tolerance import TransportSizes
from light_transport.transport import SceneTransport, all_threads, first_rays
from light_transport.transport_files import (
    RoundCounts,
    TransportKey,
    cache_layout,
    cache_round,
    cached_layout,
    cached_light,
    cached_round,
    scene_key,
)
from vrut_lite.array import Array
from vrut_lite.array_cache import Arrays
from vrut_lite.errors import GivenUp
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.kernel.job import JobControl
from vrut_lite.messages.late_array import LateArray
from vrut_lite.messages.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import AmbientChanged, SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.messages.view_light import StillAsked, ViewLightChanged
from vrut_lite.sky.ground_albedo import ground_albedo

T = TypeVar("T")
# Rays of each side of a probe.
_PROBE_RAYS = 32


class Unwritten(Generic[T]):
    """A value that journals record by name only; a replay computes it again.

    It is made at its first use. The transport of a whole layout has a `key`.
    """

    def __init__(self, make: Callable[[], T], key: TransportKey | None = None):
        self.key = key
        self._make = make
        self._made: T | None = None
        self._lock = Lock()

    @property
    def value(self) -> T:
        """The value, the same one at each use."""
        with self._lock:
            if self._made is None:
                self._made = self._make()
            return self._made

    @property
    def is_made(self) -> bool:
        """Whether it is there already."""
        return self._made is not None


class TransportRound(NamedTuple):
    """A transport after a round: rays of each texel, texels, memory of the table."""

    rays: int
    texels: int
    table_bytes: int
    transport: Unwritten[SceneTransport]


class Laid(NamedTuple):
    """A layout and its first round of rays."""

    message: LightMapLaid
    round: TransportRound


class PreparedSurfaces(NamedTuple):
    """A scene's triangles and the tree over them."""

    surfaces: Surfaces
    tree: Tree


class LaidProbes(NamedTuple):
    """A layout of probes with all its rays, and surfaces for another layout of the scene.

    `round` is None where all probes lie inside bodies.
    """

    message: LightMapLaid
    round: TransportRound | None
    prepared: Unwritten[PreparedSurfaces]


def laid_probes(scene: SceneOpened, control: JobControl) -> LaidProbes | None:
    """A first light for a scene that takes long to lay out; None if nobody waits for it."""
    go_on = unless(control.cancelled)
    try:
        prepared = _prepared(scene, go_on)
        found = SceneTransport.of_probes(scene, *prepared)
        found.lamps = scene.lamps
        go_on()
    except GivenUp:
        return None
    found.add_rays(_PROBE_RAYS)
    found.threads = 1
    probes = slice(len(found.texels.pixel), len(found.orientation))
    done = _round(found, None) if found.good[probes].any() else None
    return LaidProbes(found.layout_message, done, Unwritten(lambda: prepared))


def laid_out(
    scene: SceneOpened,
    sizes: TransportSizes,
    rays: int,
    prepared: Unwritten[PreparedSurfaces] | None,
    of_still: bool,
    control: JobControl,
) -> Laid | None:
    """Lay out a scene and trace the first of so many rays; None if nobody waits for it any more.

    One job: between two the host may draw a first picture for seconds. For a still, whose light may
    be kept on disk, a layout of another session is laid out again at its first use.
    """
    key = scene_key(scene, sizes)

    def made(go_on: CancelCheck = always) -> SceneTransport:
        given = None if prepared is None else prepared.value
        laid = _laid_out(scene, sizes, given, go_on)
        return laid.refined(min(first_rays(laid.rows), rays), go_on)

    kept = cached_layout(key) if of_still else None
    if kept is not None:
        message, rows = kept
        count = min(first_rays(rows), rays)
        done = _cached_round(TransportKey(key, count, count), made)
        if done is not None:
            return Laid(message, done)
    try:
        found = made(unless(control.cancelled))
    except GivenUp:
        return None
    message = found.layout_message
    if of_still:
        cache_layout(key, message, found.rows)
    return Laid(message, _round(found, TransportKey(key, found.rays, found.rays), of_still))


def _laid_out(
    scene: SceneOpened,
    sizes: TransportSizes,
    prepared: PreparedSurfaces | None,
    go_on: CancelCheck,
) -> SceneTransport:
    """The transport of a scene without rays but those of its cube maps."""
    surfaces, tree = prepared or _prepared(scene, go_on)
    found = SceneTransport.of_scene(scene, surfaces, sizes, tree, go_on)
    found.lamps = scene.lamps
    found.add_mirrors(mirror_parts(scene, surfaces), go_on)
    return found


def _prepared(scene: SceneOpened, go_on: CancelCheck) -> PreparedSurfaces:
    surfaces = surfaces_of(scene)
    go_on()
    tree = tree_of(surfaces)
    go_on()
    return PreparedSurfaces(surfaces, tree)


def with_rays(
    transport: Unwritten[SceneTransport],
    count: int,
    wanted: int,
    of_still: bool,
    control: JobControl,
) -> TransportRound | None:
    """A round of more rays of each texel, of those `wanted` at last; None if it was cancelled."""
    assert transport.key is not None
    rays = transport.key.rays
    key = transport.key._replace(rays=rays + count)
    if of_still and not transport.is_made:
        done = _cached_round(key, lambda: transport.value.refined(count))
        if done is not None:
            return done
    own, blocks = transport.value, itertools.count()

    go_on = unless(control.cancelled)

    def next_block() -> None:
        traced = rays + min(next(blocks) * BLOCK_ROWS / own.rows, 1.0) * count
        control.progress(traced / wanted, f"{traced:.0f} of {wanted} rays")
        go_on()

    try:
        return _round(own.refined(count, next_block), key, of_still)
    except GivenUp:
        return None


def _round(
    transport: SceneTransport, key: TransportKey | None, keeps: bool = False
) -> TransportRound:
    counts = RoundCounts(len(transport.texels.pixel), transport.memory_bytes)
    if keeps and key is not None:
        cache_round(key, counts)
    return TransportRound(transport.rays, *counts, Unwritten(lambda: transport, key))


def _cached_round(key: TransportKey, make: Callable[[], SceneTransport]) -> TransportRound | None:
    """A round of another session, whose transport is made at its first use."""
    counts = cached_round(key)
    return None if counts is None else TransportRound(key.rays, *counts, Unwritten(make, key))


def lit(
    transport: Unwritten[SceneTransport],
    layout_key: str,
    sky_light: SkyLightChanged,
    of_still: bool = False,
) -> SurfaceLightChanged:
    """The light of an hour by the present rays; that of a still is kept on disk."""
    hour = hour_of(sky_light)

    def made() -> Arrays:
        own = transport.value
        if of_still:
            own.threads = all_threads()
        return own.map_arrays(hour)

    key = transport.key if of_still else None
    found = made() if key is None else cached_light(key, hour, (), made)
    encoded = {name: Array(array) for name, array in found.items()}
    return SurfaceLightChanged(
        layout_key=layout_key,
        texels=encoded["texels"],
        probes=encoded.get("probes"),
        radiance_scale=float(found["scale"][0]),
        rays=int(found["rays"][0]),
        source=NAME,
        mirrors=encoded.get("mirrors"),
        visible_sky=encoded["visible_sky"],
        sky_level=sky_light.ambient.level,
    )


def lit_by_card(
    transport: Unwritten[SceneTransport], layout_key: str, sky_light: SkyLightChanged
) -> SurfaceLightChanged:
    """The light of an hour that a card computes, and the processor where its numbers are read."""
    own, hour = transport.value, hour_of(sky_light)
    recipe = own.card_hour(hour)
    tables = recipe.tables
    computed = Unwritten(lambda: own.light(hour))

    def late(shape: tuple[int, ...], name: str) -> LateArray:
        return LateArray(shape, recipe.inputs).by(lambda: getattr(computed.value, name), recipe)

    nx, ny, nz = tables.probe_counts
    target = tables.target
    return SurfaceLightChanged(
        layout_key=layout_key,
        texels=late((*tables.shown.shape, 4), "texels"),
        probes=None if tables.probes is None else late((nz, ny, nx, 6, 4), "probes"),
        radiance_scale=1.0,
        rays=own.rays,
        source=NAME,
        mirrors=None if target is None else late((*target.shape[:-1], 4), "mirrors"),
        visible_sky=own.cache.visible_sky,
        sky_level=sky_light.ambient.level,
    )


def view_lit(
    transport: Unwritten[SceneTransport],
    layout_key: str,
    sky_light: SkyLightChanged,
    asked: StillAsked,
    points: int,
    rays: int,
    control: JobControl,
) -> ViewLightChanged | None:
    """The light of an hour on the surfaces in a picture, at about so many points of it, by at most
    so many rays each.

    None if nobody waits for it any more.
    """
    assert transport.key is not None
    edge_px = _edge_for(asked.size_px, points)
    hour, camera, of_picture = hour_of(sky_light), asked.camera, (asked.size_px, edge_px, rays)

    def made() -> Arrays:
        return transport.value.view_arrays(hour, camera, *of_picture, unless(control.cancelled))

    view = (camera.eye_m, camera.target_m, camera.vertical_field_of_view_rad, *of_picture)
    try:
        found = cached_light(transport.key, hour, view, made)
    except GivenUp:
        return None
    return ViewLightChanged(
        layout_key=layout_key,
        camera=camera,
        size_px=asked.size_px,
        edge_px=edge_px,
        light=Array(found["light"]),
        plane=Array(found["plane"]),
        mirrored=Array(found["mirrored"]),
        radiance_scale=float(found["scale"][0]),
        rays=rays,
        source=NAME,
    )


def _edge_for(size_px: tuple[int, int], points: int) -> int:
    """Edge of squares such that a picture has about so many."""
    return max(1, int(np.ceil(np.sqrt(size_px[0] * size_px[1] / points))))


def hour_of(light: SkyLightChanged) -> Illumination:
    """An hour in plain arrays, the same ones for repeated calls with equal light.

    Args:
        light: with `radiance`.
    """
    assert light.radiance is not None
    return _hour_of(light.radiance, light.key_light, light.ambient)


@lru_cache(maxsize=1)
def _hour_of(
    sky: SkyRadianceChanged, key_light: KeyLightChanged, ambient: AmbientChanged
) -> Illumination:
    return Illumination(
        sky=decode_float16(sky.cube.values, sky.radiance_scale),
        ground_radiance_rgb=sky.ground_radiance_rgb,
        ground_albedo_rgb=ground_albedo(sky, key_light, ambient),
        key_direction=key_light.direction,
        key_irradiance_rgb=key_light.irradiance_rgb,
        open_sky=np.asarray(ambient.irradiance_sh_rgb.values, np.float64),
    )
