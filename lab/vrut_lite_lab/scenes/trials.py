"""Rooms, stairs and yards to try light transport with, unlike the bundled scenes.

    python -m vrut_lite_lab.scenes.trials [FOLDER]

FOLDER is `vrut_lite_trials` in the folder for temporary files if it is left out. All have a camera;
under a summer's sun of central Europe some hour lets the sun in. Walls stand on no ground of
their own, so that the scene's disc lies around them; -Z is north.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

from vrut_lite_lab.scenes.atrium import atrium
from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.shapes import PlainMesh, box, joined, lathe, polygon, sphere

FOLDER = Path(tempfile.gettempdir()) / "vrut_lite_trials"
# Of thin walls: two texels of a light map of 0.05 m, one of 0.1 m.
THIN_WALL_M = 0.1
Corner = tuple[float, float, float]
# From and to along a wall, and heights from and to.
Hole = tuple[float, float, float, float]


def build() -> dict[str, bytes]:
    """All files: names and bytes."""
    return {
        "courtyard.glb": courtyard(), "staircase.glb": staircase(), "corridor.glb": corridor(),
        "thin_room.glb": thin_room(), "colour_bleeding.glb": colour_bleeding(),
        "loggia.glb": loggia(), "garden_room.glb": garden_room(),
        "atrium.glb": atrium(),
        "glazed_room.glb": colour_bleeding(pane=True),
    }  # fmt: skip


def courtyard() -> bytes:
    """A yard of 10 m square among wings 9 m high, with a gateway to the west."""
    writer = GltfWriter()
    plaster = writer.material("plaster", (0.62, 0.55, 0.42), roughness=0.9)
    paving = writer.material("paving", (0.32, 0.31, 0.29), roughness=0.6)
    stone = writer.material("stone", (0.45, 0.44, 0.42), roughness=0.7)
    high, half, out = 9.0, 5.0, 8.0
    wings = joined([
        box((-out, 0.0, -out), (out, high, -half)),
        box((-out, 0.0, half), (out, high, out)),
        box((half, 0.0, -half), (out, high, half)),
        *_wall_x(-out, -half, (-half, half), high, [(-1.2, 1.2, 0.0, 3.2)]),
    ])  # fmt: skip
    sills = joined([
        box((x - 0.8, y, -half), (x + 0.8, y + 0.15, -half + 0.3))
        for y in (3.6, 6.4) for x in (-3.0, 0.0, 3.0)
    ])  # fmt: skip
    basin = lathe([(1.2, 0.0), (1.2, 0.6), (1.0, 0.6), (1.0, 0.1), (0.0, 0.1)], 32)
    writer.place("wings", writer.mesh("wings", [(wings, plaster), (sills, stone)]))
    floor = box((-out, -0.1, -half), (half, 0.001, half))
    writer.place("yard", writer.mesh("yard", [(floor, paving)]))
    writer.place("basin", writer.mesh("basin", [(basin, stone)]), (0.8, 0.001, -0.6))
    writer.camera((4.0, 1.7, 4.2), (-2.0, 2.2, -3.0), 1.0)
    return writer.glb()


def staircase() -> bytes:
    """A well 6 m high with a straight flight and a winding one, a window and a skylight."""
    writer = GltfWriter()
    plaster = writer.material("plaster", (0.75, 0.74, 0.71))
    oak = writer.material("oak", (0.38, 0.26, 0.15), roughness=0.4)
    steel = writer.material("steel", (0.56, 0.57, 0.58), roughness=0.4, metallic=1.0)
    tiles = writer.material("tiles", (0.40, 0.38, 0.36), roughness=0.3)
    high = 6.0
    shell = joined([
        *_wall_x(-3.2, -3.0, (-3.0, 3.0), high, [(-1.5, 0.5, 2.2, 5.0)]),
        box((3.0, 0.0, -3.0), (3.2, high, 3.0)),
        box((-3.2, 0.0, -3.2), (3.2, high, -3.0)),
        box((-3.2, 0.0, 3.0), (3.2, high, 3.2)),
        # The ceiling, open above the pole.
        box((-3.2, high, -3.2), (0.6, high + 0.2, 3.2)),
        box((2.2, high, -3.2), (3.2, high + 0.2, 3.2)),
        box((0.6, high, -3.2), (2.2, high + 0.2, -2.0)),
        box((0.6, high, -0.4), (2.2, high + 0.2, 3.2)),
    ])  # fmt: skip
    flight = joined([
        box((-2.9 + 0.28 * step, 0.17 * step, 1.7), (-2.6 + 0.28 * step, 0.17 * (step + 1), 2.95))
        for step in range(14)
    ])  # fmt: skip
    landing = box((1.02, 2.2, 1.7), (3.0, 2.38, 3.0))
    winding = joined([
        _wedge(22.5 * step, 22.5 * step + 24.0, (0.12, 1.1), 0.19 * step, 0.19 * step + 0.05)
        .moved(1.4, 0.19, -1.2)
        for step in range(28)
    ])  # fmt: skip
    pole = lathe([(0.12, 0.0), (0.12, high)], 24)
    writer.place("shell", writer.mesh("shell", [(shell, plaster)]))
    floor = box((-3.2, -0.1, -3.2), (3.2, 0.001, 3.2))
    writer.place("floor", writer.mesh("floor", [(floor, tiles)]))
    writer.place("flight", writer.mesh("flight", [(joined([flight, landing]), oak)]))
    writer.place("winding", writer.mesh("winding", [(winding, oak)]))
    writer.place("pole", writer.mesh("pole", [(pole, steel)]), (1.4, 0.0, -1.2))
    writer.camera((-2.5, 1.9, -2.6), (1.0, 1.8, 0.9), 1.15)
    return writer.glb()


def corridor() -> bytes:
    """12 m long and 2 m wide, with a window in its west side and an open door at the north end."""
    writer = GltfWriter()
    plaster = writer.material("plaster", (0.70, 0.70, 0.68))
    lino = writer.material("linoleum", (0.30, 0.34, 0.30), roughness=0.25)
    wood = writer.material("wood", (0.33, 0.20, 0.11), roughness=0.5)
    high = 2.6
    shell = joined([
        *_wall_x(-1.2, -1.0, (-6.0, 6.0), high, [(-1.0, 0.4, 0.9, 2.1)]),
        box((1.0, 0.0, -6.0), (1.2, high, 6.0)),
        box((-1.2, 0.0, 6.0), (1.2, high, 6.2)),
        *_wall_z(-6.2, -6.0, (-1.2, 1.2), high, [(-0.45, 0.45, 0.0, 2.05)]),
        box((-1.2, high, -6.2), (1.2, high + 0.2, 6.2)),
    ])  # fmt: skip
    doors = joined([box((0.96, 0.0, z - 0.45), (1.0, 2.05, z + 0.45)) for z in (-3.5, 2.5)])
    writer.place("shell", writer.mesh("shell", [(shell, plaster)]))
    floor = box((-1.2, -0.1, -6.2), (1.2, 0.001, 6.2))
    writer.place("floor", writer.mesh("floor", [(floor, lino)]))
    writer.place("doors", writer.mesh("doors", [(doors, wood)]))
    writer.camera((0.3, 1.6, 5.4), (-0.1, 1.2, -3.0), 0.9)
    return writer.glb()


def thin_room() -> bytes:
    """A room with walls of 0.1 m, in it a closet that light enters round two corners only."""
    writer = GltfWriter()
    plaster = writer.material("plaster", (0.72, 0.71, 0.68))
    boards = writer.material("boards", (0.36, 0.24, 0.14), roughness=0.5)
    thin, high = THIN_WALL_M, 2.5
    shell = joined([
        *_wall_x(-2.0 - thin, -2.0, (-2.5, 2.5), high, [(0.2, 1.4, 0.9, 2.0)]),
        box((2.0, 0.0, -2.5), (2.0 + thin, high, 2.5)),
        box((-2.0 - thin, 0.0, -2.5 - thin), (2.0 + thin, high, -2.5)),
        box((-2.0 - thin, 0.0, 2.5), (2.0 + thin, high, 2.5 + thin)),
        box((-2.0 - thin, high, -2.5 - thin), (2.0 + thin, high + thin, 2.5 + thin)),
        # The closet's walls: one behind the other, with a way round at either end.
        box((-2.0, 0.0, -0.9 - thin), (0.9, high, -0.9)),
        box((0.9, 0.0, -1.7), (0.9 + thin, high, -0.9)),
    ])  # fmt: skip
    writer.place("shell", writer.mesh("shell", [(shell, plaster)]))
    floor = box((-2.0 - thin, -0.1, -2.5 - thin), (2.0 + thin, 0.001, 2.5 + thin))
    writer.place("floor", writer.mesh("floor", [(floor, boards)]))
    writer.camera((1.7, 1.6, 2.2), (0.2, 1.0, -1.6), 1.2)
    return writer.glb()


def colour_bleeding(pane: bool = False) -> bytes:
    """A white room with a red wall in the north, a green one in the south, a western window.

    Its `pane`, if it has one, is of a material named glass.
    """
    writer = GltfWriter()
    white = writer.material("white", (0.78, 0.78, 0.76))
    red = writer.material("red", (0.60, 0.05, 0.04))
    green = writer.material("green", (0.07, 0.42, 0.10))
    gloss = writer.material("gloss", (0.75, 0.75, 0.75), roughness=0.2)
    half, high = 2.0, 3.0
    shell = joined([
        *_wall_x(-half - 0.2, -half, (-half, half), high, [(-1.4, 1.4, 0.8, 2.6)]),
        box((half, 0.0, -half), (half + 0.2, high, half)),
        box((-half - 0.2, high, -half - 0.2), (half + 0.2, high + 0.2, half + 0.2)),
        box((-half - 0.2, -0.1, -half - 0.2), (half + 0.2, 0.001, half + 0.2)),
    ])  # fmt: skip
    ends = [box((-half - 0.2, 0.0, z), (half + 0.2, high, z + 0.2)) for z in (-half - 0.2, half)]
    writer.place("shell", writer.mesh("shell", [(shell, white)]))
    writer.place("north", writer.mesh("north", [(ends[0], red)]))
    writer.place("south", writer.mesh("south", [(ends[1], green)]))
    block = writer.mesh("block", [(box((-0.45, 0.0, -0.45), (0.45, 1.3, 0.45)), white)])
    writer.place("block", block, (0.5, 0.001, -0.7), azimuth_deg=18.0)
    ball = writer.mesh("ball", [(sphere(0.4, 48), gloss)])
    writer.place("ball", ball, (-0.2, 0.401, 0.9))
    if pane:
        glass = writer.material("glass", (0.9, 0.9, 0.9), roughness=0.0, double_sided=True)
        edge = [(0.8, -1.4), (0.8, 1.4), (2.6, 1.4), (2.6, -1.4)]
        sheet = polygon([(-half - 0.1, y, z) for y, z in edge])
        writer.place("pane", writer.mesh("pane", [(sheet, glass)]))
    writer.camera((-1.8, 1.5, 0.1), (1.2, 1.1, 0.0), 1.25)
    return writer.glb()


def loggia() -> bytes:
    """A roof on columns along a house, open to the west and the south."""
    writer = GltfWriter()
    plaster = writer.material("plaster", (0.70, 0.62, 0.48), roughness=0.9)
    stone = writer.material("stone", (0.55, 0.53, 0.50), roughness=0.6)
    tiles = writer.material("tiles", (0.42, 0.20, 0.13), roughness=0.35)
    house = joined(
        [box((0.0, 0.0, -5.0), (3.0, 4.2, 5.0)), box((-3.2, 0.0, -5.3), (0.0, 4.2, -5.0))]
    )
    roof = box((-3.4, 3.5, -5.3), (0.0, 3.8, 5.2))
    pillar = lathe([(0.22, 0.0), (0.22, 0.2), (0.16, 0.25), (0.14, 3.2), (0.24, 3.5)], 24)
    rail = box((-3.2, 0.0, -5.0), (-3.0, 0.9, -1.0))
    writer.place("house", writer.mesh("house", [(joined([house, roof]), plaster)]))
    column = writer.mesh("column", [(pillar, stone)])
    for number, z in enumerate((-3.0, -1.0, 1.0, 3.0, 4.9)):
        writer.place(f"column {number + 1}", column, (-3.0, 0.001, z))
    writer.place("rail", writer.mesh("rail", [(rail, stone)]))
    floor = box((-3.4, -0.1, -5.3), (0.0, 0.001, 5.2))
    writer.place("floor", writer.mesh("floor", [(floor, tiles)]))
    writer.camera((-1.2, 1.6, 4.6), (-1.9, 1.5, -4.0), 1.0)
    return writer.glb()


def garden_room() -> bytes:
    """A room with a tinted pane instead of its west wall, and shrubs of leaves on both sides."""
    writer = GltfWriter()
    plaster = writer.material("plaster", (0.72, 0.70, 0.66))
    tiles = writer.material("tiles", (0.45, 0.28, 0.20), roughness=0.5)
    clay = writer.material("clay", (0.50, 0.22, 0.12), roughness=0.9)
    leaf = writer.material("leaves", (0.09, 0.22, 0.05), roughness=0.7, double_sided=True)
    tint = writer.material("tint", (0.10, 0.35, 0.30), roughness=0.1, alpha=0.35, double_sided=True)
    half, high = 2.0, 2.6
    shell = joined([
        box((half, 0.0, -half), (half + 0.2, high, half)),
        box((-half, 0.0, -half - 0.2), (half + 0.2, high, -half)),
        box((-half, 0.0, half), (half + 0.2, high, half + 0.2)),
        box((-half, high, -half - 0.2), (half + 0.2, high + 0.2, half + 0.2)),
    ])  # fmt: skip
    writer.place("shell", writer.mesh("shell", [(shell, plaster)]))
    floor = box((-half - 3.0, -0.1, -half - 0.6), (half + 0.2, 0.001, half + 0.6))
    writer.place("floor", writer.mesh("floor", [(floor, tiles)]))
    # The northern half is glazed; the southern one is open.
    pane = polygon(
        [(-half, y, z) for y, z in ((0.0, -half), (0.0, 0.1), (high, 0.1), (high, -half))]
    )
    writer.place("pane", writer.mesh("pane", [(pane, tint)]))
    pot = lathe([(0.16, 0.0), (0.22, 0.4), (0.18, 0.4), (0.16, 0.34), (0.0, 0.34)], 20)
    shrub = writer.mesh("shrub", [(pot, clay), (_leaves(420), leaf)])
    places = [(-2.9 - 0.7 * row, -1.9 + 0.75 * column) for row in range(3) for column in range(6)]
    places += [(-0.9, -1.2), (1.3, -1.4), (-0.5, 0.9), (0.2, -1.6), (-1.5, -0.3), (-1.6, -1.5)]
    for number, (x, z) in enumerate(places):
        writer.place(f"shrub {number + 1}", shrub, (x, 0.001, z), azimuth_deg=53.0 * number)
    writer.camera((1.7, 1.6, 1.7), (-1.6, 0.9, -0.9), 1.0)
    return writer.glb()


def _leaves(count: int) -> PlainMesh:
    """Leaves of 5 cm in a ball above a pot."""
    rng = np.random.default_rng(4)
    leaves = []
    for away in rng.normal(size=(count, 3)):
        away /= np.linalg.norm(away)
        middle = away * 0.42 * rng.random() ** (1.0 / 3.0) + [0.0, 0.95, 0.0]
        along = np.cross(away, rng.normal(size=3))
        along *= 0.05 / np.linalg.norm(along)
        side = 0.4 * np.cross(along, away)
        leaves.append(polygon([middle, middle + 0.5 * along - side, middle + along,
                               middle + 0.5 * along + side]))  # fmt: skip
    return joined(leaves)


def _wall_x(
    x0: float, x1: float, along_z: tuple[float, float], high: float, holes: list[Hole]
) -> list[PlainMesh]:
    """A wall across x with one hole after another along z."""
    pieces = [((x0, low, a), (x1, top, b)) for a, b, low, top in _solid(along_z, high, holes)]
    return [box(*corners) for corners in pieces]


def _wall_z(
    z0: float, z1: float, along_x: tuple[float, float], high: float, holes: list[Hole]
) -> list[PlainMesh]:
    """A wall across z with one hole after another along x."""
    pieces = [((a, low, z0), (b, top, z1)) for a, b, low, top in _solid(along_x, high, holes)]
    return [box(*corners) for corners in pieces]


def _solid(along: tuple[float, float], high: float, holes: list[Hole]) -> list[Hole]:
    """The pieces of a wall around its holes."""
    left, pieces = along[0], []
    for a, b, low, top in holes:
        pieces += [(left, a, 0.0, high), (a, b, 0.0, low), (a, b, top, high)]
        left = b
    pieces.append((left, along[1], 0.0, high))
    return [piece for piece in pieces if piece[1] > piece[0] and piece[3] > piece[2]]


def _wedge(
    from_deg: float, to_deg: float, radii_m: tuple[float, float], low: float, top: float
) -> PlainMesh:
    """A winding step about the vertical axis, clockwise seen from above."""
    angles = np.radians([from_deg, to_deg])
    inner, outer = (
        [(radius * np.sin(a), -radius * np.cos(a)) for a in angles] for radius in radii_m
    )
    # Counter-clockwise seen from above.
    corners = [inner[0], outer[0], outer[1], inner[1]][::-1]
    sides = []
    for number, (x, z) in enumerate(corners):
        next_x, next_z = corners[(number + 1) % 4]
        sides.append(
            polygon([(x, low, z), (next_x, low, next_z), (next_x, top, next_z), (x, top, z)])
        )
    upper = polygon([(x, top, z) for x, z in corners])
    lower = polygon([(x, low, z) for x, z in corners[::-1]])
    return joined([upper, lower, *sides])


def main() -> None:
    """Write all files."""
    folder = Path(sys.argv[1]) if sys.argv[1:] else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for file, data in build().items():
        (folder / file).write_bytes(data)
        print(f"{folder / file}: {len(data)} bytes")


if __name__ == "__main__":
    main()
