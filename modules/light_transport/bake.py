"""The bake: a table of rays over a scene's surfaces, and the light of any hour from it.

Daylight coefficients (Tregenza and Waters 1983) carry the sky to texels, radiosity between patches
all bounces; docs and sources of each step stand in its file.
"""

from collections.abc import Callable

import numpy as np

from light_transport.giving_up import CancelCheck, always
from light_transport.hour.illumination import HourLight, Illumination
from light_transport.layout.layout import Layout
from light_transport.lighting import column_light_of, hour_light
from light_transport.ray_scene import BLOCK_ROWS, Cut, RayScene, are_good
from light_transport.rays.mirror_parts import MirrorParts
from light_transport.rays.mirror_rays import mirror_rays
from light_transport.rays.patches import patches_of
from light_transport.rays.ray_table import Rows, joined, slice_of, with_columns, with_rays
from light_transport.rays.sky_nodes import NODES
from light_transport.rays.split_texels import cut_texels
from light_transport.rays.tree import Tree
from light_transport.surfaces.surfaces import Surfaces
from light_transport.transport_cache import Finished, finished_of
from vrut_lite.numeric_types import Float32Array


class Bake(RayScene):
    """A scene to which rays are added round by round, and its light."""

    def __init__(
        self,
        surfaces: Surfaces,
        layout: Layout,
        threads: int = 1,
        patch_texels: float = 6.0,
        bounces_left: float = 3e-3,
        tree: Tree | None = None,
        cut: Cut = cut_texels,
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
            cut: `cut_texels`, or what finds the same.
        """
        super().__init__(surfaces, layout, bounces_left, threads, tree, cut)
        self.patch_texels = patch_texels
        # Of the round that tells which rows are patched.
        self.first_rays = 0
        self._finished: Finished | None = None
        # Of the last hour that was asked for.
        self._light: tuple[Illumination, HourLight] | None = None
        self._column_light: tuple[Illumination, Float32Array] | None = None

    @property
    def memory_bytes(self) -> int:
        """What the arrays of this take; those that grow out of the table, when there are some."""
        own = sum({id(part): part.nbytes for part in self.arrays}.values())
        return own + (0 if self._finished is None else self._finished.memory_bytes)

    def light(self, hour: Illumination) -> HourLight:
        """The light of an hour; some rays must have been added."""
        if self._light is None or self._light[0] is not hour:
            self._light = hour, hour_light(self, self.finished, hour)
        return self._light[1]

    def column_light(self, hour: Illumination) -> Float32Array:
        """What a ray brings from each column (C, 4): pi L and, of the sky alone, its luminance."""
        if self._column_light is None or self._column_light[0] is not hour:
            self._column_light = hour, column_light_of(self, self.finished, hour)
        return self._column_light[1]

    @property
    def finished(self) -> Finished:
        """What all hours have in common, by the present rays."""
        if self._finished is None:
            self._finished = finished_of(self)
        return self._finished

    def add_mirrors(self, parts: MirrorParts, go_on: CancelCheck = always) -> None:
        """Trace the surroundings of these parts; hours then have cubes of them.

        Raises:
            GivenUp: by `go_on`.
        """
        self.mirrors = mirror_rays(
            parts, self.surfaces.part, self.tree, self.receivers, self.threads, go_on
        )
        self._finished = self._light = self._column_light = None

    def add_rays(self, count: int, is_cancelled: Callable[[], bool] = lambda: False) -> bool:
        """Trace so many more rays for each row; False, and nothing has changed, if cancelled.

        Texels at creases get more of them, texels inside bodies none: see `ray_table.py`.
        """
        column_of = np.arange(NODES + self.rows, dtype=np.int32)
        if self.patches is not None:
            column_of = self.patches.column_of

        def block(first: int) -> Rows | None:
            if is_cancelled():
                return None
            rows = slice_of(self.table, first, min(first + BLOCK_ROWS, self.rows))
            return with_rays(self.tree, self.receivers, rows, column_of, self.rays, count)

        blocks = self.in_threads(block, range(0, self.rows, BLOCK_ROWS))
        done = [rows for rows in blocks if rows is not None]
        if len(done) < len(blocks):
            return False
        table = joined(done) if done else self.table
        if self.patches is None:
            self._make_patches(table, count)
            assert self.patches is not None
            table = with_columns(table, self.patches.column_of)
        self.take_rays(table, count)
        return True

    def take_rays(self, table: Rows, count: int) -> None:
        """Go on from the table of an equal bake that has so many more rays."""
        if self.patches is None:
            self._make_patches(table, count)
        self.rays += count
        self.table = table
        self._finished = self._light = self._column_light = None

    def _make_patches(self, table: Rows, rays: int) -> None:
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
