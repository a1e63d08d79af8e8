"""Guesses the vertical axis and the unit of a file that names neither, such as OBJ.

Both are guesses from the shape of the meshes; they are reported as import warnings and can be set.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.placement import UpAxis
from vrut_lite.scene.placed import PlacedMesh, box_of

# Height above the lowest point, as a share of the extent, of faces that count as the scene's base.
_BOTTOM = 0.03
_LEVEL_COSINE = 0.95
# Least share of the footprint that a floor covers; largest share of a wall across the other axis.
_FLOOR, _NO_FLOOR = 0.5, 0.1
_FLAT = 0.03
# Land is a sheet: largest height over width, least share of its footprint, least share of its area
# that faces one way.
_LOW, _LAND, _ONE_WAY = 0.5, 0.8, 0.98
_SAMPLED_FACES = 20_000
# Limits that no terrain or town exceeds together: height in m (the tallest building has 830),
# height over the width of the objects on the ground, and height over the ground's width.
_TOO_HIGH, _STEEP, _WIDE = 250.0, 0.2, 0.1
_CENTIMETRES_HIGH = 5000.0


def guess_up(placed: list[PlacedMesh]) -> UpAxis:
    """The axis along which the scene stands on something: +Y unless only +Z has a floor.

    A floor is made of faces across the axis at its lower end that cover half of the footprint, or
    of land without an underside. What is flat along Z, as a wall is, says nothing.
    """
    lower, extent = _bounds(placed)
    if extent[2] <= _FLAT * max(extent):
        return "y"
    floors = _floor_shares(placed, lower, extent)
    lies = floors[1] <= _NO_FLOOR and (floors[2] >= _FLOOR or _is_land(placed, extent))
    return "z" if lies else "y"


def _is_land(placed: list[PlacedMesh], extent: NDArray[np.float64]) -> bool:
    """Whether it is one low sheet over the plane of x and y, all of it facing the same way."""
    areas = []
    with np.errstate(over="ignore", invalid="ignore"):
        for place in placed:
            every = len(place.mesh.faces) // _SAMPLED_FACES + 1
            a, b, c = (place.mesh.vertices[corner] for corner in place.mesh.faces[::every].T)
            (bx, by), (cx, cy) = (b - a).T[:2], (c - a).T[:2]
            areas.append((bx * cy - by * cx) * every / 2)
        across = np.concatenate(areas)
        faces_up, covered = abs(across.sum()), np.abs(across).sum()
    is_low = extent[2] <= _LOW * min(extent[:2])
    return bool(is_low and faces_up >= max(_ONE_WAY * covered, _LAND * extent[0] * extent[1]))


def _bounds(placed: list[PlacedMesh]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The lowest corner (3,) and the extent (3,)."""
    lows, highs = zip(*(box_of(p.mesh.vertices) for p in placed), strict=True)
    lower = np.min(lows, axis=0)
    return lower, np.max(highs, axis=0) - lower


def _floor_shares(
    placed: list[PlacedMesh], lower: NDArray[np.float64], extent: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The shares (3,) of the footprint across x, y and z that faces cover at its lower end."""
    areas = np.zeros(3)
    for place in placed:
        vertices, faces = place.mesh.vertices, place.mesh.faces
        low = vertices <= lower + _BOTTOM * extent
        for axis in range(3):
            is_low = low[:, axis]
            bottom = faces[is_low[faces[:, 0]] & is_low[faces[:, 1]] & is_low[faces[:, 2]]]
            a, b, c = (vertices[bottom[:, corner]] for corner in range(3))
            across = np.cross(b - a, c - a) / 2
            level = np.abs(across[:, axis]) >= _LEVEL_COSINE * np.linalg.norm(across, axis=1)
            areas[axis] += np.abs(across[level, axis]).sum()
    footprints = np.maximum(extent[[1, 2, 0]] * extent[[2, 0, 1]], np.finfo(float).tiny)
    return areas / footprints


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
