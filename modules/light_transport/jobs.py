"""The background jobs: a layout, rays, an hour, a view. Plain functions of their arguments.

numba is imported where work begins, so that programs without a light map do not wait for it.
"""

import itertools
import os
from copy import copy
from functools import lru_cache
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

import msgspec
import numpy as np

from light_transport.giving_up import GivenUp, GoOn, unless
from light_transport.messages import NAME
from light_transport.unseen_hours import HourMessages
from vrut_lite.array import Array
from vrut_lite.array_cache import Arrays
from vrut_lite.daylight.light_map import LightMapLaid, Mirrors, SurfaceLightChanged
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.daylight.scene_state import ground_albedo
from vrut_lite.daylight.view_light import StillAsked, ViewLightChanged
from vrut_lite.geometry.encoding import decode_float16, float16_scale
from vrut_lite.kernel.job import JobControl

if TYPE_CHECKING:
    from light_transport.bake import Bake
    from light_transport.hour.hour import Hour
    from light_transport.rays.tree import Tree
    from light_transport.surfaces.surfaces import Surfaces

T = TypeVar("T")
_MOST_THREADS = 4
# Of a texel, and of all together.
_FIRST_RAYS, _RAYS_AT_FIRST = 64, 1_250_000
_FEWEST_FIRST = 16
# Of each side of a probe.
_PROBE_RAYS = 32


class Unwritten(Generic[T]):
    """A value that journals record by name only; a replay computes it again."""

    def __init__(self, value: T):
        self.value = value


class Plan(NamedTuple):
    """Sizes of a light map.

    Texels have the edge `texel_m`, or, where it is None, are about so many; patches are
    `patch_texels` of them wide.
    """

    texel_m: float | None
    texels: int
    patch_texels: float
    bounces_left: float


class Round(NamedTuple):
    """A bake after a round: rays of each texel, texels, memory of the table."""

    rays: int
    texels: int
    table_bytes: int
    bake: "Unwritten[Bake]"


class Laid(NamedTuple):
    """A layout and its first round of rays."""

    message: LightMapLaid
    round: Round


class LaidProbes(NamedTuple):
    """A layout of probes with all its rays, and what another layout of the scene can go on with.

    There is no round where all probes lie inside bodies.
    """

    message: LightMapLaid
    round: Round | None
    prepared: "Unwritten[Prepared]"


class Prepared(NamedTuple):
    """A scene's triangles and the tree over them."""

    surfaces: "Surfaces"
    tree: "Tree"


def laid_probes(scene: SceneOpened, control: JobControl) -> LaidProbes | None:
    """A first light for a scene that takes long to lay out; None if nobody waits for it."""
    try:
        return _laid_probes(scene, unless(control.cancelled))
    except GivenUp:
        return None


def _laid_probes(scene: SceneOpened, go_on: GoOn) -> LaidProbes:
    from light_transport.bake import Bake
    from light_transport.layout.layout import lay_out_probes
    from light_transport.ray_scene import tree_of
    from light_transport.surfaces.surfaces import surfaces_of

    surfaces = surfaces_of(scene)
    go_on()
    prepared = Prepared(surfaces, tree_of(surfaces))
    go_on()
    layout = lay_out_probes(scene, surfaces)
    bake = Bake(surfaces, layout, _all_threads(), tree=prepared.tree)
    bake.lamps = scene.lamps
    go_on()
    bake.add_rays(_PROBE_RAYS)
    bake.threads = 1
    probes = slice(len(bake.texels.pixel), len(bake.orientation))
    done = _round(bake) if bake.good[probes].any() else None
    return LaidProbes(layout.message, done, Unwritten(prepared))


def laid_out(
    scene: SceneOpened,
    plan: Plan,
    rays: int,
    prepared: "Unwritten[Prepared] | None",
    control: JobControl,
) -> Laid | None:
    """Lay out a scene and trace the first of so many rays; None if nobody waits for it any more.

    One job: between two the host may draw a first picture for seconds.
    """
    from light_transport.kept_rays import add_kept_rays

    try:
        message, bake = _laid_out(
            scene, plan, None if prepared is None else prepared.value, unless(control.cancelled)
        )
    except GivenUp:
        return None
    if not add_kept_rays(bake, min(first_rays(bake.rows), rays), control.cancelled):
        return None
    bake.threads = 1
    return Laid(message, _round(bake))


def _laid_out(
    scene: SceneOpened, plan: Plan, prepared: Prepared | None, go_on: GoOn
) -> "tuple[LightMapLaid, Bake]":
    from light_transport.bake import Bake
    from light_transport.kept_cuts import kept_cut_texels
    from light_transport.layout.layout import lay_out
    from light_transport.ray_scene import tree_of
    from light_transport.rays.mirror_parts import mirror_parts
    from light_transport.surfaces.surfaces import surfaces_of

    if prepared is None:
        surfaces = surfaces_of(scene)
        prepared = Prepared(surfaces, tree_of(surfaces))
    surfaces, tree = prepared
    go_on()
    layout = lay_out(scene, surfaces, plan.texel_m, plan.texels, _all_threads(), go_on)
    go_on()
    sizes = plan.patch_texels, plan.bounces_left
    bake = Bake(surfaces, layout, _all_threads(), *sizes, tree, kept_cut_texels)
    bake.lamps = scene.lamps
    bake.add_mirrors(mirror_parts(scene, surfaces), go_on)
    return msgspec.structs.replace(layout.message, mirrors=_mirrors(bake)), bake


def _mirrors(bake: "Bake") -> Mirrors | None:
    """The bake's cubes for the frame."""
    rays, surfaces = bake.mirrors, bake.surfaces
    if rays is None:
        return None
    return Mirrors(
        part=Array(rays.parts.part),
        centre_m=Array(rays.parts.centre * surfaces.radius_m + surfaces.centre_m),
        nearness=Array(rays.nearness / np.float32(surfaces.radius_m)),
    )


def first_rays(rows: int) -> int:
    """How many rays of so many rows are traced in a fraction of a second: from 16 to 64.

    They also tell which rows lie inside bodies: fewer than 16 would be too few.
    """
    wanted = 1 << (_RAYS_AT_FIRST // max(rows, 1)).bit_length() >> 1
    return max(min(_FIRST_RAYS, wanted), _FEWEST_FIRST)


def with_rays(
    bake: "Unwritten[Bake]", count: int, wanted: int, control: JobControl
) -> Round | None:
    """A bake with more rays of each texel, of those `wanted` at last; None if it was cancelled."""
    from light_transport.kept_rays import add_kept_rays
    from light_transport.ray_scene import BLOCK_ROWS

    # Light is made of the rays before, meanwhile.
    grown = copy(bake.value)
    grown.threads = _all_threads()
    done = itertools.count()

    def is_cancelled() -> bool:
        """Asked before each block of rows."""
        rays = grown.rays + min(next(done) * BLOCK_ROWS / grown.rows, 1.0) * count
        control.progress(rays / wanted, f"{rays:.0f} of {wanted} rays")
        return control.cancelled()

    if not add_kept_rays(grown, count, is_cancelled):
        return None
    # Hours follow each other while time plays: they leave the other cores to the frame.
    grown.threads = 1
    return _round(grown)


def _round(bake: "Bake") -> Round:
    return Round(bake.rays, len(bake.texels.pixel), bake.memory_bytes, Unwritten(bake))


def _all_threads() -> int:
    return min(os.cpu_count() or 1, _MOST_THREADS)


def lit(
    bake: "Unwritten[Bake]", layout_key: str, messages: HourMessages, of_still: bool = False
) -> SurfaceLightChanged:
    """The light of an hour, by the rays that there are; that of a still is kept on disk."""
    from light_transport.halves import halves, largest
    from light_transport.kept_light import kept_light

    own, hour = bake.value, hour_of(messages)
    if of_still:
        own.threads = _all_threads()

    def made() -> Arrays:
        light = own.light(hour)
        arrays = {"texels": light.texels, "probes": light.probes, "mirrors": light.mirrors}
        known = {name: array for name, array in arrays.items() if array is not None}
        scale = float16_scale(max(map(largest, known.values())))
        encoded = {name: halves(array, 1.0 / scale) for name, array in known.items()}
        return {**encoded, "visible_sky": light.visible_sky.values, "scale": np.array([scale])}

    found = kept_light(own, layout_key, hour, (), made) if of_still else made()
    encoded = {name: Array(array) for name, array in found.items()}
    return SurfaceLightChanged(
        layout_key=layout_key,
        texels=encoded["texels"],
        probes=encoded.get("probes"),
        radiance_scale=float(found["scale"][0]),
        rays=own.rays,
        source=NAME,
        mirrors=encoded.get("mirrors"),
        visible_sky=encoded["visible_sky"],
    )


def view_lit(
    bake: "Unwritten[Bake]",
    layout_key: str,
    messages: HourMessages,
    asked: StillAsked,
    points: int,
    control: JobControl,
) -> ViewLightChanged | None:
    """The light of an hour on what a picture shows, at about so many points of it.

    None if nobody waits for it any more.
    """
    from light_transport.halves import halves, largest
    from light_transport.hour.view_light import edge_for, view_light
    from light_transport.kept_light import kept_light

    edge_px = edge_for(asked.size_px, points)
    # Hours of the same bake are lit by one thread meanwhile.
    own = copy(bake.value)
    own.threads = _all_threads()
    hour, rays, go_on = hour_of(messages), own.rays, unless(control.cancelled)
    camera, of_picture = asked.camera, (asked.size_px, edge_px)

    def made() -> Arrays:
        found = view_light(own, hour, camera, *of_picture, rays, own.threads, go_on)
        scale = float16_scale(max(largest(found.light), largest(found.mirrored)))
        return {
            "light": halves(found.light, 1.0 / scale),
            "plane": found.plane,
            "mirrored": halves(found.mirrored, 1.0 / scale),
            "scale": np.array([scale]),
        }

    view = (camera.eye_m, camera.target_m, camera.vertical_field_of_view_rad, *of_picture)
    try:
        found = kept_light(own, layout_key, hour, view, made)
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


@lru_cache(maxsize=1)
def hour_of(messages: HourMessages) -> "Hour":
    """An hour in plain arrays, the same ones as long as the same hour is asked for."""
    from light_transport.hour.hour import Hour

    sky, key_light, ambient = messages
    return Hour(
        sky=decode_float16(sky.cube.values, sky.radiance_scale),
        ground_radiance_rgb=sky.ground_radiance_rgb,
        ground_albedo_rgb=ground_albedo(sky, key_light, ambient),
        key_direction=key_light.direction,
        key_irradiance_rgb=key_light.irradiance_rgb,
        open_sky=np.asarray(ambient.irradiance_sh_rgb.values, np.float64),
    )
