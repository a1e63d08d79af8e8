"""A court of two storeys of arcades with cloths between the columns, open above; 20 m long."""

from itertools import pairwise

import numpy as np

from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.shapes import PlainMesh, box, joined, lathe, polygon

_HALF_M, _COURT_M, _AISLE_M, _WALL_M = 10.0, 3.0, 6.0, 0.3
_BAY_M, _BAYS = 2.5, 8
# Heights of an arcade: where its arches begin, and its top; a slab lies above.
_STOREYS = ((0.0, 3.0, 4.6), (5.0, 7.2, 8.6))
_SLAB_M, _THICK_M, _REACH_M = 0.4, 0.4, 1.05
_ARC = 8


def atrium() -> bytes:
    """The file; the view is along the court, from the gallery's end."""
    writer = GltfWriter()
    stone = writer.material("stone", (0.58, 0.52, 0.42), roughness=0.9)
    plaster = writer.material("plaster", (0.66, 0.55, 0.40), roughness=0.9)
    floor = writer.material("floor", (0.36, 0.33, 0.30), roughness=0.7)
    cloths = [
        writer.material(name, colour, roughness=1.0)
        for name, colour in (
            ("red", (0.50, 0.05, 0.04)), ("green", (0.06, 0.28, 0.08)), ("blue", (0.05, 0.10, 0.38))
        )
    ]  # fmt: skip
    out, top = _AISLE_M + _WALL_M, _STOREYS[1][2] + _SLAB_M
    walls = [box((x, 0.0, -_HALF_M), (x + _WALL_M, top, _HALF_M)) for x in (-out, _AISLE_M)]
    walls += [box((-out, 0.0, z), (out, top, z + _WALL_M)) for z in (-_HALF_M - _WALL_M, _HALF_M)]
    slabs = [
        box((x, high, -_HALF_M), (x + _AISLE_M - _COURT_M, high + _SLAB_M, _HALF_M))
        for x in (-_AISLE_M, _COURT_M) for _, _, high in _STOREYS
    ]  # fmt: skip
    writer.place("walls", writer.mesh("walls", [(joined([*walls, *slabs]), plaster)]))
    ground = box((-out, -0.1, -_HALF_M - _WALL_M), (out, 0.001, _HALF_M + _WALL_M))
    writer.place("floor", writer.mesh("floor", [(ground, floor)]))
    for low, spring, high in _STOREYS:
        arch = writer.mesh(f"arch {low:g}", [(_arch(spring, high), stone)])
        column = writer.mesh(f"column {low:g}", [(_column(low, spring), stone)])
        for side in (-1.0, 1.0):
            x = side * (_COURT_M + _THICK_M / 2)
            for bay in range(_BAYS):
                z = _BAY_M * (bay + 0.5) - _HALF_M
                writer.place(f"arch {low:g} {side:g} {bay}", arch, (x, 0.0, z))
            for number in range(1, _BAYS):
                z = _BAY_M * number - _HALF_M
                writer.place(f"column {low:g} {side:g} {number}", column, (x, 0.0, z))
    for number, bay in enumerate((1, 2, 4, 5, 6)):
        z, side = _BAY_M * (bay + 0.5) - _HALF_M, (-1.0, 1.0)[number % 2]
        x = side * (_COURT_M + _THICK_M / 2)
        cloth = box((x - 0.05, 5.4, z - 1.0), (x + 0.05, 8.0, z + 1.0))
        paint = cloths[number % len(cloths)]
        writer.place(f"cloth {number}", writer.mesh(f"cloth {number}", [(cloth, paint)]))
    writer.camera((1.6, 1.7, 9.2), (-1.6, 3.6, -6.0), 1.1)
    return writer.glb()


def _column(low: float, high: float) -> PlainMesh:
    return lathe(
        [(0.3, low), (0.3, low + 0.25), (0.2, low + 0.35), (0.17, high - 0.4), (0.3, high)], 16
    )


def _arch(spring: float, high: float) -> PlainMesh:
    """A plate over one bay along z about the origin, round below, from its columns to its top."""
    angle = np.linspace(0.0, np.pi, _ARC + 1)
    half = _BAY_M / 2
    below = [(-half, spring)]
    below += [(-_REACH_M * np.cos(a), spring + _REACH_M * np.sin(a)) for a in angle]
    below += [(half, spring)]
    x = _THICK_M / 2
    pieces = []
    for (z0, y0), (z1, y1) in pairwise(below):
        pieces.append(polygon([(-x, y0, z0), (-x, y1, z1), (-x, high, z1), (-x, high, z0)]))
        pieces.append(polygon([(x, y1, z1), (x, y0, z0), (x, high, z0), (x, high, z1)]))
        pieces.append(polygon([(-x, y1, z1), (-x, y0, z0), (x, y0, z0), (x, y1, z1)]))
    return joined(pieces)
