"""Which texels lie beside each other on a surface."""

from typing import cast

import numpy as np
from numpy.typing import NDArray

from light_transport.kernels import dot, kernel
from light_transport.surfaces.map_texels import NOBODY, Texels

# Neighbours in the map whose places are farther apart than so many texels are on other charts.
_NEAR = 2.5


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
