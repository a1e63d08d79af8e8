"""A white plate with a vertical gnomon: its shadow can be measured from above.

The gnomon is 1 m high above the plate and stands at the origin; the plate reaches six times
as far, for shadows down to a sun 9.5 degrees high. All marks lie outside the plate.
"""

import numpy as np

from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.shapes import (
    PlainMesh,
    box,
    disc,
    joined,
    lathe,
    obelisk,
    polygon,
    sector,
)

GNOMON_HEIGHT_M = 1.0
PLATE_RADIUS_M = 6.0
_RING_M = (6.0, 6.6)
_RIM_M = 7.8
_LETTER_M = 7.2


def build() -> dict[str, bytes]:
    """File names and their bytes."""
    writer = GltfWriter()
    white = writer.material("white plaster", (0.80, 0.80, 0.78))
    stone = writer.material("grey stone", (0.38, 0.37, 0.35))
    dark = writer.material("slate", (0.06, 0.06, 0.065), roughness=0.7)
    red = writer.material("red enamel", (0.55, 0.04, 0.03), roughness=0.4)
    bronze = writer.material("bronze", (0.50, 0.32, 0.17), roughness=0.45, metallic=1.0)
    marks, gaps = _ring()
    # The white ring below shows through where arcs of different steps leave slivers.
    below = disc(_RING_M[1] + 0.2, -0.01, 120, _RING_M[0] - 0.2)
    plate = writer.mesh("plate", [(joined([disc(PLATE_RADIUS_M, 0.0, 120), below]), white)])
    rim = joined(
        [
            disc(_RIM_M, 0.0, 120, _RING_M[1]),
            lathe([(8.2, -0.24), (8.2, -0.12), (_RIM_M, -0.12), (_RIM_M, 0.0)], 120),
        ]
    )
    ring = writer.mesh("ring", [(rim, stone), (gaps, white), (marks, dark)])
    north, others = _letters()
    letters = writer.mesh("letters", [(north, red), (others, dark)])
    gnomon = writer.mesh(
        "gnomon", [(obelisk(0.07, 0.035, 0.94 * GNOMON_HEIGHT_M, GNOMON_HEIGHT_M), bronze)]
    )
    for name, mesh in (("plate", plate), ("ring", ring), ("letters", letters), ("gnomon", gnomon)):
        writer.place(name, mesh)
    writer.camera((-5.9, 2.5, 8.0), (0.1, 0.2, -0.6), 0.75)
    return {"sundial.glb": writer.glb()}


def _ring() -> tuple[PlainMesh, PlainMesh]:
    """Marks each 15 degrees, wide each 45 degrees, and the plain pieces between."""
    marks, gaps, end = [], [], -180.0 - 2.0
    for azimuth in range(-180, 180, 15):
        if azimuth == 0:
            continue  # The arrow stands there.
        half = 1.2 if azimuth % 45 == 0 else 0.45
        if azimuth > -180:
            gaps.append(sector(_RING_M, (end, azimuth - half), 0.0))
        marks.append(sector(_RING_M, (azimuth - half, azimuth + half), 0.0))
        end = azimuth + half
    gaps.append(sector(_RING_M, (end, 180.0 - 1.2), 0.0))
    return joined(marks), joined(gaps)


def _letters() -> tuple[PlainMesh, PlainMesh]:
    """A red N with an arrow; E, S and W; each upright for a reader who faces it from the middle."""
    arrow = polygon([(-0.28, 0.0, -6.05), (0.28, 0.0, -6.05), (0.0, 0.0, -6.55)])
    arrow = arrow.moved(y=0.02)
    strokes = {
        "N": [(-0.2, -0.3, -0.2, 0.3), (-0.2, 0.3, 0.2, -0.3), (0.2, -0.3, 0.2, 0.3)],
        "E": [(-0.2, -0.3, -0.2, 0.3), *((-0.2, y, 0.2, y) for y in (-0.3, 0.0, 0.3))],
        "S": [
            *((-0.2, y, 0.2, y) for y in (-0.3, 0.0, 0.3)),
            (-0.2, 0.0, -0.2, 0.3),
            (0.2, -0.3, 0.2, 0.0),
        ],
        "W": [
            (-0.28, 0.3, -0.14, -0.3),
            (-0.14, -0.3, 0.0, 0.2),
            (0.0, 0.2, 0.14, -0.3),
            (0.14, -0.3, 0.28, 0.3),
        ],
    }
    placed = {
        letter: joined([_stroke(*ends) for ends in lines])
        .moved(z=-_LETTER_M)
        .turned(90.0 * "NESW".index(letter))
        for letter, lines in strokes.items()
    }
    return joined([placed["N"], arrow]), joined([placed[letter] for letter in "ESW"])


def _stroke(x0: float, y0: float, x1: float, y1: float) -> PlainMesh:
    """A raised bar of a letter that lies on the ground, its top to the north."""
    length = float(np.hypot(x1 - x0, y1 - y0)) + 0.09
    bar = box((-0.045, 0.0, -length / 2), (0.045, 0.03, length / 2))
    azimuth_deg = float(np.degrees(np.arctan2(x1 - x0, y1 - y0)))
    return bar.turned(azimuth_deg).moved(x=(x0 + x1) / 2, z=-(y0 + y1) / 2)
