"""Mountains and valleys of the Alps, 41 km wide, on the round planet: `terrain.glb`.

The land falls below y = 0 as the planet does, d^2 / 2R with R = 6,360 km; at its rim it is level
with the planet's own ground and has its albedo. Triangles are as small as the view from the
origin needs, which looks west; far away and behind they miss the land by more.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.numeric_types import FloatArray, IntArray
from vrut_lite_lab.scenes.adaptive_mesh import adaptive_triangles
from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.landscape import (
    LAKE_LONG_M,
    LAKE_M,
    LAKE_WIDE_M,
    LAKE_X_M,
    LAKE_Z_M,
    NORTH_M,
    WEST_M,
    WIDTH_M,
)  # fmt: skip
from vrut_lite_lab.scenes.shapes import PlainMesh, disc, joined
from vrut_lite_lab.scenes.terrain_objects import place_reference_objects
from vrut_lite_lab.scenes.terrain_surface import albedo, curvature_m, height_m, slope
from vrut_lite_lab.scenes.textures import ground_bumps, ground_grain

_LATTICE = 32768
_STEP_M = WIDTH_M / _LATTICE
_STATION_M = 3.0
# Shares of a triangle's corners in the places at which it is compared with the land.
_PLACES = np.array([
    (0.5, 0.5, 0), (0.25, 0.25, 0.5), (0.5, 0, 0.5), (0, 0.5, 0.5), (1 / 3, 1 / 3, 1 / 3),
    (0.75, 0.25, 0), (0.25, 0.75, 0), (0.6, 0.2, 0.2), (0.2, 0.6, 0.2), (0.2, 0.2, 0.6),
])  # fmt: skip
_FINENESS = 0.78
# Positions are whole numbers of this, from a corner below all land: tiles agree at their seams.
_UNIT_M = 0.125
_ORIGIN_M = np.array([WEST_M, -256.0, NORTH_M])
_WIDEST_M = 6600.0
# The grain on the land repeats after this; two thirds is its mean.
_GRAIN_M, _GRAIN_MEAN = 256.0, 2.0 / 3.0


def build() -> dict[str, bytes]:
    """All files: names and bytes."""
    writer = GltfWriter()
    grain, bumps = ground_grain(), ground_bumps()
    land = writer.tiled_material("land", grain, bumps, _GRAIN_M / _STEP_M)
    points, faces = adaptive_triangles(_LATTICE, _too_coarse)
    x, z = world_m(points)
    positions = np.stack([x, height_m(x, z), z], axis=-1)
    slopes = slope(x, z, nearest_edge_m(positions, faces))
    normals = np.stack([-slopes[:, 0], np.ones(len(x)), -slopes[:, 1]], axis=-1)
    normals /= np.sqrt(np.sum(normals * normals, axis=1, keepdims=True))
    colours = np.minimum(albedo(x, z, slopes) / _GRAIN_MEAN, 1.0)
    counts = np.round((positions - _ORIGIN_M) / _UNIT_M)
    for number, tile in enumerate(_tiles(positions[faces].mean(axis=1))):
        used, local = np.unique(faces[tile], return_inverse=True)
        corner = counts[used].min(axis=0)
        shape = PlainMesh(
            counts[used] - corner, normals[used], points[used].astype(float), local.reshape(-1, 3)
        )
        mesh = writer.painted_mesh(f"land {number + 1}", shape, colours[used], land)
        east, up, south = (float(value) for value in _ORIGIN_M + corner * _UNIT_M)
        writer.place(f"land {number + 1}", mesh, (east, up, south), (_UNIT_M,) * 3)
    _place_lake(writer)
    place_reference_objects(writer)
    return {"terrain.glb": writer.glb()}


def world_m(points: IntArray) -> tuple[FloatArray, FloatArray]:
    """World x and z (...,) of lattice points (..., 2)."""
    return np.asarray(WEST_M + points[..., 0] * _STEP_M), np.asarray(
        NORTH_M + points[..., 1] * _STEP_M
    )


def nearest_edge_m(positions: FloatArray, faces: IntArray) -> FloatArray:
    """The length (V,) of the shortest edge at each vertex, seen from above."""
    shortest = np.full(len(positions), np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        apart = positions[faces[:, i]] - positions[faces[:, j]]
        length = np.sqrt(apart[:, 0] ** 2 + apart[:, 2] ** 2)
        np.minimum.at(shortest, faces[:, i], length)
        np.minimum.at(shortest, faces[:, j], length)
    return shortest


def _place_lake(writer: GltfWriter) -> None:
    """Water as round as the planet, wider than its shore: the land hides what is too much."""
    water = writer.material("water", (0.02, 0.03, 0.034), roughness=0.09)
    rings = joined(
        [disc(r + 0.25, 0.0, 48, r) for r in (0.25, 0.5, 0.75, 1.0)] + [disc(0.25, 0.0, 48)]
    )
    x = rings.positions[:, 0] * LAKE_LONG_M
    z = rings.positions[:, 2] * LAKE_WIDE_M + 0.13 * x
    y = LAKE_M - curvature_m(x + LAKE_X_M, z + LAKE_Z_M)
    shape = PlainMesh(np.stack([x, y, z], axis=-1), rings.normals, rings.uv, rings.faces)
    writer.place("lake", writer.mesh("lake", [(shape, water)]), (LAKE_X_M, 0.0, LAKE_Z_M))


def _too_coarse(corners: IntArray) -> NDArray[np.bool_]:
    """Triangles that differ from the land, or could, by what is seen from the origin."""
    x, z = world_m(corners)
    size_m = np.abs(corners[:, 0] - corners[:, 1]).max(axis=1) * _STEP_M
    middle = x.mean(axis=1), z.mean(axis=1)
    away_m = np.maximum(np.sqrt(middle[0] ** 2 + middle[1] ** 2) - 0.7 * size_m, _STATION_M)
    # What lies behind the view's back, or far aside, may be coarser.
    ahead = np.clip(-middle[0] / np.sqrt(middle[0] ** 2 + middle[1] ** 2 + 1.0), -1.0, 1.0)
    blur = (
        np.where(away_m < 300.0, 1.0, 1.0 + 1.6 * np.clip((0.75 - ahead) / 0.75, 0.0, 1.0))
        / _FINENESS
    )
    wanted = size_m > np.maximum(0.16 * away_m * blur, 2.0)
    wanted |= size_m > 1400.0
    unsure = ~wanted & (size_m > 0.011 * away_m * blur) & (size_m > 1.5)
    error_m = _error_m(x[unsure], z[unsure])
    wanted[unsure] = error_m > 0.0011 * away_m[unsure] * blur[unsure]
    return wanted


def _error_m(x: FloatArray, z: FloatArray) -> FloatArray:
    """The most (n,) by which triangles, corners (n, 3), miss the land."""
    if len(x) == 0:
        return np.zeros(0)
    y = height_m(x, z)
    real = height_m(_between(x), _between(z))
    return np.asarray(np.abs(real - _between(y)).max(axis=1))


def _between(corners: FloatArray) -> FloatArray:
    """Values (n, p) at the places of comparison, from those at the corners (n, 3).

    Written out: library products may fuse their steps, and then machines would differ.
    """
    first, second, third = corners[:, :1], corners[:, 1:2], corners[:, 2:]
    return np.asarray(first * _PLACES[:, 0] + second * _PLACES[:, 1] + third * _PLACES[:, 2])


def _tiles(centre: FloatArray) -> list[IntArray]:
    """Faces in pieces that a view may leave out, each with few enough vertices for 16 bits."""
    waiting, done = [np.arange(len(centre))], []
    while waiting:
        faces = waiting.pop()
        place = centre[faces][:, [0, 2]]
        if len(faces) <= 12000 and np.all(np.ptp(place, axis=0) < _WIDEST_M):
            done.append(faces)
            continue
        axis = int(np.argmax(np.ptp(place, axis=0)))
        far = place[:, axis] > 0.5 * (place[:, axis].min() + place[:, axis].max())
        waiting += [faces[far], faces[~far]]
    return done
