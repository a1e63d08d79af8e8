"""Tensor trees of measured glazing, as matrices in Klems's full basis.

Ward, Mistrick, Lee, McNeil and Jonsson 2011, "Simulating the daylight performance of complex
fenestration systems using bidirectional scattering distribution functions within Radiance",
Leukos 7(4), and Radiance's bsdf_t.c: a tree divides the unit cube of its rank into halves along all
axes at once, n of them where a leaf is constant. Axes are incident, then exiting coordinates: of
rank 4 both directions on Shirley and Chiu's square (1997), which keeps projected solid angles; of
rank 3, isotropic, (1 - sine of the incident polar angle) / 2, and the exiting direction turned by
the incident azimuth. Directions are those of `angle_basis`.

A matrix's entry is the mean over its two patches by projected solid angle, as `bsdf2klems` has it
by random samples: each leaf counts by its overlap with patches.
"""

import re
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from daylight_numbers.glazing.angle_basis import KLEMS_FULL
from daylight_numbers.sky_cells import on_disc
from vrut_lite.numeric_types import FloatArray, IntArray

RANKS = (3, 4)
# Halvings of the square after which a tree is refused, and those of the grids of points by which
# its cells overlap patches: of rank 4, and of rank 3 with so many incident azimuths.
_MOST_LEVELS, _POINTS_4, _POINTS_3, _AZIMUTHS = 9, 10, 7, 480
_BRACES = re.compile(r"[{}]")


class Leaves(NamedTuple):
    """Leaves (N) of one size: coordinates (N, rank), in 2^level steps, and values (N,), sr^-1."""

    level: int
    cell: IntArray
    value: FloatArray


def tree_leaves(text: str, rank: int) -> list[Leaves]:
    """The leaves of a tree by their size.

    Raises:
        ValueError: the text is no tree of this rank; the message says how.
    """
    found: dict[int, tuple[list[IntArray], list[FloatArray]]] = {}
    # Open nodes: corner, in units of the node's size, and number of branches.
    corners: list[tuple[int, ...]] = []
    branches: list[int] = []
    begin, roots = 0, 0
    for brace in _BRACES.finditer(text):
        between = text[begin : brace.start()].replace(",", " ")
        begin = brace.end()
        if brace.group() == "{":
            if between.strip():
                raise ValueError("a value stands beside a branch")
            if not corners:
                corners.append((0,) * rank)
                roots += 1
            else:
                number = branches[-1]
                if number >= 1 << rank:
                    raise ValueError(f"a node has more than {1 << rank} branches")
                branches[-1] += 1
                corner = corners[-1]
                corners.append(tuple(2 * c + (number >> i & 1) for i, c in enumerate(corner)))
            branches.append(0)
            continue
        if not corners:
            raise ValueError("a brace closes that none has opened")
        corner, count = corners.pop(), branches.pop()
        if count:
            if count != 1 << rank or between.strip():
                raise ValueError(f"a node has {count} branches in place of {1 << rank}")
            continue
        values = np.array(between.split(), float)
        halvings = _halvings(len(values), rank)
        level = len(corners) + halvings
        if level > _MOST_LEVELS:
            raise ValueError(f"it is finer than {1 << _MOST_LEVELS} cells along an edge")
        cells, all_values = found.setdefault(level, ([], []))
        inner = np.indices((1 << halvings,) * rank).reshape(rank, -1).T
        cells.append(np.array(corner) * (1 << halvings) + inner)
        all_values.append(values)
    if corners or roots != 1 or text[begin:].strip():
        raise ValueError("its braces do not close one tree")
    leaves = [
        Leaves(level, np.concatenate(cells), np.concatenate(values))
        for level, (cells, values) in found.items()
    ]
    if not all(np.isfinite(each.value).all() for each in leaves):
        raise ValueError("it has values that are not finite")
    # Rounding and fits leave small negative values, which Radiance takes for 0 too.
    return [each._replace(value=np.maximum(each.value, 0.0)) for each in leaves]


def klems_of_leaves(leaves: list[Leaves], rank: int) -> FloatArray:
    """Transmission or reflection (145, 145), sr^-1, of Klems's full basis: exiting patches are
    rows, incident ones columns."""
    return _of_rank_3(leaves) if rank == 3 else _of_rank_4(leaves)


def _halvings(count: int, rank: int) -> int:
    halvings = max(count.bit_length() - 1, 0) // rank
    if count != 1 << (rank * halvings):
        raise ValueError(f"a leaf has {count} values, which is no cube of a power of 2")
    return halvings


def _of_rank_4(leaves: list[Leaves]) -> FloatArray:
    found = np.zeros((len(KLEMS_FULL), len(KLEMS_FULL)))
    for level, cell, value in leaves:
        edge = 1 << level
        incident, exiting = cell[:, 0] * edge + cell[:, 1], cell[:, 2] * edge + cell[:, 3]
        values = csr_matrix((value, (exiting, incident)), (edge * edge, edge * edge))
        overlap = _overlaps(level)
        # A mean over each incident patch, and the light that goes into each exiting one.
        found += (overlap @ values @ overlap.T).toarray() / overlap.sum(axis=1).A1
    return np.asarray(found * (np.pi / KLEMS_FULL.projected_sr)[:, None])


@lru_cache(maxsize=_MOST_LEVELS + 1)
def _overlaps(level: int) -> csr_matrix:
    """Share (145, 4^level) of the square that each patch has in common with each cell."""
    points = 1 << _POINTS_4
    patch = KLEMS_FULL.patch_of(_square_directions(points))
    row, column = np.indices(patch.shape) >> (_POINTS_4 - level)
    cell = (row << level) + column
    shape = (len(KLEMS_FULL), 1 << 2 * level)
    share = np.full(patch.size, 1.0 / points**2)
    return csr_matrix((share, (patch.ravel(), cell.ravel())), shape)


def _of_rank_3(leaves: list[Leaves]) -> FloatArray:
    rings = len(KLEMS_FULL.count)
    points = 1 << _POINTS_3
    image = np.zeros((rings, points, points))
    for level, cell, value in leaves:
        weight = _ring_shares(level)[:, cell[:, 0]] * value
        edge = 1 << level
        grid = np.zeros((rings, edge * edge))
        number = cell[:, 1] * edge + cell[:, 2]
        for ring in range(rings):
            grid[ring] = np.bincount(number, weight[ring], edge * edge)
        on_square = grid.reshape(rings, edge, edge)
        if level <= _POINTS_3:
            repeat = points // edge
            image += np.repeat(np.repeat(on_square, repeat, axis=1), repeat, axis=2)
        else:
            parts = edge // points
            image += on_square.reshape(rings, points, parts, points, parts).mean(axis=(2, 4))
    count, first = np.array(KLEMS_FULL.count), np.cumsum([0, *KLEMS_FULL.count])
    found = np.zeros((len(KLEMS_FULL), len(KLEMS_FULL)))
    number_of = np.zeros(len(KLEMS_FULL))
    of_ring = image.reshape(rings, -1)
    for n in range(_AZIMUTHS):
        azimuth = 2.0 * np.pi * (n + 0.5) / _AZIMUTHS
        x, y, z = np.moveaxis(_square_directions(points, n).reshape(-1, 3), -1, 0)
        turned = np.stack(
            [
                x * np.cos(azimuth) - y * np.sin(azimuth),
                x * np.sin(azimuth) + y * np.cos(azimuth),
                z,
            ],
            axis=1,
        )
        patch = KLEMS_FULL.patch_of(turned)
        own = np.floor(azimuth / (2.0 * np.pi) * count + 0.5).astype(np.int64) % count
        for ring, column in enumerate(first[:-1] + own):
            found[:, column] += np.bincount(patch, of_ring[ring], len(KLEMS_FULL))
            number_of[column] += 1.0
    weight = np.pi / KLEMS_FULL.projected_sr / points**2
    return np.asarray(found * weight[:, None] / number_of)


def _ring_shares(level: int) -> FloatArray:
    """Share (rings, 2^level) of each ring's projected solid angle in a tree's incident cells; none
    in the half that holds no direction."""
    edges = 1.0 - 2.0 * np.arange((1 << level) + 1) / (1 << level)
    upper = np.maximum(edges[:-1], 0.0) ** 2
    lower = np.maximum(edges[1:], 0.0) ** 2
    ring = np.sin(np.radians([0.0, *KLEMS_FULL.upper_deg])) ** 2
    common = np.minimum(upper, ring[1:, None]) - np.maximum(lower, ring[:-1, None])
    return np.asarray(np.maximum(common, 0.0) / np.diff(ring)[:, None])


def _square_directions(points: int, key: int = 0) -> FloatArray:
    """Unit vectors (points, points, 3), a random one in each cell of the square: the edges of rings
    are squares there, which a lattice of middles would count by whole rows."""
    random = np.random.Generator(np.random.Philox(key=key))
    at = (np.indices((points, points)) + random.random((2, points, points))) * (2.0 / points) - 1.0
    x, y = on_disc(*at)
    return np.stack([x, y, np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))], axis=-1)
