"""What follows from a table of rays and is the same for all hours."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from light_transport.hour.borders import Borders, border_light, borders_of
from light_transport.hour.filling import takes_light_of
from light_transport.hour.gather import sky_gathered
from light_transport.hour.key_light import KeyShadows, key_rays_of
from light_transport.hour.lamp_light import (
    LampLight,
    lamp_irradiance,
    lamps_in_radii,
    patch_lamp_light,
)
from light_transport.hour.mirror_light import asked_for_key_light
from light_transport.hour.patch_transfer import PatchTransfer, enclosure, exchange_of
from light_transport.hour.smoothing import (
    STEPS,
    Smoothing,
    mix_at_seams,
    smoothed_rows,
    smoothing_of,
)
from light_transport.hour.visible_sky import sky_moments, visible_sky
from light_transport.kernels import hot
from light_transport.ray_scene import RayScene
from light_transport.rays.ray_starts import scratch
from light_transport.rays.sky_nodes import NODES
from vrut_lite.array import Array
from vrut_lite.numeric_types import BoolArray, Float32Array


@dataclass(frozen=True, eq=False)
class Finished:
    """Values derived from the present table."""

    good: BoolArray
    exchange: PatchTransfer
    smoothing: Smoothing
    borders: Borders
    source: NDArray[np.int32]
    """Whose light each texel (N,) shows, or NOBODY."""
    shown: NDArray[np.int32]
    """Whose light each texel of the map (height, width) shows; the number of texels: nobody's."""
    key_shadows: KeyShadows
    lamps: LampLight | None
    lamps_on_patches: Float32Array | None
    visible_sky: Array
    """See `HourLight`."""

    @property
    def memory_bytes(self) -> int:
        """Of all arrays."""
        parts: list[NDArray | None] = [*self.exchange, *self.smoothing, *self.borders, self.good]
        parts += [self.source, self.shown]
        parts += [self.visible_sky.values, self.lamps_on_patches]
        parts += [] if self.lamps is None else [*self.lamps]
        held = sum(part.nbytes for part in parts if part is not None)
        return held + self.key_shadows.memory_bytes


def finished_of(scene: RayScene) -> Finished:
    """Of a scene some of whose rays are traced."""
    assert scene.patches is not None
    good = scene.good
    texels = len(scene.texels.pixel)
    nearness = scene.table.nearness[:texels]
    valid = scene.table.valid[:texels]
    room = (valid / np.maximum(nearness, np.float32(1e-9))).astype(np.float32)
    source = takes_light_of(scene.beside, good, valid.astype(np.float32))
    shown = np.append(source, -1)[scene.texels.row_of]
    exchange = exchange_of(scene.table, scene.patches)
    lamps = _lamp_light(scene)
    mirrored = _mirrored_texels(scene, texels)
    smoothing = smoothing_of(scene.texels, scene.links, scene.seams, good[:texels], room)
    shown = np.where(shown < 0, texels, shown).astype(np.int32)
    return Finished(
        good,
        exchange,
        smoothing,
        borders_of(scene.texels, scene.beside, source, good[:texels]),
        source,
        shown,
        KeyShadows(key_rays_of(scene.patches, scene.table.free, enclosure(exchange), mirrored)),
        lamps,
        None if lamps is None else patch_lamp_light(scene.patches, scene.table.free, lamps),
        Array(as_map(_visible_sky(scene, smoothing), shown).astype(np.float16)),
    )


def _lamp_light(scene: RayScene) -> LampLight | None:
    if scene.lamps is None:
        return None
    light = LampLight(*np.empty((2, scene.rows, 3), np.float32))
    lamps = lamps_in_radii(scene.lamps, scene.surfaces)
    scene.over_rows(
        scene.rows,
        lambda a, b: lamp_irradiance(
            scene.tree, scene.receivers, scene.table.free, lamps, scratch(), a, b, *light
        ),
    )
    return light


def _visible_sky(scene: RayScene, smoothing: Smoothing) -> Float32Array:
    """Towards where each texel (N, 4) sees the sky."""
    assert scene.patches is not None
    texels = len(scene.texels.pixel)
    towards = sky_moments(NODES + len(scene.patches.area) + 1)
    moments = np.empty((texels, 4), np.float32)
    scene.over_rows(texels, lambda a, b: sky_gathered(scene.table, towards, a, b, moments))
    return visible_sky(smoothed(scene, moments, smoothing), scene.texels.normal)


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
