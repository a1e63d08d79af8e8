"""A round garden pavilion on steps, among trees and hedges."""

import numpy as np

from vrut_lite_lab.scenes import textures
from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.shapes import PlainMesh, box, disc, joined, lathe, sphere

_COLUMNS = 8
_FLOOR_M = 0.48
_SLAB_PAIR_M = 1.2
_RING_SEGMENTS = 64
# East, south (metres), height relative to the model, for each of the two kinds of tree.
_CONIFERS = [(-9.0, -8.0, 1.2), (-12.5, -3.0, 0.9), (7.5, -11.0, 1.35), (12.0, 3.5, 1.0)]
_BROADLEAVES = [(9.5, -4.0, 1.0), (-13.0, 2.5, 0.9), (3.0, -13.0, 1.25), (-4.0, -12.5, 1.05)]


def build() -> dict[str, bytes]:
    """File names and their bytes."""
    writer = GltfWriter()
    grass = writer.material("grass", (0.075, 0.13, 0.035))
    gravel = writer.material("gravel", (0.36, 0.32, 0.26))
    lawn = writer.mesh("lawn", [(disc(22.0, 0.0, 72), grass), (_path(), gravel)])
    writer.place("lawn", lawn)
    _add_pavilion(writer)
    _add_plants(writer)
    writer.camera((-6.2, 1.7, 10.4), (0.0, 2.55, -0.5), 0.74)
    document, buffer = writer.gltf("pavilion.bin")
    return {
        "pavilion.gltf": document,
        "pavilion.bin": buffer,
        "pavilion_floor.png": textures.checker(),
    }


def _add_pavilion(writer: GltfWriter) -> None:
    stone = writer.material("limestone", (0.62, 0.58, 0.50), roughness=0.9)
    marble = writer.material(
        "marble floor", (1.0, 1.0, 1.0), roughness=0.35, texture="pavilion_floor.png"
    )
    copper = writer.material("verdigris", (0.20, 0.37, 0.31), roughness=0.75)
    plaster = writer.material("plaster", (0.78, 0.76, 0.71))
    gold = writer.material("gold", (0.90, 0.70, 0.32), roughness=0.25, metallic=1.0)
    floor = disc(3.4, _FLOOR_M, 64).textured_every(_SLAB_PAIR_M)
    finial = joined([lathe([(0.16, 0.0), (0.05, 0.35)], 20), sphere(0.2, 20).moved(y=0.48)])
    body = writer.mesh("pavilion", [(_steps(), stone), (floor, marble), (_entablature(), stone)])
    roof = writer.mesh(
        "roof", [(_dome(), copper), (_ceiling(), plaster), (finial.moved(y=5.85), gold)]
    )
    column = writer.mesh("column", [(_column(), stone)])
    writer.place("pavilion", body)
    writer.place("roof", roof)
    for number in range(_COLUMNS):
        azimuth_deg = (number + 0.5) * 360.0 / _COLUMNS
        x, z = np.sin(np.radians(azimuth_deg)), -np.cos(np.radians(azimuth_deg))
        at = (round(2.9 * float(x), 5), _FLOOR_M, round(2.9 * float(z), 5))
        writer.place(f"column {number + 1}", column, at, azimuth_deg=azimuth_deg)


def _add_plants(writer: GltfWriter) -> None:
    bark = writer.material("bark", (0.11, 0.075, 0.05))
    needles = writer.material("needles", (0.030, 0.070, 0.028), roughness=0.9)
    leaves = writer.material("leaves", (0.075, 0.14, 0.03), roughness=0.85)
    hedge_leaves = writer.material("hedge", (0.04, 0.085, 0.025), roughness=0.9)
    conifer = writer.mesh("conifer", [(_trunk(0.9), bark), (_tiers(), needles)])
    broadleaf = writer.mesh("broadleaf", [(_trunk(2.2), bark), (_crown(), leaves)])
    hedge = writer.mesh("hedge", [(box((-2.6, 0.0, -0.35), (2.6, 0.8, 0.35)), hedge_leaves)])
    for kind, mesh, places in (
        ("conifer", conifer, _CONIFERS),
        ("broadleaf", broadleaf, _BROADLEAVES),
    ):
        for number, (east_m, south_m, size) in enumerate(places):
            at = (east_m, 0.0, south_m)
            writer.place(f"{kind} {number + 1}", mesh, at, (size,) * 3, 77.0 * number)
    for number, azimuth_deg in enumerate((40.0, 100.0, 260.0, 320.0)):
        x, z = np.sin(np.radians(azimuth_deg)), -np.cos(np.radians(azimuth_deg))
        at = (round(7.2 * float(x), 5), 0.0, round(7.2 * float(z), 5))
        writer.place(f"hedge {number + 1}", hedge, at, azimuth_deg=azimuth_deg)


def _path() -> PlainMesh:
    """A walk from the south to the steps, and a round one about them."""
    ring = [lathe([(5.4, 0.0), (5.4, 0.03)], 64), disc(5.4, 0.03, 64, 4.3)]
    return joined([*ring, box((-1.2, 0.0, 5.2), (1.2, 0.025, 21.9))])


def _steps() -> PlainMesh:
    """Three round steps up to the floor, and the border around the marble."""
    profile = [(4.3, 0.0), (4.3, 0.16), (4.0, 0.16), (4.0, 0.32), (3.7, 0.32), (3.7, _FLOOR_M)]
    return lathe([*profile, (3.4, _FLOOR_M)], 64)


def _column() -> PlainMesh:
    shaft = [(0.30, 0.12), (0.24, 0.16), (0.205, 0.22), (0.20, 1.2), (0.17, 2.78), (0.17, 2.82)]
    capital = [(0.22, 2.84), (0.22, 2.88), (0.27, 2.96)]
    slabs = [box((-0.3, 0.0, -0.3), (0.3, 0.12, 0.3)), box((-0.3, 2.96, -0.3), (0.3, 3.05, 0.3))]
    return joined([lathe(shaft + capital, 24), *slabs])


def _entablature() -> PlainMesh:
    """The ring on the columns, outside up, top, and down inside."""
    outside = [(2.6, 3.53), (3.22, 3.53), (3.22, 3.83), (3.3, 3.83), (3.3, 3.95), (3.5, 4.05)]
    return lathe([*outside, (3.5, 4.15), (2.6, 4.15), (2.6, 3.53)], _RING_SEGMENTS)


def _dome() -> PlainMesh:
    angle = np.radians(np.linspace(0.0, 90.0, 13))
    profile = np.stack([3.1 * np.cos(angle), 4.15 + 1.75 * np.sin(angle)], axis=1)
    profile[-1, 0] = 0.0
    return joined([lathe([(3.1, 4.15), (3.1, 4.151)], 64), lathe(profile, 64, smooth=True)])


def _ceiling() -> PlainMesh:
    """The dome from within, seen from below."""
    angle = np.radians(np.linspace(90.0, 0.0, 9))
    profile = np.stack([2.6 * np.cos(angle), 4.15 + 1.4 * np.sin(angle)], axis=1)
    profile[0, 0] = 0.0
    # As many segments as the ring has that it ends on: between two polygons the sky is seen.
    return lathe(profile, _RING_SEGMENTS, smooth=True)


def _trunk(height_m: float) -> PlainMesh:
    return lathe([(0.28, 0.0), (0.17, 0.3), (0.13, height_m + 0.5)], 12)


def _tiers() -> PlainMesh:
    """Cones, each smaller than the one below, closed underneath."""
    tiers = [(1.7, 0.8, 2.6), (1.4, 1.9, 3.7), (1.1, 3.0, 4.8), (0.75, 4.1, 5.9)]
    return joined(
        [lathe([(0.1, low + 0.25), (radius, low), (0.0, top)], 18) for radius, low, top in tiers]
    )


def _crown() -> PlainMesh:
    """Five overlapping balls."""
    balls = [
        (0.0, 3.9, 0.0, 1.5),
        (1.0, 3.3, 0.3, 1.1),
        (-0.9, 3.4, -0.5, 1.15),
        (0.1, 3.2, -1.0, 1.05),
        (-0.2, 3.1, 1.0, 1.1),
    ]
    return joined([sphere(radius, 18).moved(x, y, z) for x, y, z, radius in balls])
