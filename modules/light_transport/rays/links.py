"""Pairs of texels that lie beside each other on a surface.

Charts that touch in one plane are paired too: a wall in pieces is one wall. Edges of pieces need
not meet corner to corner, nor belong to one mesh, as `layout.seams` requires; nothing may stand
between two texels, as on a floor that a wall parts.
"""

import math
from typing import cast

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import dot, kernel
from light_transport.rays.map_texels import NOBODY, MapGeometry, Texels
from light_transport.rays.split_texels import apart, middle_place
from light_transport.rays.tree import STACK, Tree

# Maximum distance, in texels, between neighbours in the map that are on one chart.
_NEAR = 2.5
# Maximum distance, in texels, of texels on both sides of an edge: one across, half a one along it.
_NEAR_EDGE = 1.15
# Least edge of a cell of a search for neighbours, in radii: numbers of cells fit into 62 bits.
_SMALLEST_CELL = 1e-5
# Two texels share a plane if normals agree to 2 degrees and the step between them rises no more
# than this share of its length.
_SAME_FACING, _OFF_PLANE = 0.9994, 0.05


def links_of(texels: Texels, charts: NDArray[np.int32]) -> NDArray[np.int32]:
    """The texels (N, 4) above, below, left and right of each on the same surface, or NOBODY.

    `charts` (N,): texels of two charts are never linked. Links go both ways.
    """
    return cast(NDArray[np.int32], _links(texels, charts))


def seam_links(texels: Texels, seams: NDArray[np.int32]) -> NDArray[np.int32]:
    """Pairs (K, 2) of texels that meet at a seam, each once; `seams` as in `Layout`."""
    ends = texels.row_of.ravel()[seams.astype(np.int64)].reshape(-1, 2)
    ends = np.sort(ends[(ends >= 0).all(axis=1) & (ends[:, 0] != ends[:, 1])], axis=1)
    backs = texels.back[ends]
    return np.unique(np.concatenate([ends, backs[(backs >= 0).all(axis=1)]]), axis=0).astype(
        np.int32
    )


@kernel
def _links(texels, charts):  # type: ignore[no-untyped-def]
    height, width = texels.row_of.shape
    count = len(texels.pixel)
    links = np.full((count, 4), NOBODY, np.int32)
    for i in range(count):
        column, row = texels.pixel[i, 0], texels.pixel[i, 1]
        for k in range(4):
            c, r = column + (0, 0, -1, 1)[k], row + (-1, 1, 0, 0)[k]
            if c < 0 or r < 0 or c >= width or r >= height:
                continue
            j = texels.row_of[r, c]
            # Padding names the texel that it copies.
            if j < 0 or texels.pixel[j, 0] != c or texels.pixel[j, 1] != r:
                continue
            if texels.side[i] < 0.0:
                j = texels.back[j]
                if j == NOBODY:
                    continue
            away = texels.place[j] - texels.place[i]
            reach = _NEAR * max(texels.width[i], texels.width[j])
            if charts[i] == charts[j] and dot(away, away) < reach * reach:
                links[i, k] = j
    return links


def touching_texels(
    tree: Tree,
    geometry: MapGeometry,
    texels: Texels,
    charts: NDArray[np.int32],
    links: NDArray[np.int32],
) -> NDArray[np.int32]:
    """Pairs (K, 2) of texels of two `charts` (N,), the smaller first.

    `links` (N, 4): only texels that lack one of four neighbours are paired.
    """
    is_rim = (links == NOBODY).any(axis=1) & (texels.width > 0.0)
    # The ground's texels are as wide as houses far away, and cells would be.
    rims = np.flatnonzero(is_rim & ~geometry.on_ground[texels.triangle])
    if len(rims) < 2:
        return np.empty((0, 2), np.int32)
    edge = max(_NEAR_EDGE * float(texels.width[rims].max()), _SMALLEST_CELL)
    cells = np.floor(texels.place[rims].astype(np.float64) / edge).astype(np.int64)
    cells -= cells.min(axis=0)
    # Room on both sides, so that no row of cells goes on in the next.
    counts = cells.max(axis=0) + 3
    cell = (cells[:, 0] * counts[1] + cells[:, 1]) * counts[2] + cells[:, 2]
    order = np.argsort(cell, kind="stable")
    rims, cell = rims[order], cell[order]
    # Cells beside each other along the last axis follow each other: nine runs of three.
    rows = np.array([(x * counts[1] + y) * counts[2] for x in (-1, 0, 1) for y in (-1, 0, 1)])
    around = cell[:, None] + rows
    runs = np.stack(
        [np.searchsorted(cell, around - 1), np.searchsorted(cell, around + 1, "right")], axis=2
    )
    solid = (tree.opacity >= 1.0)[geometry.leaf]
    solid &= np.isfinite(geometry.uv).all(axis=(1, 2)) | geometry.on_ground
    stacks = np.empty(STACK, np.int32), np.empty(STACK, np.float32)
    places = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    return np.asarray(_pairs(tree, geometry, texels, charts, solid, rims, runs, stacks, places))


@kernel
def _pairs(tree, geometry, texels, charts, solid, rims, runs, stacks, places):  # type: ignore[no-untyped-def]
    weights, a, b, normal = places
    found = np.empty((1024, 2), np.int32)
    count = 0
    for k in range(len(rims)):
        i = rims[k]
        for run in range(runs.shape[1]):
            for m in range(runs[k, run, 0], runs[k, run, 1]):
                j = rims[m]
                if j <= i or charts[i] == charts[j]:
                    continue
                if dot(texels.normal[i], texels.normal[j]) < _SAME_FACING:
                    continue
                away2, off = 0.0, 0.0
                for axis in range(3):
                    step = texels.place[j, axis] - texels.place[i, axis]
                    away2 += step * step
                    off += step * texels.normal[i, axis]
                width = max(texels.width[i], texels.width[j])
                if away2 > (_NEAR_EDGE * width) ** 2 or abs(off) > _OFF_PLANE * math.sqrt(away2):
                    continue
                t = middle_place(geometry, texels, i, weights, a, normal)
                middle_place(geometry, texels, j, weights, b, normal)
                if apart(tree, geometry, solid, a, b, t, stacks):
                    continue
                if count == len(found):
                    found = np.concatenate((found, found))
                found[count, 0], found[count, 1] = i, j
                count += 1
    return found[:count].copy()
