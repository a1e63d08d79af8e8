"""A small satellite of 1.2 m with two panels, 400 km above the ground: `satellite.glb`."""

import numpy as np

from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.shapes import PlainMesh, box, joined, lathe, polygon

ALTITUDE_M = 400e3
_PANEL_M, _CELLS = (3.2, 1.1), (8, 3)


def build() -> dict[str, bytes]:
    """All files: names and bytes."""
    return {"satellite.glb": satellite(ALTITUDE_M)}


def satellite(altitude_m: float) -> bytes:
    """The satellite so far above the origin; its parts are where they are on the ground."""
    writer = GltfWriter()
    foil = writer.material("gold foil", (0.85, 0.62, 0.25), roughness=0.32, metallic=1.0)
    aluminium = writer.material("aluminium", (0.78, 0.79, 0.8), roughness=0.38, metallic=1.0)
    white = writer.material("white paint", (0.78, 0.78, 0.76), roughness=0.6)
    cells = writer.material("solar cells", (0.012, 0.016, 0.05), roughness=0.12)
    glass = writer.material("glass", (0.02, 0.02, 0.025), roughness=0.05)
    parts = {
        "body": [(_crinkled_box(0.6, 0.75, 0.6), foil)],
        "frame": [(_edges(0.62, 0.77, 0.62), aluminium)],
        "panels": [(_panels(), cells), (_panel_backs(), white), (_booms(), aluminium)],
        "dish": [(_dish(), white), (_feed(), aluminium)],
        "telescope": [(lathe([(0.0, -1.2), (0.24, -1.2), (0.24, -0.76)], 32), white),
                      (lathe([(0.0, -1.205), (0.2, -1.205)], 32), glass)],
    }  # fmt: skip
    for name, shapes in parts.items():
        writer.place(name, writer.mesh(name, shapes), (0.0, altitude_m, 0.0), azimuth_deg=24.0)
    eye = np.array([-2.6, 1.9, 6.4])
    up = np.array([0.0, altitude_m, 0.0])
    writer.camera(up + eye, up + np.array([0.35, -0.7, 0.0]), 0.95)
    return writer.glb()


def _crinkled_box(x: float, y: float, z: float) -> PlainMesh:
    """A box of foil: each face in plates that lean a little, each its own way."""
    rng = np.random.default_rng(17)
    whole = box((-x, -y, -z), (x, y, z))
    plates = []
    for first in range(0, 24, 4):
        corners = whole.positions[first : first + 4]
        along, across = corners[1] - corners[0], corners[3] - corners[0]
        for i in range(4):
            for j in range(4):
                square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                plate = polygon([corners[0] + along * u / 4 + across * v / 4 for u, v in square])
                normals = plate.normals + 0.2 * (rng.random((4, 3)) - 0.5)
                normals /= np.sqrt(np.sum(normals**2, axis=1, keepdims=True))
                plates.append(PlainMesh(plate.positions, normals, plate.uv, plate.faces))
    return joined(plates)


def _edges(x: float, y: float, z: float) -> PlainMesh:
    """The bars along a box's edges, 5 cm thick."""
    w, bars = 0.05, []
    for a in (-1, 1):
        for b in (-1, 1):
            bars += [
                box((min(a * x, a * (x - w)), -y, min(b * z, b * (z - w))),
                    (max(a * x, a * (x - w)), y, max(b * z, b * (z - w)))),
                box((-x, min(a * y, a * (y - w)), min(b * z, b * (z - w))),
                    (x, max(a * y, a * (y - w)), max(b * z, b * (z - w)))),
                box((min(a * x, a * (x - w)), min(b * y, b * (y - w)), -z),
                    (max(a * x, a * (x - w)), max(b * y, b * (y - w)), z)),
            ]  # fmt: skip
    return joined(bars)


def _panels() -> PlainMesh:
    """Both wings' cells, with a white line between each and the next; they face up and south."""
    (long, wide), (columns, rows), cells = _PANEL_M, _CELLS, []
    for side in (-1.0, 1.0):
        for i in range(columns):
            for j in range(rows):
                x0, x1 = ((i + gap) * long / columns for gap in (0.03, 0.97))
                z0, z1 = ((j + gap) * wide / rows - wide / 2 for gap in (0.03, 0.97))
                low, high = sorted((side * (1.1 + x0), side * (1.1 + x1)))
                cells.append(
                    polygon(
                        [(low, 0.025, z1), (high, 0.025, z1), (high, 0.025, z0), (low, 0.025, z0)]
                    )
                )
    return _leaning(joined(cells))


def _panel_backs() -> PlainMesh:
    long, wide = _PANEL_M
    return _leaning(joined([
        box((1.1, -0.02, -wide / 2), (1.1 + long, 0.02, wide / 2)),
        box((-1.1 - long, -0.02, -wide / 2), (-1.1, 0.02, wide / 2)),
    ]))  # fmt: skip


def _booms() -> PlainMesh:
    return joined(
        [box((0.6, -0.03, -0.03), (1.1, 0.03, 0.03)), box((-1.1, -0.03, -0.03), (-0.6, 0.03, 0.03))]
    )


def _leaning(shape: PlainMesh) -> PlainMesh:
    """Turned about the wings' axis, so that the panels face the sun of a morning."""
    c, s = 0.8, 0.6
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]).T
    return PlainMesh(shape.positions @ turn, shape.normals @ turn, shape.uv, shape.faces)


def _dish() -> PlainMesh:
    """A bowl, hollow side up, and its back."""
    radius = np.linspace(0.0, 0.42, 9)
    rise = 0.86 + 0.55 * radius**2
    front = np.stack([radius, rise], axis=1)[::-1]
    back = np.stack([radius, rise - 0.012], axis=1)
    return joined([lathe(front, 40, smooth=True), lathe(back, 40, smooth=True)])


def _feed() -> PlainMesh:
    return joined(
        [
            lathe([(0.03, 0.75), (0.03, 1.16), (0.0, 1.18)], 16),
            lathe([(0.07, 0.74), (0.07, 0.87), (0.0, 0.87)], 16),
        ]
    )
