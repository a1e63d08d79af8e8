"""Patches: up to 6 x 6 texels of one part that face one way, on which bounces are counted.

A patch is connected: texels on two sides of a body on a floor are never one, so that a wall of
two texels lets no light through.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import kernel
from light_transport.rays.map_texels import NOBODY, edges_of
from light_transport.rays.ray_starts import Receivers
from light_transport.rays.row_numbers import row_numbers
from light_transport.rays.sky_nodes import NODES
from light_transport.surfaces.surfaces import GROUND, Surfaces
from vrut_lite.numeric_types import BoolArray, Float32Array, FloatArray, IntArray


class Patches(NamedTuple):
    """Patches (M) of rows.

    Attributes:
        column_of: (NODES + rows,) int32, the table's column for a node, and for a row its patch's;
            buried texels have a neighbour's. Column NODES + M is of rows that send no light.
        start: (M + 1,) int64, where each patch's rows begin in `member`.
        member: (K,) int32, rows; weight: (K,) float32, their share of the patch's area.
        area: (M,) float32, in squares of the scene's radius.
        reflectance_rgb, emitted_rgb: (M, 3) float32; on_ground: (M,) bool.
    """

    column_of: NDArray[np.int32]
    start: IntArray
    member: NDArray[np.int32]
    weight: Float32Array
    area: Float32Array
    reflectance_rgb: Float32Array
    emitted_rgb: Float32Array
    on_ground: BoolArray


def patches_of(
    surfaces: Surfaces,
    receivers: Receivers,
    links: NDArray[np.int32],
    beside: NDArray[np.int32],
    seams: NDArray[np.int32],
    good: BoolArray,
    texels_an_edge: float,
) -> Patches:
    """Patches of the rows that are good (N,), by links (N, 4) and seams (K, 2), see `links`.

    Others have the patch of the nearest good one that is linked, or else of one `beside` (N, 4),
    whatever stands between.
    """
    texels, groups = receivers.texels, receivers.groups
    count, probes = len(texels.pixel), len(receivers.probes.place)
    key = _keys(surfaces, receivers, texels_an_edge)
    label = np.asarray(_connected(links, seams, key, good[:count]))
    _, patch = np.unique(label[good[:count]], return_inverse=True)
    patches = int(patch.max(initial=-1)) + 1
    of_row = np.full(len(good), NOBODY, np.int32)
    of_row[np.flatnonzero(good[:count])] = patch
    of_row[count + probes :] = patches + np.arange(len(groups.area))
    total = patches + len(groups.area)
    member = np.flatnonzero(of_row >= 0).astype(np.int32)
    member = member[np.argsort(of_row[member], kind="stable")]
    start = np.searchsorted(of_row[member], np.arange(total + 1)).astype(np.int64)
    row_area = np.concatenate([texels.area, np.zeros(probes), groups.area]).astype(np.float64)
    member_area = np.maximum(row_area[member], 1e-12)
    area = np.bincount(of_row[member], member_area, total)
    weight = member_area / area[of_row[member]]
    reflectance, emitted, on_ground = _of_rows(surfaces, receivers)

    def mean(values: Float32Array) -> Float32Array:
        sums = [
            np.bincount(of_row[member], weight * values[member, channel], total)
            for channel in range(3)
        ]
        return np.stack(sums, axis=1).astype(np.float32)

    ground = np.zeros(total, bool)
    ground[of_row[member]] = on_ground[member]
    return Patches(
        _columns(of_row, links, beside, count, total),
        start,
        member,
        weight.astype(np.float32),
        area.astype(np.float32),
        mean(reflectance),
        mean(emitted),
        ground,
    )


def _keys(surfaces: Surfaces, receivers: Receivers, texels_an_edge: float) -> NDArray[np.int64]:
    """Equal numbers (N,) for texels of one part, facing and box of space."""
    texels = receivers.texels
    # Boxes grow by whole octaves, so that neighbours' boxes are the same or nested.
    edge = texels_an_edge * np.exp2(np.round(np.log2(np.maximum(texels.width, 1e-9))))
    cell = np.floor(texels.place / edge[:, None]).astype(np.int64)
    axis = np.argmax(np.abs(texels.normal), axis=1)
    positive = np.take_along_axis(texels.normal, axis[:, None], axis=1)[:, 0] > 0.0
    octave = np.round(np.log2(edge / texels_an_edge)).astype(np.int64)
    parts = surfaces.part[texels.triangle].astype(np.int64)
    return row_numbers(np.column_stack([parts, 2 * axis + positive, octave, cell]))[0]


@kernel
def _connected(links, seams, key, good):  # type: ignore[no-untyped-def]
    """The first texel (N,) of those that are linked and share a key."""
    count = len(key)
    label = np.arange(count)
    neighbours = links.shape[1]
    for n in range(count * neighbours + len(seams)):
        if n < count * neighbours:
            i, j = n // neighbours, links[n // neighbours, n % neighbours]
        else:
            i, j = seams[n - count * neighbours, 0], seams[n - count * neighbours, 1]
        if j >= 0 and key[j] == key[i] and good[i] and good[j]:
            a, b = i, j
            while label[a] != a:
                label[a] = label[label[a]]
                a = label[a]
            while label[b] != b:
                label[b] = label[label[b]]
                b = label[b]
            label[max(a, b)] = min(a, b)
    for i in range(count):
        a = i
        while label[a] != a:
            a = label[a]
        label[i] = a
    return label


def _columns(
    of_row: NDArray[np.int32],
    links: NDArray[np.int32],
    beside: NDArray[np.int32],
    count: int,
    patches: int,
) -> NDArray[np.int32]:
    """The table's column for each node and row."""
    patch = of_row.copy()
    patch[:count] = _spread(_spread(patch[:count], links), beside)
    # Texels among buried texels alone, and probes, send no light: the column after the last patch.
    columns = NODES + np.where(patch >= 0, patch, patches)
    return np.concatenate([np.arange(NODES), columns]).astype(np.int32)


@kernel
def _spread(patch, links):  # type: ignore[no-untyped-def]
    """Give texels without a patch that of a linked one, ring by ring."""
    patch = patch.copy()
    queue = np.empty(len(patch), np.int64)
    head, tail = 0, 0
    for i in range(len(patch)):
        if patch[i] >= 0:
            queue[tail] = i
            tail += 1
    while head < tail:
        i = queue[head]
        head += 1
        for k in range(links.shape[1]):
            j = links[i, k]
            if j >= 0 and patch[j] < 0:
                patch[j] = patch[i]
                queue[tail] = j
                tail += 1
    return patch


def _of_rows(
    surfaces: Surfaces, receivers: Receivers
) -> tuple[Float32Array, Float32Array, BoolArray]:
    """Reflectance and emission (N, 3) of each row, and which are ground (N,)."""
    texels, groups = receivers.texels, receivers.groups
    probes = np.zeros((len(receivers.probes.place), 3))
    group_of = np.repeat(np.arange(len(groups.area)), np.diff(groups.start))
    _, b, c = edges_of(receivers.geometry, groups.triangle)
    area = np.linalg.norm(np.cross(b, c), axis=1) + 1e-30

    def joined(values: Float32Array) -> Float32Array:
        of_groups = np.empty((len(groups.area), 3))
        total = np.bincount(group_of, area, len(groups.area))
        for channel in range(3):
            summed = np.bincount(
                group_of, area * values[groups.triangle, channel], len(groups.area)
            )
            of_groups[:, channel] = summed / total
        rows: FloatArray = np.concatenate([values[texels.triangle], probes, of_groups])
        return rows.astype(np.float32)

    ground = np.zeros(len(texels.pixel) + len(probes) + len(groups.area), bool)
    ground[: len(texels.pixel)] = surfaces.part[texels.triangle] == GROUND
    return joined(surfaces.reflectance_rgb), joined(surfaces.emitted_rgb), ground
