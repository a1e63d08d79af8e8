"""A dark hall with three high windows to the south: `hall.glb`, made to show light shafts."""

from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.shapes import PlainMesh, box, joined, lathe

_HALF_WIDTH_M, _DEEP_M, _HIGH_M, _WALL_M = 30.0, 70.0, 28.0, 1.5
_WINDOWS_M, _WINDOW_M, _SILL_M, _LINTEL_M = (-17.0, 0.0, 17.0), 4.4, 13.0, 22.0
_EYE_M, _TARGET_M, _FIELD_OF_VIEW_RAD = (7.0, 1.7, 8.0), (-3.0, 11.0, 70.0), 0.9


def build() -> dict[str, bytes]:
    """All files: names and bytes."""
    return {"hall.glb": hall()}


def hall() -> bytes:
    """Walls, floor, roof and two rows of columns; the view is from the north, where it is open."""
    writer = GltfWriter()
    stone = writer.material("sooty stone", (0.05, 0.045, 0.04))
    flags = writer.material("flags", (0.06, 0.055, 0.05))
    half, wall = _HALF_WIDTH_M, _WALL_M
    sides = [box((x, 0.0, 0.0), (x + wall, _HIGH_M, _DEEP_M)) for x in (-half - wall, half)]
    roof = box((-half - wall, _HIGH_M, 0.0), (half + wall, _HIGH_M + 1.0, _DEEP_M + wall))
    floor = box((-half, -0.5, 0.0), (half, 0.0, _DEEP_M))
    parts = {
        "walls": (joined([*sides, *_south_wall(), roof]), stone),
        "columns": (joined(_columns()), stone),
        "floor": (floor, flags),
    }
    for name, (shape, material) in parts.items():
        writer.place(name, writer.mesh(name, [(shape, material)]))
    writer.camera(_EYE_M, _TARGET_M, _FIELD_OF_VIEW_RAD)
    return writer.glb()


def _south_wall() -> list[PlainMesh]:
    half, near, far = _HALF_WIDTH_M + _WALL_M, _DEEP_M, _DEEP_M + _WALL_M
    shapes = [
        box((-half, 0.0, near), (half, _SILL_M, far)),
        box((-half, _LINTEL_M, near), (half, _HIGH_M, far)),
    ]
    edges = [-half, *(x + s * _WINDOW_M / 2 for x in _WINDOWS_M for s in (-1, 1)), half]
    for west, east in zip(edges[::2], edges[1::2], strict=True):
        shapes.append(box((west, _SILL_M, near), (east, _LINTEL_M, far)))
    return shapes


def _columns() -> list[PlainMesh]:
    profile = [(2.0, 0.0), (2.0, 1.2), (1.4, 1.7), (1.1, 25.0), (1.9, 27.0), (1.9, _HIGH_M)]
    return [lathe(profile, 24).moved(x, 0.0, z) for x in (-21.0, 21.0) for z in (20.0, 36.0, 52.0)]
