"""The bake: a table of rays over a scene's surfaces, and the light of any hour from it.

Daylight coefficients (Tregenza and Waters 1983) carry the sky to texels, radiosity between patches
all bounces; docs and sources of each step stand in its file.
"""

import hashlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from light_transport.giving_up import GoOn, always
from light_transport.hour.exchange import Exchange, direct_sky, enclosure, exchange_of, radiosity
from light_transport.hour.filling import takes_light_of
from light_transport.hour.gather import patches_gathered, sky_gathered
from light_transport.hour.hour import Hour, HourLight
from light_transport.hour.key_light import KeyRays, key_rays_of, lit_shares, patch_means
from light_transport.hour.lamp_light import (
    LampLight,
    lamp_irradiance,
    lamps_in_radii,
    patch_lamp_light,
)
from light_transport.hour.mirror_light import asked_for_key_light, cubes, texel_radiance
from light_transport.hour.openness import open_luminance, orientation_of
from light_transport.hour.smoothing import (
    STEPS,
    Smoothing,
    mix_at_seams,
    smoothed_rows,
    smoothing_of,
)
from light_transport.hour.visible_sky import sky_moments, visible_sky
from light_transport.layout.layout import Layout
from light_transport.layout.probe_places import probe_places_m, without_buried
from light_transport.rays.mirror_parts import MirrorParts
from light_transport.rays.mirror_rays import MirrorRays, mirror_rays
from light_transport.rays.patches import Patches, patches_of
from light_transport.rays.ray_starts import Receivers, no_probes, probe_planes, scratch
from light_transport.rays.ray_table import (
    Rows,
    empty_rows,
    joined,
    slice_of,
    with_columns,
    with_rays,
)
from light_transport.rays.sky_nodes import NODES, node_radiances
from light_transport.rays.tree import tree_over
from light_transport.surfaces.groups import groups_of
from light_transport.surfaces.links import links_of, seam_links
from light_transport.surfaces.map_texels import map_geometry, texels_of
from light_transport.surfaces.sheets import sheets_of
from light_transport.surfaces.surfaces import GROUND, Surfaces
from vrut_lite.array import Array
from vrut_lite.daylight.lamps import SceneLamps
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import BoolArray, Float32Array

# Rows of which a smaller share of rays counts lie inside bodies. A tenth is too little: what gets
# out between the pieces of a wall then shines at its edge.
_LEAST_FREE = 0.4
# Orientations that the open sky hardly lights are lit by what stands around: so much is enough of
# the brightest orientation's light to tell how light changes as a surface bends.
_LEAST_OF_SKY = 0.05
_BLOCK_ROWS = 2048
_Made = TypeVar("_Made")
_GROUP_TEXELS = 4.0
_SMALLEST_GROUP = 1.0 / 200.0


@dataclass(frozen=True, eq=False)
class _Finished:
    """Values derived from the present table."""

    good: BoolArray
    exchange: Exchange
    smoothing: Smoothing
    shown: NDArray[np.int32]
    """Whose light each texel of the map (height, width) shows; the number of texels: nobody's."""
    key_rays: KeyRays
    lamps: LampLight | None
    lamps_on_patches: Float32Array | None
    visible_sky: Array
    """See `HourLight`."""


class Bake:
    """Rays between the surfaces of a scene.

    Rows of the table are texels, row by row of the map, then six planes for each probe (+x, -x,
    +y, -y, +z, -z), then groups of triangles without texels and backs of sheets.
    """

    def __init__(
        self,
        surfaces: Surfaces,
        layout: Layout,
        threads: int = 1,
        patch_texels: float = 6.0,
        bounces_left: float = 3e-3,
    ):
        """Nothing is traced yet.

        Args:
            surfaces: of a scene.
            layout: of its light map.
            threads: number of threads; the light does not depend on it.
            patch_texels: edge of the patches for bounces, in texels.
            bounces_left: share of any patch's light that bounces left out may bring; of the mean
                it is a hundredth of that.
        """
        self.surfaces = surfaces.without_shapes()
        self.probes = layout.message.probes
        self.threads = threads
        self.patch_texels = patch_texels
        self.bounces_left = bounces_left
        self.rays = 0
        """How many each row has."""
        geometry = map_geometry(surfaces, layout)
        self.texels = texels_of(geometry)
        self.tree = tree_over(surfaces.corners_m / surfaces.radius_m, surfaces.opacity)
        probes = no_probes()
        if self.probes is not None:
            places_m = probe_places_m(self.probes)
            probes = probe_planes(places_m, surfaces.centre_m, surfaces.radius_m)
        edge = _SMALLEST_GROUP
        if len(self.texels.width):
            edge = max(edge, _GROUP_TEXELS * float(np.median(self.texels.width)))
        groups = groups_of(geometry, sheets_of(surfaces), edge)
        self.receivers = Receivers(geometry, self.texels, probes, groups)
        self.links = links_of(self.texels, layout.chart[self.texels.triangle])
        self.seams = seam_links(self.texels, layout.seams)
        self.rows = len(self.texels.pixel) + len(probes.place) + len(groups.area)
        self.table: Rows = empty_rows(0, self.rows)
        self.patches: Patches | None = None
        self.mirrors: MirrorRays | None = None
        self.lamps: SceneLamps | None = None
        self._orientation = orientation_of(np.concatenate([self.texels.normal, probes.normal]))
        self._finished: _Finished | None = None

    @property
    def memory_bytes(self) -> int:
        """What the arrays of this take; those that grow out of the table, when there are some."""
        parts: list[NDArray] = [*self.tree, *self.texels, *self.table[1:], self.links, self.seams]
        parts += [*self.receivers.geometry, *self.receivers.probes, *self.receivers.groups]
        parts += [*self.surfaces.arrays, self._orientation]
        parts += [] if self.patches is None else [*self.patches]
        parts += [] if self.mirrors is None else [*self.mirrors[1:]]
        if self._finished is not None:
            parts += [*self._finished.exchange, *self._finished.smoothing, *self._finished.key_rays]
            parts += [self._finished.shown, self._finished.good]
        # The links of smoothing may be those of the texels.
        return sum({id(part): part.nbytes for part in parts}.values())

    @cached_property
    def geometry_digest(self) -> str:
        """Of all that rays meet and begin at."""
        digest = hashlib.blake2b(digest_size=16)
        receivers = self.receivers
        begin: list[NDArray] = [receivers.texels.pixel, *receivers.probes, *receivers.groups]
        for array in [*begin, *self.tree, *receivers.geometry]:
            digest.update(f"{array.dtype.str}{array.shape}".encode())
            digest.update(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
        return digest.hexdigest()

    def add_mirrors(self, parts: MirrorParts, go_on: GoOn = always) -> None:
        """Trace the surroundings of these parts; hours then have cubes of them.

        Raises:
            GivenUp: by `go_on`.
        """
        self.mirrors = mirror_rays(
            parts, self.surfaces.part, self.tree, self.receivers, self.threads, go_on
        )
        self._finished = None

    def add_rays(self, count: int, is_cancelled: Callable[[], bool] = lambda: False) -> bool:
        """Trace so many more rays for each row; False, and nothing has changed, if cancelled."""
        column_of = np.arange(NODES + self.rows, dtype=np.int32)
        if self.patches is not None:
            column_of = self.patches.column_of

        def block(first: int) -> Rows | None:
            if is_cancelled():
                return None
            rows = slice_of(self.table, first, min(first + _BLOCK_ROWS, self.rows))
            return with_rays(self.tree, self.receivers, rows, column_of, self.rays, count)

        blocks = self._in_threads(block, range(0, self.rows, _BLOCK_ROWS))
        done = [rows for rows in blocks if rows is not None]
        if len(done) < len(blocks):
            return False
        table = joined(done) if done else self.table
        if self.patches is None:
            self.patches = self._patches_by(table, count)
            table = with_columns(table, self.patches.column_of)
        self.take_rays(table, count)
        return True

    def take_rays(self, table: Rows, count: int) -> None:
        """Go on from the table of an equal bake that has so many more rays."""
        if self.patches is None:
            self.patches = self._patches_by(table, count)
        self.rays += count
        self.table = table
        self._finished = None

    def _patches_by(self, table: Rows, rays: int) -> Patches:
        good = _are_good(table, rays)
        return patches_of(
            self.surfaces, self.receivers, self.links, self.seams, good, self.patch_texels
        )

    def light(self, hour: Hour) -> HourLight:
        """The light of an hour; some rays must have been added."""
        assert self.patches is not None
        finished = self._finish()
        shares = self._key_shares(hour, finished)
        column_light = self._node_light(hour)
        light = np.empty((self.rows, 4), np.float32)
        self._over_rows(self.rows, lambda a, b: sky_gathered(self.table, column_light, a, b, light))
        self._bounce(hour, finished, shares, light, column_light)
        light = light[: len(self._orientation)]
        self._over_rows(
            len(light), lambda a, b: patches_gathered(self.table, column_light, a, b, light)
        )
        texels = len(self.texels.pixel)
        open_sky = open_luminance(hour.open_sky)
        # Where a surface bends, light changes as the open sky's does: what is left is smooth.
        bends = np.maximum(open_sky, _LEAST_OF_SKY * open_sky.max())[self._orientation[:texels]]
        relative = light[:texels] / bends[:, None]
        light[:texels] = self._smoothed(relative, finished.smoothing) * bends[:, None]
        if finished.lamps is not None:
            # It has no noise that is to be smoothed, and edges that are not.
            light[:, :3] += finished.lamps.baked[: len(light)]
        light[:, 3] = np.clip(light[:, 3] / open_sky[self._orientation], 0, 1)
        return HourLight(
            _as_map(light[:texels], finished.shown),
            self._as_probes(light[texels:], finished),
            finished.visible_sky,
            self._as_cubes(hour, finished, light[:texels], column_light, shares),
        )

    def column_light(self, hour: Hour) -> Float32Array:
        """What a ray brings from each column (C, 4): pi L and, of the sky alone, its luminance."""
        finished, found = self._finish(), self._node_light(hour)
        light = np.empty((self.rows, 4), np.float32)
        self._over_rows(self.rows, lambda a, b: sky_gathered(self.table, found, a, b, light))
        self._bounce(hour, finished, self._key_shares(hour, finished), light, found)
        return found

    def _key_shares(self, hour: Hour, finished: _Finished) -> Float32Array:
        """Visible share of the key light times its cosine (N,), of the rows that are asked."""
        share = np.zeros(self.rows, np.float32)
        if np.any(np.asarray(hour.key_irradiance_rgb) > 0.0):
            ray, towards = finished.key_rays.ray, np.asarray(hour.key_direction, np.float64)
            self._over_rows(
                self.rows,
                lambda a, b: lit_shares(
                    self.tree, self.receivers, ray, towards, scratch(), a, b, share
                ),
            )
        return share

    def _node_light(self, hour: Hour) -> Float32Array:
        """What a ray brings from each column (C, 4): pi L of nodes and its luminance.

        It is 0 of patches, for `_bounce` to fill in; the fourth channel is of the sky alone.
        """
        assert self.patches is not None
        column_light = np.zeros((NODES + len(self.patches.area) + 1, 4), np.float32)
        radiances = np.pi * node_radiances(hour.sky, hour.ground_radiance_rgb)
        column_light[:NODES, :3], column_light[:NODES, 3] = radiances, luminance(radiances)
        return column_light

    def _smoothed(self, light: Float32Array, smoothing: Smoothing) -> Float32Array:
        other = np.empty_like(light)
        for _ in range(STEPS):
            self._over_rows(len(light), partial(smoothed_rows, light, other, smoothing))
            mix_at_seams(light, other, smoothing)
            light, other = other, light
        return light

    def _bounce(
        self,
        hour: Hour,
        finished: _Finished,
        key_shares: Float32Array,
        sky_light: Float32Array,
        column_light: Float32Array,
    ) -> None:
        """Fill in what patches send, by the sky's light (N, 4) on rows and all bounces."""
        assert self.patches is not None
        patches = self.patches
        direct = np.empty((len(patches.area), 3), np.float32)
        direct_sky(patches, self.table.valid, sky_light, direct)
        means = patch_means(patches, finished.key_rays, key_shares)
        direct += means[:, None] * np.asarray(hour.key_irradiance_rgb, np.float32)
        if finished.lamps_on_patches is not None:
            direct += finished.lamps_on_patches
        reflectance = patches.reflectance_rgb.copy()
        reflectance[patches.on_ground] = hour.ground_albedo_rgb
        column_light[NODES:-1, :3] = radiosity(
            finished.exchange, direct, patches.emitted_rgb, reflectance, self.bounces_left
        )

    def _finish(self) -> _Finished:
        if self._finished is None:
            assert self.patches is not None
            good = _are_good(self.table, self.rays)
            texels = len(self.texels.pixel)
            nearness = self.table.nearness[:texels]
            valid = self.table.valid[:texels]
            room = (valid / np.maximum(nearness, np.float32(1e-9))).astype(np.float32)
            source = takes_light_of(self.links, good, valid.astype(np.float32))
            shown = np.append(source, -1)[self.texels.row_of]
            exchange = exchange_of(self.table, self.patches)
            lamps = self._lamp_light()
            mirrored = self._mirrored_texels(texels)
            smoothing = smoothing_of(self.texels, self.links, self.seams, good[:texels], room)
            shown = np.where(shown < 0, texels, shown).astype(np.int32)
            self._finished = _Finished(
                good,
                exchange,
                smoothing,
                shown,
                key_rays_of(self.patches, self.table.free, enclosure(exchange), mirrored),
                lamps,
                None if lamps is None else patch_lamp_light(self.patches, self.table.free, lamps),
                Array(_as_map(self._visible_sky(smoothing), shown).astype(np.float16)),
            )
        return self._finished

    def _lamp_light(self) -> LampLight | None:
        if self.lamps is None:
            return None
        light = LampLight(*np.empty((2, self.rows, 3), np.float32))
        lamps = lamps_in_radii(self.lamps, self.surfaces)
        self._over_rows(
            self.rows,
            lambda a, b: lamp_irradiance(
                self.tree, self.receivers, self.table.free, lamps, scratch(), a, b, *light
            ),
        )
        return light

    def _visible_sky(self, smoothing: Smoothing) -> Float32Array:
        """Towards where each texel (N, 4) sees the sky."""
        assert self.patches is not None
        texels = len(self.texels.pixel)
        towards = sky_moments(NODES + len(self.patches.area) + 1)
        moments = np.empty((texels, 4), np.float32)
        self._over_rows(texels, lambda a, b: sky_gathered(self.table, towards, a, b, moments))
        return visible_sky(self._smoothed(moments, smoothing), self.texels.normal)

    def _mirrored_texels(self, texels: int) -> NDArray[np.integer]:
        """The texels in mirrors that need a shadow ray."""
        if self.mirrors is None:
            return np.empty(0, np.int32)
        seen = self.mirrors.row[: np.searchsorted(self.mirrors.row, texels)]
        return asked_for_key_light(seen, self.texels, self.links)

    def _as_probes(self, light: Float32Array, finished: _Finished) -> Float32Array | None:
        if self.probes is None:
            return None
        nx, ny, nz = self.probes.counts
        buried = ~finished.good[len(self.texels.pixel) :][: len(light)].reshape(nz, ny, nx, 6)
        return without_buried(light.reshape(nz, ny, nx, 6, 4), np.asarray(buried.any(axis=-1)))

    def _as_cubes(
        self,
        hour: Hour,
        finished: _Finished,
        light: Float32Array,
        column_light: Float32Array,
        key_shares: Float32Array,
    ) -> Float32Array | None:
        """Cubes (C, 6, e, e, 4) of glossy parts, by the light (N, 4) of texels."""
        if self.mirrors is None:
            return None
        assert self.patches is not None
        seen = self.mirrors.row
        texels = int(np.searchsorted(seen, len(self.texels.pixel)))
        radiance = np.empty((len(seen), 3), np.float32)
        column, row = self.texels.pixel.T
        shown = finished.shown[row, column]
        texel_radiance(
            seen[:texels],
            self.surfaces.part,
            (self.surfaces.reflectance_rgb, self.surfaces.emitted_rgb),
            self.texels.triangle,
            (light, np.where(shown == len(shown), -1, shown)),
            (key_shares, finished.key_rays.ray, self.links),
            np.array([hour.ground_albedo_rgb, hour.key_irradiance_rgb], np.float32),
            radiance,
        )
        if finished.lamps is not None:
            triangle = self.texels.triangle[seen[:texels]]
            radiance[:texels] += (
                self._reflectance(hour)[triangle] * finished.lamps.drawn[seen[:texels]] / np.pi
            )
        column = self.patches.column_of[NODES + seen[texels:]]
        radiance[texels:] = column_light[column, :3] / np.float32(np.pi)
        return cubes(self.mirrors, radiance)

    def _reflectance(self, hour: Hour) -> Float32Array:
        """Of all triangles (F, 3), the ground's in this hour included."""
        reflectance = self.surfaces.reflectance_rgb.copy()
        reflectance[self.surfaces.part == GROUND] = hour.ground_albedo_rgb
        return reflectance

    def _over_rows(self, rows: int, work: Callable[[int, int], None]) -> None:
        """Do work on ranges of rows, which fill arrays apart from each other."""
        step = max(_BLOCK_ROWS, -(-rows // max(4 * self.threads, 1))) if self.threads > 1 else rows
        self._in_threads(
            lambda first: work(first, min(first + step, rows)), range(0, rows, max(step, 1))
        )

    def _in_threads(self, work: Callable[[int], _Made], firsts: range) -> list[_Made]:
        if self.threads == 1:
            return [work(first) for first in firsts]
        with ThreadPoolExecutor(self.threads) as pool:
            return list(pool.map(work, firsts))


def _as_map(rows: Float32Array, shown: NDArray[np.int32]) -> Float32Array:
    """Rows (N, 4) where each texel of the map (height, width, 4) finds them."""
    padded = np.concatenate([rows, np.zeros((1, 4), np.float32)])
    return np.take(padded, shown, axis=0)


def _are_good(table: Rows, rays: int) -> BoolArray:
    """Which rows (N,) do not lie inside bodies."""
    return np.asarray(table.valid > _LEAST_FREE * rays)
