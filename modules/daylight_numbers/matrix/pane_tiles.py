"""Tiles of panes of measured glazing: pieces of panes that face one way, seen from indoors."""

from typing import NamedTuple

import numpy as np
from light_transport.public import MISS, SceneTransport, edges_of, first_hits
from scipy.spatial import cKDTree

from daylight_numbers.glazing.pane_materials import PaneMaterials
from daylight_numbers.matrix.sensor_rays import SKY, GlazedScene, around, ends_of
from daylight_numbers.sky_cells import on_disc
from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray, IntArray

# Number of points of a tile on average, and of points of its texels that tell which are its own.
_POINTS, _SEEDS = 1024, 256
# Least cosine between the normals of a facet and its triangles.
FACET_COSINE = 0.9
# Number of points of a side of a pane from which it looks for the sky.
_LOOKING = 256
# Maximum number of tiles, the edge of the first ones as a share of the scene's radius, and how
# much wider they become at a time.
_MOST_TILES, _FINEST, _WIDER = 96, 1.0 / 40.0, 1.25
# Offset of rays in radii, and the most that a pane modelled as a body may be thick, in metres.
_OFF, _THICKEST_M = 1e-5, 0.15
# Sine of the angle between up and a pane's normal below which north stands for up.
_LEVEL = 0.05
_NORTH = np.array([0.0, 0.0, -1.0])


class PaneTiles(NamedTuple):
    """Tiles (S), those of a glazing after each other, on facets (K): planes of one glazing.

    `patches` (N,) of the light map and the tile of each, `tile` (N,); `facet` (S,); `glazing` (K,);
    `axes` (K, 3, 3): x, y and z of `angle_basis` in the world, z to indoors.
    """

    patches: IntArray
    tile: IntArray
    facet: IntArray
    glazing: IntArray
    axes: FloatArray


def tiles_of(
    transport: SceneTransport,
    closed: GlazedScene,
    materials: PaneMaterials,
    random: np.random.Generator,
) -> PaneTiles:
    """The tiles of a scene in whose light map panes are opaque and have two sides.

    Raises:
        UserError: no pane of a glazing sees the sky.
    """
    assert transport.patches is not None
    patches, glazing, normal = _pane_patches(transport, materials)
    area = transport.patches.area[patches].astype(float)
    # Sides of panes: what faces one way, to a tenth of a radian.
    key = np.column_stack([glazing, np.round(normal * 10.0).astype(np.int64)])
    _, side = np.unique(key, axis=0, return_inverse=True)
    side = side.reshape(-1)
    chosen, facet = np.zeros(len(patches), bool), np.full(len(patches), -1)
    kinds: list[int] = []
    axes: list[FloatArray] = []
    for one in range(int(side.max(initial=-1)) + 1):
        here = side == one
        inwards = area[here] @ normal[here]
        inwards /= np.linalg.norm(inwards)
        if not _is_indoors(transport, closed, patches[here], inwards, random):
            continue
        chosen |= here
        facet[here] = len(kinds)
        kinds.append(int(glazing[here][0]))
        axes.append(_axes(inwards, materials.up[kinds[-1]]))
    for n, name in enumerate(materials.names):
        if n not in kinds:
            raise UserError(
                f"bsdf: no pane of the material '{name}' sees the sky through one side more than "
                "through the other: measured glazing stands between outdoors and indoors"
            )
    patches, facet = patches[chosen], facet[chosen]
    kind = np.array(kinds, np.int64)
    tile = _numbered(transport, patches, facet, kind[facet])
    of_tile = np.zeros(int(tile.max()) + 1, np.int64)
    of_tile[tile] = facet
    return PaneTiles(patches, tile, of_tile, kind, np.array(axes))


def points_of(
    transport: SceneTransport, patches: IntArray, count: int, random: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Random points (count, 3) of patches, in radii, by their area, and the unit normals there."""
    found, receivers = transport.patches, transport.receivers
    assert found is not None
    texels, groups = receivers.texels, receivers.groups
    rows = np.concatenate([found.member[found.start[p] : found.start[p + 1]] for p in patches])
    share = np.concatenate(
        [found.weight[found.start[p] : found.start[p + 1]] * float(found.area[p]) for p in patches]
    )
    row = random.choice(rows, count, p=share / share.sum())
    place, normal = np.empty((count, 3)), np.empty((count, 3))
    is_texel = row < len(texels.pixel)
    place[is_texel], normal[is_texel] = texels.place[row[is_texel]], texels.normal[row[is_texel]]
    group = row[~is_texel] - len(texels.pixel) - len(receivers.probes.place)
    at = random.random(len(group))
    first, last = groups.start[group], groups.start[group + 1]
    number = np.array(
        [
            a + min(int(np.searchsorted(groups.area_up_to[a:b], value)), b - a - 1)
            for a, b, value in zip(first, last, at, strict=True)
        ],
        np.int64,
    )
    triangle = groups.triangle[number]
    corner, one, other = edges_of(receivers.geometry, triangle)
    root, across = np.sqrt(random.random((len(group), 1))), random.random((len(group), 1))
    place[~is_texel] = corner + root * (1.0 - across) * one + root * across * other
    normal[~is_texel] = groups.side[group][:, None] * receivers.geometry.faces[triangle]
    return place, normal


def points_on_tiles(
    transport: SceneTransport,
    materials: PaneMaterials,
    tiles: PaneTiles,
    random: np.random.Generator,
) -> list[FloatArray]:
    """Random points (N, 3) of each tile (S), in radii, evenly spread over its triangles.

    Texels are too coarse for the shadow of a reveal; a point belongs to the nearest texel.
    """
    geometry = transport.receivers.geometry
    found: list[FloatArray] = [np.empty((0, 3))] * len(tiles.facet)
    for facet, (glazing, axes) in enumerate(zip(tiles.glazing, tiles.axes, strict=True)):
        here = materials.of_triangle == glazing
        here &= np.abs(geometry.faces @ axes[2]) > FACET_COSINE
        own = np.flatnonzero(tiles.facet == facet)
        corner, one, other = edges_of(geometry, np.flatnonzero(here))
        area = np.linalg.norm(np.cross(one, other), axis=1)
        count = _POINTS * len(own)
        n = random.choice(len(area), count, p=area / area.sum())
        root, across = np.sqrt(random.random((count, 1))), random.random((count, 1))
        places = corner[n] + root * (1.0 - across) * one[n] + root * across * other[n]
        seeds, of_seed = [], []
        for tile in own:
            some, _ = points_of(transport, tiles.patches[tiles.tile == tile], _SEEDS, random)
            seeds.append(some)
            of_seed.append(np.full(_SEEDS, tile))
        _, nearest = cKDTree(np.concatenate(seeds)).query(places)
        tile_of_place = np.concatenate(of_seed)[nearest]
        for tile, some in zip(own, seeds, strict=True):
            mine = places[tile_of_place == tile]
            found[tile] = mine if len(mine) else some
    return found


def outdoors_of(where: GlazedScene, places: FloatArray, inwards: FloatArray) -> FloatArray:
    """Places (N, 3) just outdoors of points (N, 3) of a pane: beyond the pane's other side too,
    where it is modelled as a body."""
    outwards = np.broadcast_to(-inwards, places.shape)
    start = places + _OFF * outwards
    hit, distance = first_hits(where.tree, start, np.ascontiguousarray(outwards))
    thickest = _THICKEST_M / where.scene.surfaces.radius_m
    faces = where.scene.receivers.geometry.faces[np.where(hit == MISS, 0, hit)]
    # A body's other side is met from within.
    is_body = (hit != MISS) & (distance < thickest) & (faces @ -inwards > 0.0)
    return np.asarray(start + np.where(is_body, distance + _OFF, 0.0)[:, None] * outwards)


def _pane_patches(
    transport: SceneTransport, materials: PaneMaterials
) -> tuple[IntArray, IntArray, FloatArray]:
    """Patches (N,) on panes, their glazing (N,), and the normals (N, 3) of their visible sides."""
    patches, receivers = transport.patches, transport.receivers
    assert patches is not None
    texels, groups = receivers.texels, receivers.groups
    first = patches.member[patches.start[:-1]]
    triangle = np.zeros(len(first), np.int64)
    normal = np.zeros((len(first), 3))
    is_texel = first < len(texels.pixel)
    triangle[is_texel] = texels.triangle[first[is_texel]]
    side = np.ones(len(first))
    side[is_texel] = texels.side[first[is_texel]]
    group = first[~is_texel] - len(texels.pixel) - len(receivers.probes.place)
    triangle[~is_texel] = groups.triangle[groups.start[group]]
    side[~is_texel] = groups.side[group]
    normal = side[:, None] * receivers.geometry.faces[triangle]
    glazing = materials.of_triangle[triangle]
    here = np.flatnonzero((glazing >= 0) & (patches.area > 0.0))
    return here, glazing[here], normal[here]


def _is_indoors(
    transport: SceneTransport,
    closed: GlazedScene,
    patches: IntArray,
    inwards: FloatArray,
    random: np.random.Generator,
) -> bool:
    """Whether more sky is seen away from a side of panes, through them, than before it."""
    places, _ = points_of(transport, patches, _LOOKING, random)
    starts = places + _OFF * inwards, outdoors_of(closed, places, inwards)
    before, behind = (
        np.mean(ends_of(closed, start, spread(way, _LOOKING, random))[0][:, 0] == SKY)
        for start, way in zip(starts, (inwards, -inwards), strict=True)
    )
    return bool(behind > before)


def spread(normal: FloatArray, count: int, random: np.random.Generator) -> FloatArray:
    """Directions (count, 3) around a normal, a square number, evenly spread by the cosine."""
    edge = int(np.sqrt(count))
    row, column = np.divmod(np.arange(edge * edge), edge)
    at = (np.stack([row, column]) + random.random((2, edge * edge))) * (2.0 / edge) - 1.0
    return around(np.broadcast_to(normal, (edge * edge, 3)), *on_disc(*at))


def _axes(inwards: FloatArray, up: FloatArray) -> FloatArray:
    """x, y and z (3, 3) of a pane whose normal points indoors."""
    x = np.cross(up / np.linalg.norm(up), inwards)
    if np.linalg.norm(x) < _LEVEL:
        x = np.cross(_NORTH, inwards)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(inwards, x), inwards])


def _numbered(
    transport: SceneTransport, patches: IntArray, facet: IntArray, glazing: IntArray
) -> IntArray:
    """Numbers (N,) of tiles: patches of a facet in one cell of space, by glazing first."""
    assert transport.patches is not None
    middle = np.stack([_middle(transport, int(p)) for p in patches])
    edge = _FINEST
    while True:
        cell = np.floor((middle - middle.min(axis=0)) / edge + 1e-6).astype(np.int64)
        key = np.column_stack([glazing, facet, cell])
        _, number = np.unique(key, axis=0, return_inverse=True)
        if number.max() < _MOST_TILES or edge > 2.0:
            return np.asarray(number.reshape(-1))
        edge *= _WIDER


def _middle(transport: SceneTransport, patch: int) -> FloatArray:
    """The middle (3,) of a patch, in radii."""
    found, receivers = transport.patches, transport.receivers
    assert found is not None
    here = slice(found.start[patch], found.start[patch + 1])
    row = found.member[here]
    texels, groups = receivers.texels, receivers.groups
    if row[0] < len(texels.pixel):
        return np.asarray(found.weight[here] @ texels.place[row].astype(float))
    group = int(row[0]) - len(texels.pixel) - len(receivers.probes.place)
    triangle = groups.triangle[groups.start[group] : groups.start[group + 1]]
    corner, one, other = edges_of(receivers.geometry, triangle)
    return np.asarray((corner + (one + other) / 3.0).mean(axis=0))
