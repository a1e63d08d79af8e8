"""The background jobs: a layout, rays, an hour, a view. Plain functions of their arguments.

numba is imported where work begins, so that programs without a light map do not wait for it.
"""

import os
from copy import copy
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

import msgspec
import numpy as np
from numpy.typing import NDArray

from light_transport.giving_up import GivenUp, GoOn, unless
from light_transport.messages import NAME
from light_transport.unseen_hours import HourMessages
from vrut_lite.array import Array
from vrut_lite.daylight.light_map import LightMapLaid, Mirrors, SurfaceLightChanged
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.daylight.scene_state import ground_albedo
from vrut_lite.daylight.view_light import StillAsked, ViewLightChanged
from vrut_lite.geometry.encoding import decode_float16, float16_scale
from vrut_lite.kernel.job import JobControl
from vrut_lite.numeric_types import Float32Array

if TYPE_CHECKING:
    from light_transport.bake import Bake
    from light_transport.hour.hour import Hour

T = TypeVar("T")
_MOST_THREADS = 4
# Of a texel, and of all together.
_FIRST_RAYS, _RAYS_AT_FIRST = 64, 1_250_000
_FEWEST_FIRST = 16


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


class Laid(NamedTuple):
    """A layout, the rays of its first round, and the bake that begins with it."""

    message: LightMapLaid
    first_rays: int
    bake: "Unwritten[Bake]"


class Round(NamedTuple):
    """A bake after a round: rays of each texel, texels, memory of the table."""

    rays: int
    texels: int
    table_bytes: int
    bake: "Unwritten[Bake]"


def laid_out(scene: SceneOpened, plan: Plan, control: JobControl) -> Laid | None:
    """Lay out a scene; None if nobody waits for it any more."""
    try:
        return _laid_out(scene, plan, unless(control.cancelled))
    except GivenUp:
        return None


def _laid_out(scene: SceneOpened, plan: Plan, go_on: GoOn) -> Laid:
    from light_transport.bake import Bake
    from light_transport.layout.layout import lay_out
    from light_transport.rays.mirror_parts import mirror_parts
    from light_transport.surfaces.surfaces import surfaces_of

    surfaces = surfaces_of(scene)
    go_on()
    layout = lay_out(scene, surfaces, plan.texel_m, plan.texels, go_on)
    go_on()
    bake = Bake(surfaces, layout, 1, plan.patch_texels, plan.bounces_left)
    bake.threads = _all_threads()
    bake.lamps = scene.lamps
    bake.add_mirrors(mirror_parts(scene, surfaces), go_on)
    bake.threads = 1
    message = msgspec.structs.replace(layout.message, mirrors=_mirrors(bake))
    return Laid(message, first_rays(bake.rows), Unwritten(bake))


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


def with_rays(bake: "Unwritten[Bake]", count: int, control: JobControl) -> Round | None:
    """A bake with more rays of each texel; None if it was cancelled."""
    from light_transport.kept_rays import add_kept_rays

    # Light is made of the rays before, meanwhile.
    grown = copy(bake.value)
    grown.threads = _all_threads()
    if not add_kept_rays(grown, count, control.cancelled):
        return None
    # Hours follow each other while time plays: they leave the other cores to the frame.
    grown.threads = 1
    texels = len(grown.texels.pixel)
    return Round(grown.rays, texels, grown.memory_bytes, Unwritten(grown))


def _all_threads() -> int:
    return min(os.cpu_count() or 1, _MOST_THREADS)


def lit(bake: "Unwritten[Bake]", layout_key: str, messages: HourMessages) -> SurfaceLightChanged:
    """The light of an hour, by the rays that there are."""
    light = bake.value.light(hour_of(messages))
    arrays = {"texels": light.texels, "probes": light.probes, "mirrors": light.mirrors}
    known = {name: array for name, array in arrays.items() if array is not None}
    scale = float16_scale(max(float(array[..., :3].max()) for array in known.values()))
    encoded = {name: Array(_encoded(array, scale)) for name, array in known.items()}
    return SurfaceLightChanged(
        layout_key=layout_key,
        texels=encoded["texels"],
        probes=encoded.get("probes"),
        radiance_scale=scale,
        rays=bake.value.rays,
        source=NAME,
        mirrors=encoded.get("mirrors"),
        visible_sky=light.visible_sky,
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
    from light_transport.hour.view_light import edge_for, view_light

    edge_px = edge_for(asked.size_px, points)
    hour, rays, go_on = hour_of(messages), bake.value.rays, unless(control.cancelled)
    view = asked.camera, asked.size_px, edge_px
    try:
        found = view_light(bake.value, hour, *view, rays, _all_threads(), go_on)
    except GivenUp:
        return None
    scale = float16_scale(float(found.light[..., :3].max(initial=0.0)))
    return ViewLightChanged(
        layout_key=layout_key,
        camera=asked.camera,
        size_px=asked.size_px,
        edge_px=edge_px,
        light=Array(_encoded(found.light, scale)),
        plane=Array(found.plane),
        radiance_scale=scale,
        rays=rays,
        source=NAME,
    )


def hour_of(messages: HourMessages) -> "Hour":
    """An hour in plain arrays."""
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


def _encoded(light: Float32Array, scale: float) -> NDArray[np.float16]:
    """Irradiance over the scale, and the share of the open sky's as it is."""
    return (light * np.array([1.0 / scale] * 3 + [1.0], np.float32)).astype(np.float16)
