"""Scenes that need little of a renderer's work: room, ground, indoor, planet.

lab/vrut_lite_lab/work_skipped.py measures the work that is left out in them.
"""

import numpy as np

from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.shapes import PlainMesh, box, disc, joined, lathe, obelisk, sphere

_PLANET_M, _SEEN_RAD = 6.36e6, 0.2
_PEAKS = 7


def build() -> dict[str, bytes]:
    """All files: names and bytes."""
    return {"room.glb": room(), "ground.glb": ground(), "indoor.glb": indoor(),
            "planet.glb": planet()}  # fmt: skip


def room() -> bytes:
    """A closed room with paper lanterns: no daylight gets in, and none need be made.

    Nothing but the lanterns glows; light transport brings their light to walls and table.
    """
    writer = GltfWriter()
    walls = _turned(box((-3.0, 0.0, -4.0), (3.0, 2.8, 4.0)))
    plaster = writer.material("plaster", (0.75, 0.73, 0.68))
    writer.place("walls", writer.mesh("walls", [(walls, plaster)]))
    paper = writer.material("paper", (0.8, 0.8, 0.8), emissive=(1.0, 0.86, 0.66))
    lantern = writer.mesh("lantern", [(sphere(0.4, 32), paper)])
    for number, (x, z) in enumerate(((-1.5, -2.4), (1.5, -2.4), (0.0, -0.4))):
        writer.place(f"lantern {number + 1}", lantern, (x, 2.1, z))
    wood = writer.material("wood", (0.30, 0.18, 0.09), roughness=0.6)
    writer.place("table", writer.mesh("table", [(_table(), wood)]), (0.0, 0.0, -1.6))
    writer.camera((0.0, 1.6, 3.4), (0.0, 1.3, -2.0), 1.0)
    return writer.glb()


def ground() -> bytes:
    """A paved yard among posts, looked down upon: not a pixel of sky."""
    writer = GltfWriter()
    paving = writer.material("paving", (0.34, 0.32, 0.29))
    moss = writer.material("moss", (0.09, 0.14, 0.05))
    iron = writer.material("iron", (0.08, 0.08, 0.09), roughness=0.5, metallic=1.0)
    rings = joined([disc(0.5 + i, 0.012, 48, 0.35 + i) for i in range(8)])
    writer.place("yard", writer.mesh("yard", [(disc(9.0, 0.0, 96), paving), (rings, moss)]))
    post = writer.mesh("post", [(obelisk(0.14, 0.09, 1.1, 1.25), iron)])
    for number in range(12):
        writer.place(f"post {number + 1}", post, _around(number, 12, 7.6))
    writer.camera((0.9, 1.9, 1.6), (0.2, 0.0, 0.1), 0.8)
    return writer.glb()


def indoor() -> bytes:
    """A small room with one window: most of what there is lies out of view, and so does the sky."""
    writer = GltfWriter()
    plaster = writer.material("plaster", (0.72, 0.71, 0.68))
    boards = writer.material("boards", (0.36, 0.24, 0.14), roughness=0.5)
    wood = writer.material("wood", (0.30, 0.18, 0.09), roughness=0.6)
    brass = writer.material("brass", (0.80, 0.62, 0.28), roughness=0.3, metallic=1.0)
    writer.place("shell", writer.mesh("shell", [(_shell(), plaster)]))
    writer.place("floor", writer.mesh("floor", [(box((-2, -0.05, -2.5), (2, 0, 2.5)), boards)]))
    writer.place("table", writer.mesh("table", [(_table(), wood)]), (0.4, 0.0, -0.6))
    vase = lathe([(0.0, 0.0), (0.09, 0.0), (0.13, 0.1), (0.06, 0.24), (0.08, 0.3)], 32, smooth=True)
    jar = writer.mesh("jar", [(vase, brass)])
    shelf = writer.mesh("shelf", [(box((-0.6, 0.0, -0.12), (0.6, 0.03, 0.12)), wood)])
    for number, height_m in enumerate((0.5, 0.95, 1.4)):
        writer.place(f"shelf {number + 1}", shelf, (-1.0, height_m, 2.36))
        for place in range(4):
            at = (-1.45 + 0.3 * place, height_m + 0.03, 2.36)
            writer.place(f"jar {number + 1}.{place + 1}", jar, at, (0.6, 0.6, 0.6))
    writer.place("vase", jar, (0.4, 0.75, -0.6))
    writer.camera((-1.2, 1.6, 1.9), (0.5, 0.9, -1.2), 0.9)
    return writer.glb()


def planet() -> bytes:
    """What is seen of an Earth from a height of 24 km, its peaks as large as its largest."""
    writer = GltfWriter()
    rock = writer.material("rock", (0.24, 0.21, 0.18), roughness=0.95)
    snow = writer.material("snow", (0.80, 0.82, 0.85))
    writer.place("planet", writer.mesh("planet", [(_cap(), rock)]))
    peak = writer.mesh("peak", [(lathe([(1.0, -0.2), (0.0, 1.0)], 24), rock),
                                (lathe([(0.351, 0.62), (0.0, 1.02)], 24), snow)])  # fmt: skip
    for number in range(_PEAKS):
        x, _, z = _around(number, _PEAKS, 6e4)
        down_m = _PLANET_M - (_PLANET_M**2 - x**2 - z**2) ** 0.5
        writer.place(f"peak {number + 1}", peak, (x, -down_m, z), (2.2e4, 9e3, 2.2e4))
    writer.camera((0.0, 2.4e4, 2.2e5), (0.0, -4e3, 0.0), 0.8)
    return writer.glb()


def _turned(shape: PlainMesh) -> PlainMesh:
    """The shape seen from within."""
    return PlainMesh(shape.positions, -shape.normals, shape.uv, shape.faces[:, ::-1])


def _table() -> PlainMesh:
    legs = [
        box((x - 0.03, 0.0, z - 0.03), (x + 0.03, 0.71, z + 0.03))
        for x in (-0.55, 0.55)
        for z in (-0.33, 0.33)
    ]
    return joined([box((-0.65, 0.71, -0.42), (0.65, 0.75, 0.42)), *legs])


def _shell() -> PlainMesh:
    """Walls and a ceiling, 10 cm thick, with a window to the west."""
    low, high, south, north = 0.9, 2.0, 0.8, -0.8
    west = [
        ((-2.1, 0.0, -2.5), (-2.0, 2.5, north)),
        ((-2.1, 0.0, south), (-2.0, 2.5, 2.5)),
        ((-2.1, 0.0, north), (-2.0, low, south)),
        ((-2.1, high, north), (-2.0, 2.5, south)),
    ]
    others = [
        ((2.0, 0.0, -2.5), (2.1, 2.5, 2.5)),
        ((-2.1, 0.0, -2.6), (2.1, 2.5, -2.5)),
        ((-2.1, 0.0, 2.5), (2.1, 2.5, 2.6)),
        ((-2.1, 2.5, -2.6), (2.1, 2.6, 2.6)),
    ]
    return joined([box(*corners) for corners in (*west, *others)])


def _cap() -> PlainMesh:
    """The planet's top at the origin; rings widen outwards, as their flat faces may."""
    angle = _SEEN_RAD * np.linspace(1.0, 0.0, 41) ** 2
    profile = _PLANET_M * np.stack([np.sin(angle), -2.0 * np.sin(angle / 2.0) ** 2], axis=1)
    return lathe(profile, 128, smooth=True)


def _around(number: int, count: int, radius_m: float) -> tuple[float, float, float]:
    """A place on a circle about the origin, clockwise from north."""
    turn = 2.0 * np.pi * number / count
    return round(radius_m * float(np.sin(turn)), 5), 0.0, round(-radius_m * float(np.cos(turn)), 5)
