"""Light that panes of measured glazing scatter indoors.

The matrix method of Klems (1994), as in Radiance's three phases (Ward et al. 2011), but for tiles
of panes: rays from a tile bring light of the sky, of open ground and of patches into the incident
patches of its angle basis, and the glazing's matrix makes radiances indoors of it. What passes
unscattered is a beam apart, see `window_xml.MeasuredGlazing.straight`. Light passes from outdoors
to indoors alone; a pane's outside is the side that sees more sky.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from light_transport.public import NODES, CancelCheck, RayScene, SceneTransport, always
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, vstack

from daylight_numbers.glazing.glass import Glass
from daylight_numbers.glazing.pane_materials import PaneMaterials
from daylight_numbers.matrix.pane_tiles import (
    PaneTiles,
    outdoors_of,
    points_on_tiles,
    spread,
    tiles_of,
)
from daylight_numbers.matrix.sensor_rays import (
    BODY,
    OPEN_GROUND,
    SKY,
    Ends,
    GlazedScene,
    ends_of,
    glazed,
)
from daylight_numbers.sky_cells import CELLS, cell_of
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray, IntArray

# Number of a tile's rays outdoors, and of its points from which the sun is looked for.
_RAYS, _SUN_POINTS = 4096, 16
_RAYS_AT_ONCE = 1 << 17
# Share of a tile's rays outdoors that may meet the side indoors of other measured panes.
_MOST_BEHIND = 0.02


class PaneHits(NamedTuple):
    """Which rays (R,) met tiles from indoors, and of these (N) the exiting patch among those of all
    tiles, and the share of light that comes straight through."""

    met: BoolArray
    exiting: IntArray
    straight: FloatArray


class Entries(NamedTuple):
    """Entries (N) of a matrix by colour: rows, columns, -1 for none, and values (N, 3)."""

    row: IntArray
    column: IntArray
    value: FloatArray


def joined(parts: Sequence[Entries]) -> Entries:
    """All that have a column."""
    return Entries(
        np.concatenate([part.row[part.column >= 0] for part in parts]),
        np.concatenate([part.column[part.column >= 0] for part in parts]),
        np.concatenate([part.value[part.column >= 0] for part in parts]),
    )


@dataclass(frozen=True, eq=False)
class MeasuredPanes:
    """The panes of a scene, and how light outdoors falls on them.

    Attributes:
        materials: what they are made of.
        tiles: their pieces (S).
        closed, opened: the scene with panes opaque, and as if they were openings.
        tile_of: (M,) the tile of each patch of the light map, -1 for none.
        points: (S, _SUN_POINTS, 3), places just outdoors, in radii.
        by_cells: of each half of the rays (I, CELLS + 1), irradiance of the incident patches of all
            tiles by radiances of the sky's cells and of open ground.
        by_patches: of each half (I, M), the same by radiosities of patches.
    """

    materials: PaneMaterials
    tiles: PaneTiles
    closed: GlazedScene
    opened: GlazedScene
    tile_of: IntArray
    points: FloatArray
    by_cells: tuple[csr_matrix, csr_matrix]
    by_patches: tuple[csr_matrix, csr_matrix]

    @cached_property
    def glazing_of(self) -> IntArray:
        """The glazing (S,) of each tile."""
        return np.asarray(self.tiles.glazing[self.tiles.facet])

    @cached_property
    def first_exiting(self) -> IntArray:
        """Where each tile's exiting patches begin (S + 1,)."""
        sizes = np.array([len(glazing.exiting) for glazing in self.materials.glazings])
        return np.concatenate([[0], np.cumsum(sizes[self.glazing_of])])

    @property
    def exiting(self) -> int:
        """Number of exiting patches of all tiles."""
        return int(self.first_exiting[-1])

    @property
    def has_straight(self) -> bool:
        """Whether some light passes unscattered."""
        return any(glazing.straight.any() for glazing in self.materials.glazings)

    def met_by(self, target: NDArray[np.integer], direction: FloatArray) -> PaneHits:
        """The tiles that rays from indoors met, by directions (R, 3) and the rows (R,) of their
        ends."""
        patches = self.closed.scene.patches
        assert patches is not None
        patch = patches.column_of[NODES + np.maximum(target, 0)] - NODES
        known = (target >= 0) & (patch >= 0) & (patch < len(self.tile_of))
        tile = np.where(known, self.tile_of[np.where(known, patch, 0)], -1)
        onwards = self._onwards(self.tiles.facet[tile], direction)
        # Rays along a pane, and those from outdoors at its seams, bring nothing.
        met = (tile >= 0) & (onwards[:, 2] > 0.0)
        tile, onwards = tile[met], onwards[met]
        exiting, straight = np.zeros(len(tile), np.int64), np.zeros(len(tile))
        for n, glazing in enumerate(self.materials.glazings):
            here = self.glazing_of[tile] == n
            exiting[here] = glazing.exiting.patch_of(onwards[here])
            straight[here] = glazing.straight[glazing.incident.patch_of(onwards[here])]
        return PaneHits(met, self.first_exiting[tile] + exiting, straight)

    def seen_along(self, ends: Ends, places: FloatArray) -> tuple[Ends, list["Entries"]]:
        """Ends of rays at opaque panes, and matrix entries for light scattered and straight.

        Args:
            ends: of rays as if panes were openings.
            places: (P, 3) in radii, at which the rays of each sensor begin.
        """
        target, share = ends_of(self.closed, places[ends.sensor], ends.direction)
        hits = self.met_by(target[:, 0], ends.direction)
        met, scene = hits.met, self.closed.scene
        assert scene.patches is not None
        sensor, area = ends.sensor[met], ends.area[met]
        exiting = CELLS + 1 + len(scene.patches.area) + hits.exiting
        parts = [Entries(sensor, exiting, np.pi * area[:, None] * share[met, 0])]
        if self.has_straight:
            column, weight = ends_in_columns(scene, ends.target[met, 0], ends.direction[met])
            weight *= area * hits.straight
            parts.append(Entries(sensor, column, weight[:, None] * ends.share[met, 0]))
        return ends._replace(target=target, share=share), parts

    def radiances(
        self,
        half: int,
        radiances: FloatArray | csr_matrix | None,
        radiosity: FloatArray | Float32Array,
    ) -> FloatArray:
        """Radiances (O, L) indoors by one half of the tiles' rays.

        Args:
            half: which.
            radiances: of cells and of open ground (CELLS + 1, L); None where all are dark.
            radiosity: of patches (M, L).
        """
        incident = self.by_patches[half] @ radiosity
        if radiances is not None:
            incident = incident + self.by_cells[half] @ radiances
        return self.scattered(np.asarray(incident))

    def _onwards(self, facet: IntArray, outwards: FloatArray) -> FloatArray:
        """Coordinates (R, 3) of the way in which light from `outwards` (R, 3) goes straight on."""
        return np.einsum("rij,rj->ri", self.tiles.axes[facet], -np.asarray(outwards, float))

    def scattered(self, incident: FloatArray) -> FloatArray:
        """Radiances (O, L) indoors by irradiances (I, L) of the incident patches of all tiles."""
        out, begin = [], 0
        for n, glazing in enumerate(self.materials.glazings):
            tiles = int((self.glazing_of == n).sum())
            end = begin + tiles * len(glazing.incident)
            each = incident[begin:end].reshape(tiles, len(glazing.incident), -1)
            matrix = glazing.scattered.astype(incident.dtype)
            out.append(np.matmul(matrix, each).reshape(tiles * len(glazing.exiting), -1))
            begin = end
        return np.concatenate(out)

    def of_sun(self, directions: FloatArray) -> Float32Array:
        """Radiances (O, H) indoors by suns (H, 3) of 1 W m^-2, without their straight beams."""
        directions = np.asarray(directions, float)
        out = np.zeros((self.exiting, len(directions)), np.float32)
        reached = self.sunlit(directions)
        for tile, glazing in enumerate(self.glazing_of):
            found = self.materials.glazings[glazing]
            shines = np.flatnonzero(reached[tile])
            facet = np.full(len(shines), self.tiles.facet[tile])
            onwards = self._onwards(facet, directions[shines])
            light = reached[tile, shines] * onwards[:, 2]
            begin, end = self.first_exiting[tile : tile + 2]
            out[begin:end, shines] = found.scattered[:, found.incident.patch_of(onwards)] * light
        return out

    def sunlit(self, directions: FloatArray) -> FloatArray:
        """Share (S, H) of each tile's points that suns (H, 3) shine on, by what glass passes."""
        outwards = -self.tiles.axes[self.tiles.facet, 2]
        tile, sun = np.nonzero((outwards @ directions.T > 0.0) & (directions[:, 1] > 0.0))
        found = np.zeros((len(outwards), len(directions)))
        step = _RAYS_AT_ONCE // _SUN_POINTS
        for first in range(0, len(tile), step):
            t, s = tile[first : first + step], sun[first : first + step]
            towards = np.repeat(directions[s], _SUN_POINTS, axis=0)
            target, share = ends_of(self.closed, self.points[t].reshape(-1, 3), towards)
            got = luminance(share[:, 0]) * (target[:, 0] == SKY)
            free = (target[:, 0] != BODY).reshape(-1, _SUN_POINTS).sum(axis=1)
            found[t, s] = got.reshape(-1, _SUN_POINTS).sum(axis=1) / np.maximum(free, 1)
        return found

    def straight_through(self, facet: int, directions: FloatArray) -> FloatArray:
        """Share (H,) of suns (H, 3) that passes a facet straight on; 0 from indoors."""
        directions = np.asarray(directions, float)
        onwards = self._onwards(np.full(len(directions), facet), directions)
        glazing = self.materials.glazings[self.tiles.glazing[facet]]
        found = glazing.straight[glazing.incident.patch_of(onwards)]
        return np.asarray(np.where(onwards[:, 2] > 0.0, found, 0.0))


def measured_panes(
    transport: SceneTransport, glass: Glass, materials: PaneMaterials, go_on: CancelCheck = always
) -> MeasuredPanes:
    """The panes of a scene whose rays are traced.

    Args:
        transport: the scene; its panes are `PaneMaterials.opaque`.
        glass: of the other materials.
        materials: of panes.
        go_on: called between tiles.

    Raises:
        UserError: a pane does not stand between outdoors and indoors, or behind another one.
        GivenUp: by `go_on`.
    """
    patches = transport.patches
    assert patches is not None
    closed, opened = glazed(transport, glass), glazed(transport, materials.opened(glass))
    tiles = tiles_of(transport, closed, materials, np.random.Generator(np.random.Philox(key=0)))
    count = len(tiles.facet)
    places = points_on_tiles(
        transport, materials, tiles, np.random.Generator(np.random.Philox(key=1))
    )

    of_pane = np.isin(np.arange(len(patches.area)), tiles.patches)

    def traced(tile: int) -> tuple[csr_matrix, csr_matrix, FloatArray]:
        go_on()
        random = np.random.Generator(np.random.Philox(key=2 + tile))
        axes = tiles.axes[tiles.facet[tile]]
        basis = materials.glazings[tiles.glazing[tiles.facet[tile]]].incident
        halves = []
        for _ in range(2):
            start = outdoors_of(closed, random.choice(places[tile], _RAYS), axes[2])
            towards = spread(-axes[2], _RAYS, random)
            target, share = ends_of(closed, start, towards)
            column, weight = ends_in_columns(transport, target[:, 0], towards)
            # Parts of panes that frames hide begin inside bodies.
            weight *= luminance(share[:, 0]) / max(int((target[:, 0] != BODY).sum()), 1)
            patch = column - CELLS - 1
            behind = np.mean(of_pane[np.maximum(patch, 0)] & (patch >= 0))
            if behind > _MOST_BEHIND:
                name = materials.names[tiles.glazing[tiles.facet[tile]]]
                raise UserError(
                    f"bsdf: a pane of the material '{name}' stands indoors behind another measured "
                    "one: give one file for both together, and leave out the other"
                )
            row = basis.patch_of(np.maximum(-towards @ axes.T, [-1.0, -1.0, 0.0]))
            used = column >= 0
            shape = (len(basis), CELLS + 1 + len(patches.area))
            halves.append(csr_matrix((weight[used], (row[used], column[used])), shape))
        return halves[0], halves[1], start[random.choice(_RAYS, _SUN_POINTS, replace=False)]

    with ThreadPoolExecutor(transport.threads) as pool:
        found = list(pool.map(traced, range(count)))
    tile_of = np.full(len(patches.area), -1, np.int64)
    tile_of[tiles.patches] = tiles.tile
    points = np.array([each[2] for each in found])
    one, other = (vstack([each[half] for each in found], format="csr") for half in range(2))
    return MeasuredPanes(
        materials, tiles, closed, opened, tile_of, points,
        (one[:, : CELLS + 1].tocsr(), other[:, : CELLS + 1].tocsr()),
        (one[:, CELLS + 1 :].tocsr(), other[:, CELLS + 1 :].tocsr()),
    )  # fmt: skip


def ends_in_columns(
    scene: RayScene, target: NDArray[np.integer], direction: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Columns (R,) of rays' ends among cells, open ground and patches, -1 for none, and what makes
    irradiance of each: pi for radiances, 1 for radiosities."""
    assert scene.patches is not None
    column, weight = np.full(len(target), -1, np.int64), np.ones(len(target))
    sky, below, met = target == SKY, target == OPEN_GROUND, target >= 0
    column[sky], column[below] = cell_of(direction[sky]), CELLS
    weight[sky | below] = np.pi
    patch = scene.patches.column_of[NODES + target[met]] - NODES
    column[met] = np.where(patch < len(scene.patches.area), CELLS + 1 + patch, -1)
    return column, weight
