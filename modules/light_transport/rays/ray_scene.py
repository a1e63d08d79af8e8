"""A scene as rays see it: triangles, the rows that rays begin at, and where these rays end."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from light_transport.layout.layout import Layout
from light_transport.layout.probe_places import probe_places_m
from light_transport.rays.groups import groups_of
from light_transport.rays.links import links_of, seam_links, touching_texels
from light_transport.rays.map_texels import Texels, map_geometry, texels_of, with_backs
from light_transport.rays.mirror_rays import MirrorRays
from light_transport.rays.orientations import orientation_of
from light_transport.rays.patches import Patches
from light_transport.rays.ray_starts import Receivers, no_probes, probe_planes
from light_transport.rays.ray_table import RayRows, empty_rows
from light_transport.rays.split_texels import split_texels
from light_transport.rays.tree import Tree, tree_over
from light_transport.surfaces.sheets import sheets_of
from light_transport.surfaces.surfaces import Surfaces
from vrut_lite.messages.lamps import SceneLamps
from vrut_lite.numeric_types import BoolArray, FloatArray

# Their rays fit into a core's cache, and threads end at about the same time.
BLOCK_ROWS = 512
# Rows of which a smaller share of rays counts lie inside bodies. Where bodies touch, up to half of
# the rays of a hidden row end on a floor or get out between pieces of a wall, which then shines.
_LEAST_FREE = 0.5
_GROUP_TEXELS = 4.0
_SMALLEST_GROUP = 1.0 / 200.0
_Made = TypeVar("_Made")
Cut = Callable[..., tuple[Texels, NDArray[np.int32]]]


def tree_of(surfaces: Surfaces) -> Tree:
    """The tree that rays are traced in."""
    return tree_over(surfaces.corners_m / surfaces.radius_m, surfaces.opacity)


class RayScene:
    """Triangles and rows of a scene, and where the rays of rows end.

    Rows are texels, row by row of the map, and their other sides on sheets, then six planes for
    each probe (+x, -x, +y, -y, +z, -z), then groups of triangles without texels.

    Attributes:
        rows: number of rows.
        rays: rays of each row; texels at creases have more, those inside bodies fewer.
        table: where they end.
        beside, links: (N, 4) int32, the texels around each in the map, and those of them that
            nothing parts from it.
        patches, mirrors, lamps: None without any.
        colour_of: (N,) int32, the triangle of `surfaces` that has a texel's colours: with patches
            `surfaces` keeps only those that texels lie on.
        orientation: (N,) cells of texels and probes, see `orientation_of`.
        bounces_left: share of any patch's light that bounces left out may bring; of the mean it is
            a hundredth of that.
        threads: number that work on rows.
    """

    def __init__(
        self,
        surfaces: Surfaces,
        layout: Layout,
        bounces_left: float,
        threads: int,
        tree: Tree | None,
        cut: Cut = split_texels,
    ):
        """Nothing is traced yet; `tree` is made unless given, `cut` cuts texels."""
        self.surfaces = surfaces.without_shapes()
        self.probes = layout.message.probes
        self.threads = threads
        self.bounces_left = bounces_left
        self.rays = 0
        self.tree = tree_of(surfaces) if tree is None else tree
        geometry = map_geometry(surfaces, layout, self.tree)
        sheets = sheets_of(surfaces)
        self.texels = with_backs(texels_of(geometry), sheets)
        probes = no_probes()
        if self.probes is not None:
            places_m = probe_places_m(self.probes)
            probes = probe_planes(places_m, surfaces.centre_m, surfaces.radius_m)
        widths = self.texels.width if len(self.texels.width) else layout.texel_m / surfaces.radius_m
        edge = max(_SMALLEST_GROUP, _GROUP_TEXELS * float(np.median(widths)))
        groups = groups_of(geometry, sheets, edge)
        self.colour_of = self.texels.triangle
        charts = layout.chart[self.texels.triangle]
        self.beside = links_of(self.texels, charts)
        self.texels, self.links = cut(
            self.tree, geometry, self.texels, charts, self.beside, sheets, self.over_rows
        )
        self.receivers = Receivers(geometry, self.texels, probes, groups)
        touching = touching_texels(self.tree, geometry, self.texels, charts, self.beside)
        self.seams = np.unique(
            np.concatenate([seam_links(self.texels, layout.seams), touching]), axis=0
        )
        self.rows = len(self.texels.pixel) + len(probes.place) + len(groups.area)
        self.table: RayRows = empty_rows(0, self.rows)
        self.patches: Patches | None = None
        self.mirrors: MirrorRays | None = None
        self.lamps: SceneLamps | None = None
        self.orientation = orientation_of(np.concatenate([self.texels.normal, probes.normal]))

    @property
    def good(self) -> BoolArray:
        """Which rows (N,) do not lie inside bodies."""
        return are_good(self.table)

    @property
    def arrays(self) -> list[NDArray]:
        """All that grow with the scene."""
        parts: list[NDArray] = [*self.tree, *self.texels, *self.table[1:], self.seams]
        parts += [self.links, self.beside]
        parts += [*self.receivers.geometry, *self.receivers.probes, *self.receivers.groups]
        parts += [*self.surfaces.arrays, self.orientation, self.colour_of]
        parts += [] if self.patches is None else [*self.patches]
        parts += [] if self.mirrors is None else [*self.mirrors[1:]]
        return parts

    def in_radii(self, places_m: FloatArray) -> FloatArray:
        """Places (..., 3) of the world in radii from the scene's middle, as rays have them."""
        return np.asarray((places_m - self.surfaces.centre_m) / self.surfaces.radius_m)

    def over_rows(self, rows: int, work: Callable[[int, int], None]) -> None:
        """Do work on ranges of rows, which fill arrays apart from each other."""
        step = max(BLOCK_ROWS, -(-rows // max(4 * self.threads, 1))) if self.threads > 1 else rows
        self.in_threads(
            lambda first: work(first, min(first + step, rows)), range(0, rows, max(step, 1))
        )

    def in_threads(self, work: Callable[[int], _Made], firsts: range) -> list[_Made]:
        """Results of work on each number."""
        if self.threads == 1:
            return [work(first) for first in firsts]
        with ThreadPoolExecutor(self.threads) as pool:
            return list(pool.map(work, firsts))


def are_good(table: RayRows) -> BoolArray:
    """Which rows (N,) do not lie inside bodies."""
    return np.asarray(table.valid > _LEAST_FREE * table.traced)
