"""The tables of a bake as the shaders of a graphics card read them, and the inputs of an hour.

The shaders `drawing/shaders/hour_*.comp` take the steps of `relighting.hour_light`. What is linear
is a list of weighted links: means over patches, bounces, smoothing with its seams, and probes that
lie inside bodies. The tables are made once a bake; an hour brings some 60,000 numbers, none of them
a texel's.

Shadow rays stay with the processor: it keeps them for fixed directions, three of which serve many
hours (`key_light.py`).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from light_transport.hour.illumination import Illumination
from light_transport.hour.key_light import patch_means
from light_transport.hour.patch_transfer import enclosure
from light_transport.hour.relighting import (
    TransportCache,
    buried_probes,
    key_shares,
    node_light,
    shares_of_seen,
    texels_seen,
)
from light_transport.hour.sky_visibility import open_luminance
from light_transport.layout.probe_places import without_buried
from light_transport.rays.ray_scene import RayScene
from light_transport.rays.sky_nodes import NODES
from light_transport.surfaces.surfaces import GROUND
from vrut_lite.array import Array
from vrut_lite.numeric_types import BoolArray, Float32Array

UintArray = NDArray[np.uint32]
# Share of the patches' light (root of the mean square) that sweeps on a card may leave out.
_LEFT = 2e-6
_LARGEST_RETURN, _MOST_SWEEPS = 0.999, 400
# What a row that a mirror sees is: a texel of the scene or of the ground, or a patch.
_OF_SCENE, _OF_GROUND, _OF_PATCH = 0, 1, 2


class Links(NamedTuple):
    """Weighted sums of other rows: row i is that of the entries `start[i]` to `start[i + 1]`.

    `entry` (E, 2) uint32: the other row, and the bits of its weight as a float32.
    """

    start: UintArray
    entry: UintArray


class CardTables(NamedTuple):
    """Tables of a bake for all hours (N rows, T texels, M patches).

    Attributes:
        entry: the table of rays; `is_wide`: an entry has 32 bits, otherwise 16.
        rows: (N + 1, 4) uint32: a row's first entry, its first of a patch, its rays that count, its
            orientation; of the last only the first.
        texels: T. lit: rows that are shown, the texels and the sides of probes.
        members: means over patches of their rows.
        transfer: means over patches of the table's columns.
        patches: (M, 3, 4) float32: emitted radiosity and 1 on the ground; reflectance; lamps.
        enclosure: (M,) float32, share of a patch's view that is other patches.
        smoothing: a step of smoothing, of texels. back: (T,) share that is given back.
        border_of: (T,) int32, number of a texel among the borders or -1; borders: (K, 9, 2)
            uint32, their neighbours and the weights' bits.
        lamps: (lit, 4) float32, irradiance of lamps that the frame does not draw; None without any.
        shown: (height, width) int32, the row of each texel of the map, T for none.
        probes: which probes each shows; None without any. probe_counts: along x, y and z.
        seen: (U, 3, 4) uint32, rows that mirrors see: emitted radiosity and kind; reflectance and
            the row or column of their light, or -1; lamps that the frame draws. All are bits of
            float32 but kind, row and column. None without mirrors.
        target: (C, 6, e, e, rays) int32, the row of `seen` that each ray of a cube met, or -1.
    """

    entry: NDArray[np.uint16] | NDArray[np.int32]
    is_wide: bool
    rows: UintArray
    texels: int
    lit: int
    members: Links
    transfer: Links
    patches: Float32Array
    enclosure: Float32Array
    smoothing: Links
    back: Float32Array
    border_of: NDArray[np.int32]
    borders: UintArray
    lamps: Float32Array | None
    shown: NDArray[np.int32]
    probes: Links | None
    probe_counts: tuple[int, int, int]
    seen: UintArray | None
    target: NDArray[np.int32] | None

    @property
    def arrays(self) -> list[NDArray]:
        """All of them, some of which the bake has too."""
        links = self.members, self.transfer, self.smoothing, self.probes
        parts = [*self, *(part for each in links if each is not None for part in each)]
        return [part for part in parts if isinstance(part, np.ndarray)]


class CardInputs(NamedTuple):
    """Inputs of an hour, float32.

    Attributes:
        nodes: (NODES, 4), pi times the radiance of the sky's nodes, and its luminance.
        key: (M,), means over patches of the key light's share times its cosine.
        seen: (V,), the same of the texels that mirrors see.
        open_sky: (cells,), luminance of the irradiance under open sky.
        colours: (2, 3), the ground's albedo, and the key light's irradiance on a plane facing it.
    """

    nodes: Array
    key: Array
    seen: Array
    open_sky: Array
    colours: Array


def card_inputs(scene: RayScene, cache: TransportCache, hour: Illumination) -> CardInputs:
    """The inputs of an hour."""
    assert scene.patches is not None
    shares = key_shares(scene, cache, hour)
    seen = np.zeros(0, np.float32)
    if scene.mirrors is not None:
        seen = shares_of_seen(scene, cache, shares)
    return CardInputs(
        Array(node_light(hour)),
        Array(patch_means(scene.patches, cache.key_shadows.rays, shares)),
        Array(seen),
        Array(open_luminance(hour.open_sky)),
        Array(np.array([hour.ground_albedo_rgb, hour.key_irradiance_rgb], np.float32)),
    )


def card_tables(scene: RayScene, cache: TransportCache) -> CardTables:
    """The tables of a bake."""
    assert scene.patches is not None
    table, transfer = scene.table, cache.patch_transfer
    texels, lit = len(scene.texels.pixel), len(scene.orientation)
    rows = np.zeros((scene.rows + 1, 4), np.uint32)
    rows[:, 0] = table.start
    rows[:-1, 1] = table.start[:-1] + table.nodes
    rows[:-1, 2] = table.valid
    rows[:lit, 3] = scene.orientation
    lamps = None
    if cache.lamps is not None and cache.lamps.baked[:lit].any():
        lamps = np.pad(cache.lamps.baked[:lit], ((0, 0), (0, 1)))
    border_of = np.full(texels, -1, np.int32)
    border_of[cache.borders.row] = np.arange(len(cache.borders.row))
    mirrors = scene.mirrors
    return CardTables(
        entry=table.entry,
        is_wide=table.entry.itemsize == 4,
        rows=rows,
        texels=texels,
        lit=lit,
        members=_member_links(scene),
        transfer=Links(
            transfer.start.astype(np.uint32),
            _entries(transfer.column.astype(np.uint32) + np.uint32(NODES), transfer.share),
        ),
        patches=_patch_table(scene, cache),
        enclosure=enclosure(transfer),
        smoothing=_smoothing_links(cache, texels),
        back=cache.smoothing.back.ravel(),
        border_of=border_of,
        borders=_entries(cache.borders.near, cache.borders.weight),
        lamps=lamps,
        shown=cache.shown,
        probes=None if scene.probes is None else _probe_links(buried_probes(scene, cache)),
        probe_counts=(1, 1, 1) if scene.probes is None else scene.probes.counts,
        seen=None if mirrors is None else _seen_table(scene, cache),
        target=None if mirrors is None else mirrors.target,
    )


def largest_return(tables: CardTables, ground_albedo_rgb: ArrayLike) -> float:
    """The largest share of all patches' light that a patch sends back, in any channel.

    It bounds the spectral radius of a bounce (Gershgorin).
    """
    albedo = tables.patches[:, 1, :3].copy()
    albedo[tables.patches[:, 0, 3] > 0.0] = np.asarray(ground_albedo_rgb, np.float32)
    most = float((albedo.max(axis=1) * tables.enclosure).max(initial=0.0))
    return min(most, _LARGEST_RETURN)


def sweep_weights(largest: float) -> list[float]:
    """Weights of the sweeps, as many as leave a negligible share of the bounces out.

    Chebyshev's semi-iteration (Golub and Varga 1961): x_k+1 = w (b + G x_k - x_k-1) + x_k-1. Sweeps
    of a card cannot follow each other within a sweep, as those of Gauss and Seidel do, nor can
    the card be asked how much is left: their number follows from the largest return.
    """
    if largest <= 0.0:
        return []
    count = math.ceil(math.acosh(1.0 / _LEFT) / math.acosh(1.0 / largest))
    weights = [1.0]
    for sweep in range(1, min(count, _MOST_SWEEPS)):
        before = 2.0 if sweep == 1 else weights[-1]
        weights.append(1.0 / (1.0 - 0.25 * largest**2 * before))
    return weights


def _entries(other: NDArray[np.integer], weight: Float32Array) -> UintArray:
    """Pairs (..., 2) of a row and the bits of its weight."""
    bits = np.ascontiguousarray(weight, np.float32).view(np.uint32)
    return np.stack([other.astype(np.uint32), bits], axis=-1)


def _links(
    row: NDArray[np.integer], other: NDArray[np.integer], weight: Float32Array, rows: int
) -> Links:
    """Links in any order; those without a weight are left out."""
    counts = weight != 0.0
    row, other, weight = row[counts], other[counts], weight[counts]
    order = np.argsort(row, kind="stable")
    start = np.zeros(rows + 1, np.uint32)
    start[1:] = np.cumsum(np.bincount(row, minlength=rows))
    return Links(start, _entries(other[order], weight[order]))


def _member_links(scene: RayScene) -> Links:
    patches = scene.patches
    assert patches is not None
    sizes = np.diff(patches.start)
    patch = np.repeat(np.arange(len(sizes)), sizes)
    weight = np.where(scene.table.valid[patches.member] > 0, patches.weight, 0.0)
    total = np.maximum(np.bincount(patch, weight, len(sizes)), 1e-12)
    mean = (weight / total[patch]).astype(np.float32)
    return _links(patch, patches.member, mean, len(sizes))


def _patch_table(scene: RayScene, cache: TransportCache) -> Float32Array:
    patches = scene.patches
    assert patches is not None
    found = np.zeros((len(patches.area), 3, 4), np.float32)
    found[:, 0, :3], found[:, 0, 3] = patches.emitted_rgb, patches.on_ground
    found[:, 1, :3] = patches.reflectance_rgb
    if cache.lamps_on_patches is not None:
        found[:, 2, :3] = cache.lamps_on_patches
    return found


def _smoothing_links(cache: TransportCache, texels: int) -> Links:
    """A step over links and seams; what neighbours do not give is the texel's own."""
    links, weights, seams, across, _ = cache.smoothing
    own = np.arange(texels)
    row = np.concatenate([np.repeat(own, links.shape[1]), *seams.T])
    other = np.concatenate([links.ravel(), *seams.T[::-1]])
    weight = np.concatenate([weights.ravel(), *across.T])
    left = 1.0 - np.bincount(row, weight, texels)
    return _links(
        np.concatenate([row, own]),
        np.concatenate([other, own]),
        np.concatenate([weight, left.astype(np.float32)]),
        texels,
    )


def _probe_links(buried: BoolArray) -> Links:
    """Which probes each shows: itself, or of a buried one its neighbours by `without_buried`."""
    count = buried.size
    shares = np.eye(count, dtype=np.float32).reshape(*buried.shape, count)
    shown = without_buried(shares, buried).reshape(count, count)
    row, other = np.nonzero(shown)
    return _links(row, other, shown[row, other], count)


def _seen_table(scene: RayScene, cache: TransportCache) -> UintArray:
    """The rows that mirrors see: first texels, then those that show their patch alone."""
    assert scene.mirrors is not None
    assert scene.patches is not None
    texels, seen = texels_seen(scene), scene.mirrors.row
    triangle = scene.colour_of[seen[:texels]]
    surfaces = scene.surfaces
    colours = np.zeros((len(seen), 3, 4), np.float32)
    colours[:texels, 0, :3] = surfaces.emitted_rgb[triangle]
    colours[:texels, 1, :3] = surfaces.reflectance_rgb[triangle]
    if cache.lamps is not None:
        colours[:texels, 2, :3] = cache.lamps.drawn[seen[:texels]]
    found = colours.view(np.uint32)
    found[:texels, 0, 3] = np.where(surfaces.part[triangle] == GROUND, _OF_GROUND, _OF_SCENE)
    found[:texels, 1, 3] = cache.source[seen[:texels]].view(np.uint32)
    found[texels:, 0, 3] = _OF_PATCH
    found[texels:, 1, 3] = scene.patches.column_of[NODES + seen[texels:]]
    return found


class CardHour(NamedTuple):
    """The tables and inputs of an hour's light."""

    tables: CardTables
    inputs: CardInputs
