"""Light transport of a scene: its light map, its rays, and the light of any hour from them.

Daylight coefficients (Tregenza and Waters 1983) carry the sky to texels, radiosity between patches
all bounces; the source of each step stands in its file.
"""

import os
from copy import copy
from functools import cached_property

import msgspec
import numpy as np
from numpy.typing import NDArray

from light_transport.giving_up import CancelCheck, always
from light_transport.hour.card_tables import CardHour, CardTables, card_inputs, card_tables
from light_transport.hour.halves import halves, largest
from light_transport.hour.illumination import HourLight, Illumination
from light_transport.hour.lamp_light import patch_lamp_light
from light_transport.hour.patch_transfer import radiosity
from light_transport.hour.relighting import (
    TransportCache,
    cache_of,
    column_light_of,
    hour_light,
    lamp_light,
    row_light,
    sunlit_patches,
)
from light_transport.layout.layout import Layout, lay_out, lay_out_probes
from light_transport.rays.mirror_rays import MirrorParts, mirror_rays
from light_transport.rays.patches import patches_of
from light_transport.rays.ray_scene import BLOCK_ROWS, Cut, RayScene, are_good
from light_transport.rays.ray_table import RayRows, joined, slice_of, with_columns, with_rays
from light_transport.rays.sky_nodes import NODES
from light_transport.rays.split_texels import split_texels
from light_transport.rays.tree import Tree
from light_transport.surfaces.surfaces import Surfaces
from light_transport.tolerance import TransportSizes
from light_transport.transport_files import cache_rays, cached_rays, cached_split_texels, digest_of
from light_transport.view.view_light import view_light
from vrut_lite.array import Array
from vrut_lite.array_cache import Arrays
from vrut_lite.geometry.encoding import float16_scale
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.lamps import SceneLamps
from vrut_lite.messages.light_map import LightMapLaid, ReflectionProbes
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import Float32Array, FloatArray

_MOST_THREADS = 4
# Number of first rays of a texel, and of all texels together.
_FIRST_RAYS, _RAYS_AT_FIRST = 64, 1_250_000
_FEWEST_FIRST = 16


def first_rays(rows: int) -> int:
    """How many rays of so many rows are traced in a fraction of a second: from 16 to 64.

    They also decide which rows lie inside bodies: fewer than 16 would be too few.
    """
    wanted = 1 << (_RAYS_AT_FIRST // max(rows, 1)).bit_length() >> 1
    return max(min(_FIRST_RAYS, wanted), _FEWEST_FIRST)


def all_threads() -> int:
    """The number of threads that trace rays."""
    return min(os.cpu_count() or 1, _MOST_THREADS)


class SceneTransport(RayScene):
    """A scene's light transport: rays are added round by round, and any hour is lit by them."""

    def __init__(
        self,
        surfaces: Surfaces,
        layout: Layout,
        threads: int = 1,
        patch_texels: float = 6.0,
        bounces_left: float = 3e-3,
        tree: Tree | None = None,
        cut: Cut = split_texels,
    ):
        """Nothing is traced yet.

        Args:
            surfaces: of a scene.
            layout: of its light map.
            threads: number of threads; the light does not depend on it.
            patch_texels: edge of the patches for bounces, in texels.
            bounces_left: share of any patch's light that bounces left out may bring; of the mean
                it is a hundredth of that.
            tree: `tree_of` the surfaces, where there is one already.
            cut: `split_texels`, or what finds the same.
        """
        super().__init__(surfaces, layout, bounces_left, threads, tree, cut)
        self.patch_texels = patch_texels
        # Number of rays of the round that decides which rows have patches.
        self.first_rays = 0
        self._layout = layout.message
        self._cache: TransportCache | None = None
        self._card_tables: CardTables | None = None
        # The last hour that was computed.
        self._light: tuple[Illumination, HourLight] | None = None
        self._column_light: tuple[Illumination, Float32Array] | None = None

    # --- build ----------------------------------------------------------------------------

    @classmethod
    def of_scene(
        cls,
        scene: SceneOpened,
        surfaces: Surfaces,
        sizes: TransportSizes,
        tree: Tree | None = None,
        go_on: CancelCheck = always,
    ) -> "SceneTransport":
        """The transport of a scene with a light map; cut texels are read from disk or kept there.

        Raises:
            GivenUp: by `go_on`.
        """
        threads, patches = all_threads(), (sizes.patch_texels, sizes.bounces_left)
        layout = lay_out(scene, surfaces, sizes.texel_m, sizes.texels, threads, go_on)
        go_on()
        return cls(surfaces, layout, threads, *patches, tree, cached_split_texels)

    @classmethod
    def of_probes(cls, scene: SceneOpened, surfaces: Surfaces, tree: Tree) -> "SceneTransport":
        """The transport of a scene by probes and the ground's texels alone."""
        return cls(surfaces, lay_out_probes(scene, surfaces), all_threads(), tree=tree)

    @property
    def layout_message(self) -> LightMapLaid:
        """The layout as posted, with the cube maps of glossy parts."""
        rays, surfaces = self.mirrors, self.surfaces
        if rays is None:
            return self._layout
        probes = ReflectionProbes(
            part=Array(rays.parts.part),
            centre_m=Array(rays.parts.centre * surfaces.radius_m + surfaces.centre_m),
            nearness=Array(rays.nearness / np.float32(surfaces.radius_m)),
        )
        return msgspec.structs.replace(self._layout, mirrors=probes)

    @property
    def memory_bytes(self) -> int:
        """Memory of all arrays, of the cache's where it is computed."""
        tables = [] if self._card_tables is None else self._card_tables.arrays
        own = sum({id(part): part.nbytes for part in (*self.arrays, *tables)}.values())
        return own + (0 if self._cache is None else self._cache.memory_bytes)

    # --- refine ---------------------------------------------------------------------------

    def add_mirrors(self, parts: MirrorParts, go_on: CancelCheck = always) -> None:
        """Trace the surroundings of these parts; hours then have cubes of them.

        Raises:
            GivenUp: by `go_on`.
        """
        self.mirrors = mirror_rays(
            parts, self.surfaces.part, self.tree, self.receivers, self.threads, go_on
        )
        self._cache = self._card_tables = self._light = self._column_light = None

    def refined(self, count: int, go_on: CancelCheck = always) -> "SceneTransport":
        """The transport with so many more rays of each row; this one stays as it is.

        Raises:
            GivenUp: by `go_on`.
        """
        # Light is made of the rays before, meanwhile.
        found = copy(self)
        found.threads = all_threads()
        found.add_cached_rays(count, go_on)
        # Hours follow each other while time plays: they leave the other cores to the frame.
        found.threads = 1
        return found

    def add_cached_rays(self, count: int, go_on: CancelCheck = always) -> None:
        """As `add_rays`, but rays are read from disk, or kept there for another session."""
        rounds = self.first_rays or count, self.rays + count
        key = self._geometry_digest, self.patch_texels, *rounds
        table = cached_rays(key, self.rows)
        if table is None:
            self.add_rays(count, go_on)
            cache_rays(key, self.table)
        else:
            self._take_rays(table, count)

    def add_rays(self, count: int, go_on: CancelCheck = always) -> None:
        """Trace so many more rays for each row.

        Texels at creases get more of them, texels inside bodies none: see `ray_table.py`.

        Raises:
            GivenUp: by `go_on`, which is called before each block of rows; nothing has changed.
        """
        column_of = np.arange(NODES + self.rows, dtype=np.int32)
        if self.patches is not None:
            column_of = self.patches.column_of

        def block(first: int) -> RayRows:
            go_on()
            rows = slice_of(self.table, first, min(first + BLOCK_ROWS, self.rows))
            return with_rays(self.tree, self.receivers, rows, column_of, self.rays, count)

        blocks = self.in_threads(block, range(0, self.rows, BLOCK_ROWS))
        table = joined(blocks) if blocks else self.table
        if self.patches is None:
            self._make_patches(table, count)
            assert self.patches is not None
            table = with_columns(table, self.patches.column_of)
        self._take_rays(table, count)

    def _take_rays(self, table: RayRows, count: int) -> None:
        """Go on from the table of an equal transport that has so many more rays."""
        if self.patches is None:
            self._make_patches(table, count)
        self.rays += count
        self.table = table
        self._cache = self._card_tables = self._light = self._column_light = None

    def _make_patches(self, table: RayRows, rays: int) -> None:
        self.first_rays = rays
        good = are_good(table)
        self.patches = patches_of(
            self.surfaces,
            self.receivers,
            self.links,
            self.beside,
            self.seams,
            good,
            self.patch_texels,
        )
        own, colour_of = np.unique(self.texels.triangle, return_inverse=True)
        self.surfaces, self.colour_of = self.surfaces.colours_of(own), colour_of.astype(np.int32)

    @cached_property
    def _geometry_digest(self) -> str:
        """Digest of all that rays meet and begin at."""
        receivers = self.receivers
        begin: list[NDArray] = [receivers.texels.pixel, *receivers.probes, *receivers.groups]
        return digest_of([*begin, *self.tree, *receivers.geometry[1:]])

    # --- relight --------------------------------------------------------------------------

    @property
    def cache(self) -> TransportCache:
        """Values that all hours have in common, by the present rays."""
        if self._cache is None:
            self._cache = cache_of(self)
        return self._cache

    def light(self, hour: Illumination) -> HourLight:
        """The light of an hour; some rays must have been added."""
        if self._light is None or self._light[0] is not hour:
            self._light = hour, hour_light(self, self.cache, hour)
        return self._light[1]

    def card_hour(self, hour: Illumination) -> CardHour:
        """Tables and inputs from which a graphics card computes the light of an hour."""
        if self._card_tables is None:
            self._card_tables = card_tables(self, self.cache)
        return CardHour(self._card_tables, card_inputs(self, self.cache, hour))

    def column_light(self, hour: Illumination) -> Float32Array:
        """`HourLight.column_light` alone, which takes less time than all of an hour's light."""
        if self._light is not None and self._light[0] is hour:
            return self._light[1].column_light
        if self._column_light is None or self._column_light[0] is not hour:
            self._column_light = hour, column_light_of(self, self.cache, hour)
        return self._column_light[1]

    def row_light(self, hour: Illumination) -> Float32Array:
        """Irradiance and luminance of the sky's part (N, 4) of all rows, means over their rays."""
        return row_light(self, self.column_light(hour))

    def sunlit_patches(self, direction: FloatArray) -> Float32Array:
        """Direct irradiance (M,) of patches by a key light of 1 W m^-2 from a unit vector (3,)."""
        return sunlit_patches(self, self.cache, direction)

    def lamplit_patches(self, lamps: SceneLamps) -> Float32Array:
        """Direct irradiance (M, 3) of patches, W m^-2, by lamps that need not be the scene's."""
        assert self.patches is not None
        return patch_lamp_light(self.patches, self.table.free, lamp_light(self, lamps))

    def radiosity(
        self, direct: Float32Array, emitted: Float32Array, reflectance: Float32Array
    ) -> Float32Array:
        """Radiosity of patches (M, 3) by direct irradiance and all bounces; all (M, 3)."""
        return radiosity(self.cache.patch_transfer, direct, emitted, reflectance, self.bounces_left)

    def map_arrays(self, hour: Illumination) -> Arrays:
        """The light of an hour as `SurfaceLightChanged` has it."""
        light = self.light(hour)
        arrays = {"texels": light.texels, "probes": light.probes, "mirrors": light.mirrors}
        known = {name: array for name, array in arrays.items() if array is not None}
        scale = float16_scale(max(map(largest, known.values())))
        encoded = {name: halves(array, 1.0 / scale) for name, array in known.items()}
        numbers = {"scale": np.array([scale]), "rays": np.array([self.rays])}
        return {**encoded, "visible_sky": light.visible_sky.values, **numbers}

    def view_arrays(
        self,
        hour: Illumination,
        camera: MoveCamera,
        size_px: tuple[int, int],
        edge_px: int,
        rays: int,
        go_on: CancelCheck,
    ) -> Arrays:
        """The light of an hour at the points of a view as `ViewLightChanged` has it.

        By at most so many `rays` of each point.

        Raises:
            GivenUp: by `go_on`.
        """
        # Hours of the same rays are lit by one thread meanwhile.
        own = copy(self)
        own.threads = all_threads()
        view = camera, size_px, edge_px, rays, own.threads, go_on
        found = view_light(own, hour, own.light(hour), *view)
        scale = float16_scale(max(largest(found.light), largest(found.mirrored)))
        return {
            "light": halves(found.light, 1.0 / scale),
            "plane": found.plane,
            "mirrored": halves(found.mirrored, 1.0 / scale),
            "scale": np.array([scale]),
        }
