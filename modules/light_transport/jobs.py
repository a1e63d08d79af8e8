"""The background jobs: a layout, rays, an hour, a view. Plain functions of their arguments.

numba is imported where work begins, so that programs without a light map do not wait for it.
"""

import itertools
import os
from collections.abc import Callable
from copy import copy
from functools import lru_cache
from threading import Lock
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

import msgspec
import numpy as np

from light_transport.cached_layout import (
    BakeRecipe,
    RoundNumbers,
    keep_layout,
    keep_round,
    kept_layout,
    kept_round,
    scene_key,
)
from light_transport.giving_up import CancelCheck, unless
from light_transport.messages import NAME
from vrut_lite.array import Array
from vrut_lite.array_cache import Arrays
from vrut_lite.errors import GivenUp
from vrut_lite.geometry.encoding import decode_float16, float16_scale
from vrut_lite.kernel.job import JobControl
from vrut_lite.messages.light_map import LightMapLaid, ReflectionProbes, SurfaceLightChanged
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import AmbientChanged, SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.messages.view_light import StillAsked, ViewLightChanged
from vrut_lite.sky.ground_albedo import ground_albedo

if TYPE_CHECKING:
    from light_transport.bake import Bake
    from light_transport.hour.illumination import Illumination
    from light_transport.rays.tree import Tree
    from light_transport.surfaces.surfaces import Surfaces

T = TypeVar("T")
Cancelled = Callable[[], bool]
_MOST_THREADS = 4
# Of a texel, and of all together.
_FIRST_RAYS, _RAYS_AT_FIRST = 64, 1_250_000
_FEWEST_FIRST = 16
# Of each side of a probe.
_PROBE_RAYS = 32


def _never() -> bool:
    return False


class Unwritten(Generic[T]):
    """A value that journals record by name only; a replay computes it again.

    It is made when it is first asked for. A bake of a whole layout has a `recipe`.
    """

    def __init__(self, make: Callable[[], T], recipe: BakeRecipe | None = None):
        self.recipe = recipe
        self._make = make
        self._made: T | None = None
        self._lock = Lock()

    @property
    def value(self) -> T:
        """The value, the same one for all who ask."""
        with self._lock:
            if self._made is None:
                self._made = self._make()
            return self._made

    @property
    def is_made(self) -> bool:
        """Whether it is there already."""
        return self._made is not None


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


def _laid_probes(scene: SceneOpened, go_on: CancelCheck) -> LaidProbes:
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
    done = _round(bake, None) if bake.good[probes].any() else None
    return LaidProbes(layout.message, done, Unwritten(lambda: prepared))


def laid_out(
    scene: SceneOpened,
    plan: Plan,
    rays: int,
    prepared: "Unwritten[Prepared] | None",
    of_still: bool,
    control: JobControl,
) -> Laid | None:
    """Lay out a scene and trace the first of so many rays; None if nobody waits for it any more.

    One job: between two the host may draw a first picture for seconds. For a still, whose light may
    be kept on disk, what was laid out in another session is laid out when somebody asks for it.
    """
    key = scene_key(scene, plan)

    def made(cancelled: Cancelled = _never) -> "tuple[LightMapLaid, Bake]":
        given = None if prepared is None else prepared.value
        message, bake = _laid_out(scene, plan, given, unless(cancelled))
        return message, _grown(bake, min(first_rays(bake.rows), rays), cancelled)

    kept = kept_layout(key) if of_still else None
    if kept is not None:
        message, rows = kept
        count = min(first_rays(rows), rays)
        done = _kept_round(BakeRecipe(key, count, count), lambda: made()[1])
        if done is not None:
            return Laid(message, done)
    try:
        message, bake = made(control.cancelled)
    except GivenUp:
        return None
    if of_still:
        keep_layout(key, message, bake.rows)
    return Laid(message, _round(bake, BakeRecipe(key, bake.rays, bake.rays), of_still))


def _laid_out(
    scene: SceneOpened, plan: Plan, prepared: Prepared | None, go_on: CancelCheck
) -> "tuple[LightMapLaid, Bake]":
    from light_transport.bake import Bake
    from light_transport.cached_cuts import kept_cut_texels
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


def _mirrors(bake: "Bake") -> ReflectionProbes | None:
    """The bake's cubes for the frame."""
    rays, surfaces = bake.mirrors, bake.surfaces
    if rays is None:
        return None
    return ReflectionProbes(
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
    bake: "Unwritten[Bake]", count: int, wanted: int, of_still: bool, control: JobControl
) -> Round | None:
    """A bake with more rays of each texel, of those `wanted` at last; None if it was cancelled."""
    assert bake.recipe is not None
    rays = bake.recipe.rays
    recipe = bake.recipe._replace(rays=rays + count)
    if of_still and not bake.is_made:
        done = _kept_round(recipe, lambda: _grown(bake.value, count))
        if done is not None:
            return done
    from light_transport.ray_scene import BLOCK_ROWS

    own, blocks = bake.value, itertools.count()

    def is_cancelled() -> bool:
        """Asked before each block of rows."""
        traced = rays + min(next(blocks) * BLOCK_ROWS / own.rows, 1.0) * count
        control.progress(traced / wanted, f"{traced:.0f} of {wanted} rays")
        return control.cancelled()

    try:
        return _round(_grown(own, count, is_cancelled), recipe, of_still)
    except GivenUp:
        return None


def _grown(bake: "Bake", count: int, cancelled: Cancelled = _never) -> "Bake":
    """The bake with so many more rays of each row; the bake itself stays as it is.

    Raises:
        GivenUp: `cancelled()` answered yes.
    """
    from light_transport.cached_rays import add_kept_rays

    # Light is made of the rays before, meanwhile.
    grown = copy(bake)
    grown.threads = _all_threads()
    if not add_kept_rays(grown, count, cancelled):
        raise GivenUp
    # Hours follow each other while time plays: they leave the other cores to the frame.
    grown.threads = 1
    return grown


def _round(bake: "Bake", recipe: BakeRecipe | None, keeps: bool = False) -> Round:
    numbers = RoundNumbers(len(bake.texels.pixel), bake.memory_bytes)
    if keeps and recipe is not None:
        keep_round(recipe, numbers)
    return Round(bake.rays, *numbers, Unwritten(lambda: bake, recipe))


def _kept_round(recipe: BakeRecipe, make: "Callable[[], Bake]") -> Round | None:
    """A round of another session, whose bake is made when somebody asks for it."""
    numbers = kept_round(recipe)
    return None if numbers is None else Round(recipe.rays, *numbers, Unwritten(make, recipe))


def _all_threads() -> int:
    return min(os.cpu_count() or 1, _MOST_THREADS)


def lit(
    bake: "Unwritten[Bake]", layout_key: str, sky_light: SkyLightChanged, of_still: bool = False
) -> SurfaceLightChanged:
    """The light of an hour, by the rays that there are; that of a still is kept on disk."""
    from light_transport.cached_light import kept_light

    hour = hour_of(sky_light)

    def made() -> Arrays:
        from light_transport.halves import halves, largest

        own = bake.value
        if of_still:
            own.threads = _all_threads()
        light = own.light(hour)
        arrays = {"texels": light.texels, "probes": light.probes, "mirrors": light.mirrors}
        known = {name: array for name, array in arrays.items() if array is not None}
        scale = float16_scale(max(map(largest, known.values())))
        encoded = {name: halves(array, 1.0 / scale) for name, array in known.items()}
        numbers = {"scale": np.array([scale]), "rays": np.array([own.rays])}
        return {**encoded, "visible_sky": light.visible_sky.values, **numbers}

    recipe = bake.recipe if of_still else None
    found = made() if recipe is None else kept_light(recipe, hour, (), made)
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


def view_lit(
    bake: "Unwritten[Bake]",
    layout_key: str,
    sky_light: SkyLightChanged,
    asked: StillAsked,
    points: int,
    control: JobControl,
) -> ViewLightChanged | None:
    """The light of an hour on what a picture shows, at about so many points of it.

    None if nobody waits for it any more.
    """
    from light_transport.cached_light import kept_light

    assert bake.recipe is not None
    edge_px = _edge_for(asked.size_px, points)
    hour, rays = hour_of(sky_light), bake.recipe.rays
    camera, of_picture = asked.camera, (asked.size_px, edge_px)

    def made() -> Arrays:
        from light_transport.halves import halves, largest
        from light_transport.hour.view_light import view_light

        # Hours of the same bake are lit by one thread meanwhile.
        own = copy(bake.value)
        own.threads = _all_threads()
        go_on = unless(control.cancelled)
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
        found = kept_light(bake.recipe, hour, view, made)
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


def hour_of(light: SkyLightChanged) -> "Illumination":
    """An hour in plain arrays, the same ones for repeated calls with equal light.

    Args:
        light: with `radiance`.
    """
    assert light.radiance is not None
    return _hour_of(light.radiance, light.key_light, light.ambient)


@lru_cache(maxsize=1)
def _hour_of(
    sky: SkyRadianceChanged, key_light: KeyLightChanged, ambient: AmbientChanged
) -> "Illumination":
    from light_transport.hour.illumination import Illumination

    return Illumination(
        sky=decode_float16(sky.cube.values, sky.radiance_scale),
        ground_radiance_rgb=sky.ground_radiance_rgb,
        ground_albedo_rgb=ground_albedo(sky, key_light, ambient),
        key_direction=key_light.direction,
        key_irradiance_rgb=key_light.irradiance_rgb,
        open_sky=np.asarray(ambient.irradiance_sh_rgb.values, np.float64),
    )
