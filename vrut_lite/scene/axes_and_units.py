"""Guesses the vertical axis and the unit of a file that names neither, such as OBJ.

Both are guesses from the shape of the meshes; they are reported as import warnings and can be set.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.placement import UpAxis
from vrut_lite.scene.placed import MAX_TRIANGLES, PlacedMesh, box_of

# Height above the lowest point, as a share of the extent, of faces that count as the scene's base.
_BOTTOM = 0.03
_LEVEL_COSINE = 0.95
# Least share of the footprint that the largest level area covers, least ratio of it to that across
# the other axis, and largest share of the footprint at that axis's lower end: a skirt's side.
_FLOOR, _LARGER, _NO_FLOOR = 0.5, 2.0, 0.25
# Layers of the extent in which level areas are summed.
_LAYERS = 32
_FLAT = 0.03
# Least height (file units) of a sheet that may be land standing on edge.
_STOREY = 3.0
# Land is a sheet: largest height over width, least share of its footprint, least share of its area
# that faces one way.
_LOW, _LAND, _ONE_WAY = 0.5, 0.8, 0.98
# Largest depth of a board for an exhibition, as a share of its shorter side; the lowest houses of
# one storey have more.
_BOARD = 0.12
_SAMPLED_FACES = 20_000
# Limits that no terrain or town exceeds together: height in m (the tallest building has 830),
# height over the width of the objects on the ground, and height over the ground's width.
_TOO_HIGH, _STEEP, _WIDE = 250.0, 0.2, 0.1
_CENTIMETRES_HIGH = 5000.0


def guess_up(placed: list[PlacedMesh]) -> UpAxis:
    """The axis along which the scene stands on something: +Y unless only +Z has a floor.

    A floor is the largest level area of the lower half, which lies higher than the lowest point
    where land has a skirt, or land without an underside. What is flat along Z says nothing.
    """
    lower, extent = _bounds(placed)
    if extent[2] <= _FLAT * max(extent):
        return "y"
    areas, lowest = _level_areas(placed, lower, extent)
    if lowest[0] > _NO_FLOOR * extent[2] * extent[0]:
        return "y"
    has_floor = areas[1] >= max(_FLOOR * extent[0] * extent[1], _LARGER * areas[0])
    return "z" if (has_floor and areas[1] > 0.0) or _is_land(placed, extent) else "y"


def has_floor_across_y(placed: list[PlacedMesh]) -> bool:
    """Whether the largest level area is across Y, as of a file that wrongly states +Z."""
    lower, extent = _bounds(placed)
    areas, _ = _level_areas(placed, lower, extent)
    return bool(areas[0] >= max(_FLOOR * extent[0] * extent[2], _LARGER * areas[1]) > 0.0)


def stands_on_edge(placed: list[PlacedMesh]) -> bool:
    """Whether the scene is flat along Z: a wall, or land of a program whose axis is Z.

    A sheet lower than a storey is taken to be a panel.
    """
    _, extent = _bounds(placed)
    return bool(extent[2] <= _FLAT * max(extent) and extent[1] >= _STOREY)


def is_board(placed: list[PlacedMesh]) -> bool:
    """Whether it is thin along Z and no land: a board that shows things, rather than a house."""
    _, extent = _bounds(placed)
    return bool(extent[2] < _BOARD * min(extent[:2]) and not _is_land(placed, extent))


def _is_land(placed: list[PlacedMesh], extent: NDArray[np.float64]) -> bool:
    """Whether it is one low sheet over the plane of x and y, all of it facing the same way."""
    across = np.concatenate([_normals(place, _SAMPLED_FACES)[1][:, 2] for place in placed])
    faces_up, covered = abs(across.sum()), np.abs(across).sum()
    is_low = extent[2] <= _LOW * min(extent[:2])
    return bool(is_low and faces_up >= max(_ONE_WAY * covered, _LAND * extent[0] * extent[1]))


def _bounds(placed: list[PlacedMesh]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The lowest corner (3,) and the extent (3,)."""
    lows, highs = zip(*(box_of(_points(place)) for place in placed), strict=True)
    lower = np.min(lows, axis=0)
    return lower, np.max(highs, axis=0) - lower


def _points(place: PlacedMesh) -> NDArray[np.float64]:
    """Vertices (V, 3) in the file's axes."""
    with np.errstate(over="ignore", invalid="ignore"):
        matrix = place.world_from_model
        return np.asarray(place.mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3])


def _normals(
    place: PlacedMesh, most: int = MAX_TRIANGLES
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centres and area vectors (n, 3) of at most about `most` faces, which stand for all."""
    every = len(place.mesh.faces) // most + 1
    points = _points(place)
    with np.errstate(over="ignore", invalid="ignore"):
        a, b, c = (points[corner] for corner in place.mesh.faces[::every].T)
        return (a + b + c) / 3, np.cross(b - a, c - a) * (every / 2)


def _level_areas(
    placed: list[PlacedMesh], lower: NDArray[np.float64], extent: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Areas (2,) of level faces across y and z: the largest of the lower half, and the lowest.

    Those of one height that face the same way are summed.
    """
    layers, lowest = np.zeros((2, 2, _LAYERS + 1)), np.zeros(2)
    scale = np.maximum(extent, np.finfo(float).tiny)
    for place in placed:
        centres, areas = _normals(place)
        size = np.linalg.norm(areas, axis=1)
        for row, axis in enumerate((1, 2)):
            across = areas[:, axis]
            level = np.flatnonzero(np.abs(across) >= _LEVEL_COSINE * size)
            height = (centres[level, axis] - lower[axis]) / scale[axis]
            across = across[level]
            layer = np.clip(np.nan_to_num(height) * _LAYERS, 0, _LAYERS - 1).astype(np.int64)
            for side, facing in enumerate((across > 0.0, across < 0.0)):
                layers[row, side] += np.bincount(
                    layer[facing], np.abs(across[facing]), minlength=_LAYERS + 1
                )
            lowest[row] += np.abs(across[height <= _BOTTOM]).sum()
    # A height may lie on the border of two layers.
    pairs = (layers[..., 1:] + layers[..., :-1])[..., : _LAYERS // 2]
    return pairs.max(axis=(1, 2)), lowest


def guess_metres_per_unit(
    extent: NDArray[np.float64], standing: NDArray[np.float64] | None = None
) -> float:
    """The unit's length by the extent (3,) in units, +Y up: metres, centimetres or millimetres.

    `standing` (3,) is the extent of the objects above a ground, where known.
    """
    height, width = extent[1], max(extent[0], extent[2])
    stands = width if standing is None else max(standing[0], standing[2])
    if height <= _TOO_HIGH or height <= _STEEP * stands or height <= _WIDE * width:
        return 1.0
    return 0.01 if height <= _CENTIMETRES_HIGH else 0.001


def ground_top(lower: NDArray[np.float64], upper: NDArray[np.float64]) -> float:
    """The height below which a scene's parts may be its ground, +Y up."""
    return float(lower[1] + _BOTTOM * (upper[1] - lower[1]))
