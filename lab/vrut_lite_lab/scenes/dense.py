"""A scene of as many triangles as one likes: hills with boxes on them.

    python -m vrut_lite_lab.scenes.dense SCENE.glb [TRIANGLES]

A square of 200 m, its height field in tiles of 20,000 triangles at most, and a box for each 2,500
triangles. It is made where it is needed, and not kept with the others.
"""

import sys
from pathlib import Path

import numpy as np

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.noise import fractal_noise
from vrut_lite_lab.scenes.shapes import PlainMesh, box, joined

_WIDTH_M, _MOST_QUADS, _TRIANGLES_A_BOX, _BOX_TRIANGLES = 200.0, 100, 2500, 12
_HILL_M, _HILL_HEIGHT_M = 80.0, 12.0
_GREEN, _GREY = (0.16, 0.2, 0.1), (0.5, 0.5, 0.48)


def build(triangles: int) -> bytes:
    """Of about so many triangles, as a GLB."""
    boxes = round(triangles / _TRIANGLES_A_BOX)
    across = np.sqrt((triangles - _BOX_TRIANGLES * boxes) / 2)
    tiles = int(np.ceil(across / _MOST_QUADS))
    quads = round(across / tiles)
    writer = GltfWriter()
    grass, stone = writer.material("grass", _GREEN), writer.material("stone", _GREY)
    for number in range(tiles * tiles):
        mesh = writer.mesh(f"tile {number}", [(_tile(*divmod(number, tiles), tiles, quads), grass)])
        writer.place(f"tile {number}", mesh)
    mesh = writer.mesh("boxes", [(_boxes(boxes), stone)])
    writer.place("boxes", mesh)
    writer.camera((60.0, 30.0, 60.0), (0.0, 5.0, 0.0), np.radians(50.0))
    return writer.glb()


def _height_m(x: FloatArray, z: FloatArray) -> FloatArray:
    return _HILL_HEIGHT_M * (1.0 + fractal_noise(x / _HILL_M, z / _HILL_M, 3, 8))


def _tile(row: int, column: int, tiles: int, quads: int) -> PlainMesh:
    edge = _WIDTH_M / tiles
    along = np.linspace(0.0, edge, quads + 1) - 0.5 * _WIDTH_M
    x, z = (part.ravel() for part in np.meshgrid(along + column * edge, along + row * edge))
    step = 0.5 * edge / quads
    slopes = [
        (_height_m(x + dx, z + dz) - _height_m(x - dx, z - dz)) / (2.0 * step)
        for dx, dz in ((step, 0.0), (0.0, step))
    ]
    normals = np.stack([-slopes[0], np.ones_like(x), -slopes[1]], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    wide = quads + 1
    a = (np.arange(quads)[:, None] * wide + np.arange(quads)).ravel()
    faces = np.stack([[a, a + wide, a + 1], [a + 1, a + wide, a + wide + 1]]).transpose(2, 0, 1)
    return PlainMesh(
        np.stack([x, _height_m(x, z), z], axis=1),
        normals,
        np.stack([x, z], axis=1) / _WIDTH_M,
        faces.reshape(-1, 3),
    )


def _boxes(count: int) -> PlainMesh:
    """Boxes of 1 to 4 m, a metre deep in the ground."""
    rng = np.random.default_rng(1)
    x, z = rng.uniform(-0.48, 0.48, (2, count)) * _WIDTH_M
    sizes = rng.uniform(1.0, 4.0, (count, 3))
    feet = _height_m(x, z) - 1.0
    return joined(
        [
            box((a, y, b), (a + width, y + 1.0 + height, b + depth))
            for a, y, b, (width, height, depth) in zip(x, feet, z, sizes, strict=True)
        ]
    )


def main() -> None:
    """Write it."""
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 1_000_000
    Path(sys.argv[1]).write_bytes(build(count))


if __name__ == "__main__":
    main()
