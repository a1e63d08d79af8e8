"""Balls from mirror to chalk on plinths: what the sky does to metal, plastic and grey."""

from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.shapes import PlainMesh, box, disc, joined, lathe, polygon, sphere

_RADIUS_M = 0.5
_PITCH_M = 1.5
# Base colours of metals are their normal reflectances; a grey card reflects 18 %.
_BACK = [
    ("mirror", (0.90, 0.90, 0.90), 0.0, 1.0),
    ("chrome", (0.55, 0.56, 0.56), 0.12, 1.0),
    ("gold", (0.90, 0.70, 0.32), 0.22, 1.0),
    ("copper", (0.86, 0.56, 0.43), 0.35, 1.0),
    ("brushed aluminium", (0.86, 0.87, 0.87), 0.55, 1.0),
]
_FRONT = [
    ("red plastic, glossy", (0.60, 0.03, 0.02), 0.1, 0.0),
    ("blue plastic, satin", (0.04, 0.12, 0.45), 0.35, 0.0),
    ("18 % grey, matt", (0.18, 0.18, 0.18), 1.0, 0.0),
    ("white, matt", (0.85, 0.85, 0.84), 0.9, 0.0),
    ("black, glossy", (0.02, 0.02, 0.02), 0.05, 0.0),
]


def build() -> dict[str, bytes]:
    """File names and their bytes."""
    writer = GltfWriter()
    concrete = writer.material("concrete", (0.40, 0.39, 0.37), roughness=0.95)
    dark = writer.material("dark concrete", (0.22, 0.22, 0.21), roughness=0.9)
    stone = writer.material("plinth stone", (0.55, 0.53, 0.49), roughness=0.8)
    floor = writer.mesh("floor", [(_slabs(0), concrete), (_slabs(1), dark), (_kerb(), stone)])
    writer.place("floor", floor)
    plinth = writer.mesh("plinth", [(_plinth(), stone)])
    ball = sphere(_RADIUS_M, 64)
    for row, z_m, height_m in ((_BACK, -1.1, 1.0), (_FRONT, 1.1, 0.45)):
        for number, (name, albedo, roughness, metallic) in enumerate(row):
            x_m = (number - 2) * _PITCH_M
            material = writer.material(name, albedo, roughness=roughness, metallic=metallic)
            mesh = writer.mesh(name, [(ball, material)])
            writer.place(name, mesh, (x_m, height_m + _RADIUS_M, z_m))
            writer.place(f"plinth of {name}", plinth, (x_m, 0.0, z_m), (1.0, height_m, 1.0))
    writer.camera((-4.4, 2.3, 6.6), (0.0, 0.95, 0.0), 0.72)
    return {"spheres.glb": writer.glb()}


def _slabs(parity: int) -> PlainMesh:
    """Every second slab of a floor of 12 m x 12 m, each 1.5 m wide."""
    return joined(
        [
            _level_square((i - 4) * _PITCH_M, (j - 4) * _PITCH_M)
            for i in range(8)
            for j in range(8)
            if (i + j) % 2 == parity
        ]
    )


def _level_square(x: float, z: float) -> PlainMesh:
    far_x, far_z = x + _PITCH_M, z + _PITCH_M
    return polygon([(x, 0.0, far_z), (far_x, 0.0, far_z), (far_x, 0.0, z), (x, 0.0, z)])


def _kerb() -> PlainMesh:
    """Four beams around the floor, each laid against the next."""
    half, width = 4 * _PITCH_M, 0.3
    beam = box((-half, -0.12, half), (half + width, 0.02, half + width))
    return joined([beam.turned(90.0 * side) for side in range(4)])


def _plinth() -> PlainMesh:
    """A round post of height 1, to be scaled."""
    return joined([lathe([(0.24, 0.0), (0.24, 1.0)], 40), disc(0.24, 1.0, 40)])
