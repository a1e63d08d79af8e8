"""Where the rays of each row end, as counts that rounds of rays add to.

The first rays of a texel decide how many it gets in all. At creases, where the harmonic mean
distance of surfaces in view is short, light varies between neighbouring texels: little of their
noise can be smoothed. If they see little sky too, they get three times as many rays as others;
texels inside bodies, few of whose rays count, get no more. Any number of rounds gives the same
rays.

A row's entries are a column and a count in one number. Columns are nodes of the sky and of open
ground, then the rows that rays met, later replaced by patches.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import dot, hot, inlined, kernel
from light_transport.rays.groups import NO_GROUP
from light_transport.rays.map_texels import NOBODY, Texels, cell_at, ground_at
from light_transport.rays.ray_starts import Receivers, aim, begin, scratch, shift
from light_transport.rays.sky_nodes import NODES, node_of
from light_transport.rays.trace import MISS, mixed, nearest_along
from light_transport.rays.tree import Tree
from vrut_lite.numeric_types import Float32Array, IntArray

_DROPPED, _BACK = -1, -2
# So many first rays of a row may begin inside a body before the row is held to have no free one.
TRIED = 8
# Number of first rays that tell how many more a texel gets.
_TELLING = 16
# Harmonic mean distance, in texels, below which a texel is at a crease, the share of its rays below
# which it sees little sky, and what the number of its rays is multiplied by where both hold.
_CREASE_TEXELS, _LITTLE_SKY, _AT_CREASES = 8.0, 0.125, 3
# Share of the first rays that must count for more to be traced: half of them must in the end.
_LEAST_COUNTED = 0.25
# So many bits of an entry, of 16 or 32, are its column; those above are its rays less one.
SMALL_BITS, LARGE_BITS = 14, 24


class RayRows(NamedTuple):
    """Entries of rows `first` and following.

    Attributes:
        first: number of the first row.
        start: (R + 1,) int64, where each row's entries begin.
        entry: (E,) uint16 or int32, see `columns_and_rays`; a column with more rays than an
            entry can hold has several. A row's nodes come before all else.
        nodes: (R,) uint16, how many of each row's entries are of nodes.
        traced: (R,) int32, rays that began.
        valid: (R,) int32, rays that count: those that did not begin inside a body.
        nearness: (R,) float32, sum of 1 / distance over rays that met something, in 1 / radius.
        free: (R,) uint8, the first ray that counts, or TRIED.
    """

    first: int
    start: IntArray
    entry: NDArray[np.uint16] | NDArray[np.int32]
    nodes: NDArray[np.uint16]
    traced: NDArray[np.int32]
    valid: NDArray[np.int32]
    nearness: Float32Array
    free: NDArray[np.uint8]


def empty_rows(first: int, number: int) -> RayRows:
    """Rows without rays."""
    return RayRows(
        first,
        np.zeros(number + 1, np.int64),
        np.empty(0, np.int32),
        np.zeros(number, np.uint16),
        np.zeros(number, np.int32),
        np.zeros(number, np.int32),
        np.zeros(number, np.float32),
        np.full(number, TRIED, np.uint8),
    )


def slice_of(rows: RayRows, first: int, last: int) -> RayRows:
    """Some of the rows, counted from the first."""
    here = slice(int(rows.start[first]), int(rows.start[last]))
    return RayRows(
        rows.first + first,
        rows.start[first : last + 1] - rows.start[first],
        rows.entry[here],
        rows.nodes[first:last],
        rows.traced[first:last],
        rows.valid[first:last],
        rows.nearness[first:last],
        rows.free[first:last],
    )


def joined(blocks: list[RayRows]) -> RayRows:
    """Rows of several blocks that follow each other."""
    sizes = [len(block.entry) for block in blocks]
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    starts = [block.start[:-1] + offset for block, offset in zip(blocks, offsets, strict=False)]
    return RayRows(
        blocks[0].first,
        np.concatenate([*starts, offsets[-1:]]),
        np.concatenate([block.entry for block in blocks]),
        np.concatenate([block.nodes for block in blocks]),
        np.concatenate([block.traced for block in blocks]),
        np.concatenate([block.valid for block in blocks]),
        np.concatenate([block.nearness for block in blocks]),
        np.concatenate([block.free for block in blocks]),
    )


def with_rays(
    tree: Tree,
    receivers: Receivers,
    rows: RayRows,
    column_of: NDArray[np.int32],
    first: int,
    count: int,
    backs: int = _DROPPED,
) -> RayRows:
    """These rows with rays `first` to `first + count` added, and those that creases have besides.

    `column_of` (NODES + row count,): the column for the node or row that a ray met; `backs`: the
    node or row that stands for backs of bodies, where rays that meet them are not dropped.
    """
    last = first + count
    texels = receivers.texels
    own = slice(0, max(len(texels.pixel) - rows.first, 0))

    def added(begin: NDArray[np.int32], end: NDArray[np.int32]) -> RayRows:
        targets = np.full((len(begin), int((end - begin).max(initial=0))), _DROPPED, np.int32)
        distances = np.zeros(targets.shape, np.float32)
        _trace(tree, receivers, rows.first, begin, end, scratch(), targets, distances)
        targets[targets == _BACK] = backs
        traced = rows._replace(traced=rows.traced + end - begin)
        return _with_targets(traced, begin, column_of, targets, distances)

    def all_rows(number: int) -> NDArray[np.int32]:
        return np.full(len(rows.valid), number, np.int32)

    if first < _TELLING and len(rows.valid[own]):
        told = min(_TELLING, last)
        rows = added(all_rows(first), all_rows(told))
        first = told
    begin, end = all_rows(first), all_rows(last)
    if first >= _TELLING:
        begin[own] = rows.traced[own]
        end[own] = _last_rays(slice_of(rows, 0, len(begin[own])), texels, first, last)
    return added(begin, end)


def _last_rays(rows: RayRows, texels: Texels, first: int, last: int) -> NDArray[np.int32]:
    """How many rays each of some texels (R,) has when others, that have `first`, have `last`."""
    width = texels.width[rows.first : rows.first + len(rows.valid)]
    crease, buried = rows.traced > first, rows.traced < first
    if first == _TELLING:
        buried = rows.valid <= _LEAST_COUNTED * rows.traced
        at_crease = rows.valid < np.float32(_CREASE_TEXELS) * width * rows.nearness
        crease |= at_crease & (rows.nodes < _LITTLE_SKY * rows.valid)
    return np.where(buried, rows.traced, np.where(crease, _AT_CREASES * last, last)).astype(
        np.int32
    )


def with_columns(rows: RayRows, new_column: NDArray[np.int32]) -> RayRows:
    """These rows with other columns; several may have become one."""
    column, rays = columns_and_rays(rows.entry)
    named = rows._replace(entry=new_column[column] | (rays - 1) << LARGE_BITS)
    nothing = np.empty((len(rows.valid), 0), np.int32)
    distances = np.empty(nothing.shape, np.float32)
    return _with_targets(named, rows.traced, new_column, nothing, distances)


def _with_targets(
    rows: RayRows,
    begins: NDArray[np.int32],
    column_of: NDArray[np.int32],
    targets: NDArray[np.int32],
    distances: Float32Array,
) -> RayRows:
    """These rows with new rays, in the smaller entries if those can name all columns."""
    columns = int(column_of.max(initial=0)) + 1
    is_small = columns <= 1 << SMALL_BITS
    bits = _bits_of(rows.entry), SMALL_BITS if is_small else LARGE_BITS
    # One type of entries for the kernel, which takes long to compile.
    wide = rows._replace(entry=rows.entry.astype(np.int32, copy=False))
    start, entry, *others = _counted(wide, begins, column_of, targets, distances, columns, bits)
    narrow = entry.astype(np.uint16 if is_small else np.int32)
    return RayRows(rows.first, start, narrow, *others)


def columns_and_rays(
    entry: NDArray[np.uint16] | NDArray[np.int32],
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Column of each entry (E,), and the number of rays that ended there."""
    bits = _bits_of(entry)
    wide = entry.astype(np.int32)
    return wide & ((1 << bits) - 1), (wide >> bits) + 1


def _bits_of(entry: NDArray[np.uint16] | NDArray[np.int32]) -> int:
    return SMALL_BITS if entry.itemsize == 2 else LARGE_BITS


@inlined
def column_at(entry, e):  # type: ignore[no-untyped-def]
    """The column of entry `e`."""
    bits = SMALL_BITS if entry.itemsize == 2 else LARGE_BITS
    return np.int64(entry[e]) & ((1 << bits) - 1)


@inlined
def rays_at(entry, e):  # type: ignore[no-untyped-def]
    """How many rays entry `e` stands for."""
    bits = SMALL_BITS if entry.itemsize == 2 else LARGE_BITS
    return (np.int64(entry[e]) >> bits) + 1


@hot
def _trace(tree, receivers, first_row, begins, ends, scratch, targets, distances):  # type: ignore[no-untyped-def]
    """Fill in the targets of rays (rows, most) and their distances, at least half a texel.

    Row i has those with numbers from begins[i] until ends[i] (rows,), from its first column on.
    They end at a node, at NODES + a row, at a body's _BACK, or are _DROPPED.
    """
    geometry, texels, probes, groups = receivers
    stack, far_stack, shifts, weights, place, normal, face, ray = scratch
    first_group = len(texels.pixel) + len(probes.place)
    for i in range(len(targets)):
        row = first_row + i
        shift(row, shifts)
        # Beside a wall some rays are as short as one likes: their mean would be noise.
        least = np.float32(0.0)
        if row < len(texels.pixel):
            least = np.float32(0.5) * texels.width[row]
        for s in range(ends[i] - begins[i]):
            number = begins[i] + s
            begin(
                geometry, texels, probes, groups, row, number, shifts, weights, place, normal, face
            )
            aim(number, shifts, normal, face, ray)
            distance, hit, u, v = nearest_along(
                tree, place, ray, mixed(row, number + 64), stack, far_stack
            )
            if hit == MISS:
                targets[i, s] = node_of(ray[0], ray[1], ray[2])
                continue
            distances[i, s] = max(distance, least)
            height = np.float32(0.0)
            for k in range(3):
                place[k] += distance * ray[k]
                height += distance * ray[k] * face[k]
            met = met_row(geometry, texels, groups, first_group, tree.order[hit], u, v, place, ray)
            targets[i, s] = NODES + met if met >= 0 else _DROPPED
            if dot(geometry.faces[tree.order[hit]], ray) > 0.0:
                if met < 0:
                    targets[i, s] = _BACK
                elif height < least:
                    # The back of a sheet that lies on the surface: frames and plinths without a
                    # back hide surfaces below them as bodies do.
                    targets[i, s] = _DROPPED


@inlined
def met_row(geometry, texels, groups, first_group, t, u, v, place, ray):  # type: ignore[no-untyped-def]
    """The row that a ray met, or NOBODY where it met a body's back."""
    behind = dot(geometry.faces[t], ray) > 0.0
    group = groups.back[t] if behind else groups.front[t]
    if group >= 0:
        return first_group + group
    if behind and group == NO_GROUP:
        return NOBODY
    height, width = texels.row_of.shape
    if geometry.on_ground[t]:
        x = ground_at(geometry.ground, place[0], 0)
        y = ground_at(geometry.ground, place[2], 1)
    else:
        uv, w = geometry.uv, 1.0 - u - v
        x = w * uv[t, 0, 0] + u * uv[t, 1, 0] + v * uv[t, 2, 0]
        y = w * uv[t, 0, 1] + u * uv[t, 1, 1] + v * uv[t, 2, 1]
    row = texels.row_of[min(max(int(y), 0), height - 1), min(max(int(x), 0), width - 1)]
    if row >= 0 and behind:
        row = texels.back[row]
    if row >= 0 and texels.cut[row] >= 0:
        return texels.cell_row[texels.cut[row], cell_at(texels, row, x, y)]
    return row


@kernel
def _counted(rows, begins, column_of, targets, distances, columns, bits_of):  # type: ignore[no-untyped-def]
    """Entries of rows and new rays together, whose numbers begin at `begins` (R,).

    `bits_of`: bits of a column in the entries of the rows, and in the new ones.
    """
    bits_before, bits = bits_of
    most_rays = 4 if bits == SMALL_BITS else 128
    number, count = targets.shape
    # As many entries as rays at most: one of 32 bits may become many of 16.
    most = number * count
    for i in range(number):
        most += rows.valid[i]
    start = np.zeros(number + 1, np.int64)
    entry = np.empty(most, np.int32)
    nodes = np.zeros(number, np.uint16)
    valid, nearness, free = rows.valid.copy(), rows.nearness.copy(), rows.free.copy()
    amount = np.zeros(columns, np.int32)
    touched = np.empty(columns, np.int32)
    used = 0
    for i in range(number):
        met = 0
        for e in range(rows.start[i], rows.start[i + 1]):
            c = np.int64(rows.entry[e]) & ((1 << bits_before) - 1)
            if amount[c] == 0:
                touched[met] = c
                met += 1
            amount[c] += (np.int64(rows.entry[e]) >> bits_before) + 1
        for s in range(count):
            if targets[i, s] == _DROPPED:
                continue
            if free[i] == TRIED and begins[i] + s < TRIED:
                free[i] = begins[i] + s
            c = np.int64(column_of[targets[i, s]])
            if amount[c] == 0:
                touched[met] = c
                met += 1
            amount[c] += 1
            valid[i] += 1
            if distances[i, s] > 0.0:
                nearness[i] += 1.0 / max(distances[i, s], np.float32(1e-6))
        for others in range(2):
            for k in range(met):
                c = touched[k]
                if (c >= NODES) != (others == 1):
                    continue
                left = amount[c]
                amount[c] = 0
                while left > 0:
                    entry[used] = c | (min(left, most_rays) - 1) << bits
                    left -= most_rays
                    used += 1
            if others == 0:
                nodes[i] = used - start[i]
        start[i + 1] = used
    return start, entry[:used], nodes, rows.traced, valid, nearness, free
