"""Objects that show the terrain's scale: spruces around the viewpoint, and a hut on its meadow."""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.noise import uniform_hash
from vrut_lite_lab.scenes.shapes import PlainMesh, box, joined, polygon
from vrut_lite_lab.scenes.terrain_surface import FOREST, forest_share, height_m, slope

HUT_X_M, HUT_Z_M = -172.0, 30.0
_REACH_M, _SPACING_M = 960.0, 17.0
_MOST = 1300
_SIDES = np.array([(0.0, 1.0), (0.951, 0.309), (0.588, -0.809), (-0.588, -0.809), (-0.951, 0.309)])
_UNIT_M = 0.03125


def place_reference_objects(writer: GltfWriter) -> None:
    """Put hut and trees into the scene."""
    _place_trees(writer)
    timber = writer.material("timber", (0.11, 0.07, 0.045))
    stone = writer.material("stone", (0.22, 0.21, 0.195))
    slate = writer.material("slate", (0.13, 0.13, 0.135), roughness=0.7)
    parts = [
        (box((-4.5, -2.5, -3.2), (4.5, 0.7, 3.2)), stone),
        (_walls(), timber),
        (_roof(), slate),
    ]
    ground_m = round(float(height_m(HUT_X_M, HUT_Z_M)), 3)
    place = (HUT_X_M, ground_m, HUT_Z_M)
    writer.place("hut", writer.mesh("hut", parts), place, azimuth_deg=28.0)


def tree_places() -> FloatArray:
    """Feet and heights (n, 4): x, y, z and the tree's height; nearest first."""
    count = int(_REACH_M / _SPACING_M)
    column, row = (axis.ravel() for axis in np.meshgrid(*[np.arange(-count, count + 1)] * 2))
    x = (column + 0.9 * uniform_hash(column, row, 201) - 0.45) * _SPACING_M
    z = (row + 0.9 * uniform_hash(column, row, 203) - 0.45) * _SPACING_M
    rise = slope(x, z, np.full_like(x, 8.0))
    share = forest_share(x, z, np.sqrt(np.sum(rise * rise, axis=-1)))
    away_m = np.sqrt(x * x + z * z)
    # A few stand alone on the meadows; none before the view.
    alone = uniform_hash(column, row, 205) < np.where(x < 0.0, 0.9 * share + 0.02, 0.4 * share)
    stands = (
        alone
        & (away_m > 38.0)
        & (away_m < _REACH_M)
        & (np.abs(x - HUT_X_M) + np.abs(z - HUT_Z_M) > 26.0)
    )
    stands &= ~((x < 0.0) & (x > -420.0) & (np.abs(z) < 0.3 * np.abs(x)))
    tall_m = 9.0 + 12.0 * uniform_hash(column, row, 207)
    chosen = np.flatnonzero(stands)
    chosen = chosen[np.argsort(away_m[chosen], kind="stable")][:_MOST]
    x, z = x[chosen], z[chosen]
    return np.stack([x, height_m(x, z) - 0.6, z, tall_m[chosen]], axis=-1)


def _place_trees(writer: GltfWriter) -> None:
    """All as one mesh: of each three cones of five sides, one above the other."""
    foot, tall_m = np.split(tree_places(), [3], axis=1)
    tree, normals, sides = _spruce()
    positions = (foot[:, None] + tall_m[:, None] * tree).reshape(-1, 3)
    faces = (len(tree) * np.arange(len(foot))[:, None, None] + sides).reshape(-1, 3)
    tone = 0.8 + 0.7 * uniform_hash(np.arange(len(foot)), np.zeros(len(foot)), 209)
    colours = np.repeat(np.asarray(FOREST) * tone[:, None], len(tree), axis=0)
    corner = np.floor(positions.min(axis=0))
    counts = np.round((positions - corner) / _UNIT_M)
    needles = writer.material("needles", (1.0, 1.0, 1.0))
    shape = PlainMesh(counts, np.tile(normals, (len(foot), 1)), np.zeros((0, 2)), faces)
    mesh = writer.painted_mesh("spruces", shape, colours, needles)
    at = (float(corner[0]), float(corner[1]), float(corner[2]))
    writer.place("spruces", mesh, at, (_UNIT_M,) * 3)


def _spruce() -> tuple[FloatArray, FloatArray, NDArray[np.int64]]:
    """Positions (18, 3) of a tree of height 1, normals, and triangles (15, 3)."""
    ring = np.stack([_SIDES[:, 0], np.zeros(5), _SIDES[:, 1]], axis=-1)
    leaning = np.concatenate([0.94 * ring + [0.0, 0.34, 0.0], [[0.0, 1.0, 0.0]]])
    cones = [
        np.concatenate([wide * ring + [0.0, low, 0.0], [[0.0, high, 0.0]]])
        for wide, low, high in ((0.19, 0.0, 0.58), (0.145, 0.28, 0.8), (0.095, 0.55, 1.0))
    ]
    sides = np.array([(i, (i + 1) % 5, 5) for i in range(5)])
    faces = np.concatenate([sides + 6 * number for number in range(3)])
    return np.concatenate(cones), np.tile(leaning, (3, 1)), faces


def _walls() -> PlainMesh:
    low, eaves, ridge, x, z = 0.7, 3.0, 5.2, 4.4, 3.1
    gables = [
        polygon([(x, low, z), (x, low, -z), (x, eaves, -z), (x, ridge, 0.0), (x, eaves, z)]),
        polygon([(-x, low, -z), (-x, low, z), (-x, eaves, z), (-x, ridge, 0.0), (-x, eaves, -z)]),
    ]
    sides = [
        polygon([(-x, low, z), (x, low, z), (x, eaves, z), (-x, eaves, z)]),
        polygon([(x, low, -z), (-x, low, -z), (-x, eaves, -z), (x, eaves, -z)]),
    ]
    return joined([*gables, *sides])


def _roof() -> PlainMesh:
    x, z, eaves, ridge = 5.2, 4.0, 2.55, 5.4
    slopes = []
    for side in (1.0, -1.0):
        upper = [
            (-side * x, eaves, side * z),
            (side * x, eaves, side * z),
            (side * x, ridge, 0.0),
            (-side * x, ridge, 0.0),
        ]
        slopes += [polygon(upper), polygon([(px, py - 0.15, pz) for px, py, pz in upper[::-1]])]
    return joined(slopes)
