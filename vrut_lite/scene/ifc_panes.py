"""Finds panes in the triangles of a window whose file names no glass."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

# A pane: largest thickness (m) and share of its shorter side, least share of its box that it fills.
_THICK_M, _THIN, _FILLED = 0.1, 0.25, 0.9
_WELDED_M = 1e-5


def are_closed(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> bool:
    """Whether each edge has as many triangles on one side as on the other: bodies, no sheets."""
    _, welded = np.unique(np.round(vertices / _WELDED_M), axis=0, return_inverse=True)
    faces = welded.reshape(-1)[triangles]
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    forward = edges[:, 0] < edges[:, 1]
    edges = np.sort(edges, axis=1)
    edges, sign = (
        edges[edges[:, 0] != edges[:, 1]],
        np.where(forward, 1, -1)[edges[:, 0] != edges[:, 1]],
    )
    if not len(edges):
        return False
    _, which = np.unique(edges, axis=0, return_inverse=True)
    return not np.bincount(which.reshape(-1), sign).any()


def pane_triangles(
    vertices: NDArray[np.float64], triangles: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Which triangles (F,) belong to panes: thin plates that fill their box, or flat sheets.

    Plates lie along the axes of the window. A frame fills little of its box.
    """
    _, welded = np.unique(np.round(vertices / _WELDED_M), axis=0, return_inverse=True)
    faces = welded.reshape(-1)[triangles]
    count = int(faces.max(initial=-1)) + 1
    links = coo_matrix(
        (np.ones(2 * len(faces)), (faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel())),
        shape=(count, count),
    )
    _, body_of_vertex = connected_components(links, directed=False)
    body = body_of_vertex[faces[:, 0]]
    is_pane = np.zeros(len(triangles), bool)
    for number in np.unique(body):
        here = body == number
        a, b, c = np.moveaxis(vertices[triangles[here]], 1, 0)
        corners = np.concatenate([a, b, c])
        thick, short, long = np.sort(np.ptp(corners, axis=0))
        if thick > min(_THICK_M, _THIN * short):
            continue
        # One face is half the surface of a closed plate.
        area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
        sides = 1 if not are_closed(vertices, triangles[here]) else 2
        rims = 0.0 if sides == 1 else thick * (short + long)
        is_pane[here] = area / sides - rims >= _FILLED * short * long
    return is_pane
