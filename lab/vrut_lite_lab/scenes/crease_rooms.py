"""Random rooms full of creases: boxes with a window, columns, tables with legs, beams, sills."""

import numpy as np

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.tolerance.light_transport import TrialRoom

_WALL_M = 0.3


def crease_room(rng: np.random.Generator) -> TrialRoom:
    """A room, in boxes (B, 6): every second one with walls that end on its floor, not beside it."""
    wide, high, deep = rng.uniform((3.0, 2.4, 3.0), (9.0, 4.0, 9.0))
    w, sill, head = _WALL_M, rng.uniform(0.0, 0.3) * high, rng.uniform(0.6, 0.9) * high
    left, right = rng.uniform(0.1, 0.4) * wide, rng.uniform(0.6, 0.9) * wide
    # Walls stand on the floor and below the ceiling, or go on beside both.
    low, top = (0.0, high) if rng.random() < 0.5 else (-w, high + w)
    boxes: list[tuple[float, ...]] = [
        (-w, -w, -w, wide + w, 0.0, deep + w),
        (-w, high, -w, wide + w, high + w, deep + w),
        (-w, low, -w, 0.0, top, deep + w),
        (wide, low, -w, wide + w, top, deep + w),
        (0.0, low, -w, wide, top, 0.0),
        (0.0, low, deep, left, top, deep + w),
        (right, low, deep, wide, top, deep + w),
        (left, low, deep, right, sill + 0.01, deep + w),
        (left, head, deep, right, top, deep + w),
    ]
    for _ in range(int(rng.integers(1, 4))):
        boxes += _table(rng, wide, deep)
    for _ in range(int(rng.integers(0, 4))):
        x, z, size = (
            rng.uniform(0.3, wide - 0.7),
            rng.uniform(0.3, deep - 0.7),
            rng.uniform(0.1, 0.5),
        )
        boxes.append((x, 0.0, z, x + size, high, z + size))
    for _ in range(int(rng.integers(0, 3))):
        z, thick = rng.uniform(0.2, deep - 0.6), rng.uniform(0.08, 0.4, 2)
        boxes.append((0.0, high - thick[0], z, wide, high, z + thick[1]))
    paint = tuple(rng.uniform(0.1, 0.8, len(boxes)).tolist())
    azimuth, elevation = rng.uniform(-1.0, 1.0), rng.uniform(0.2, 1.2)
    level = float(np.cos(elevation))
    sun = (level * float(np.sin(azimuth)), float(np.sin(elevation)), level * float(np.cos(azimuth)))
    return TrialRoom(tuple(tuple(float(value) for value in box) for box in boxes), paint, sun)


def inside_of(room: TrialRoom) -> FloatArray:
    """The corners (2, 3) of a room's inside with its window's reveals."""
    ceiling, left, right = room.boxes[1], room.boxes[2], room.boxes[3]
    skin = 1e-3
    lower = left[3] - skin, -skin, -skin
    return np.array([lower, (right[0] + skin, ceiling[1] + skin, ceiling[5] - skin)])


def _table(rng: np.random.Generator, wide: float, deep: float) -> list[tuple[float, ...]]:
    """A top on four legs."""
    x, z = rng.uniform(0.2, wide - 1.4), rng.uniform(0.2, deep - 1.2)
    size, high = rng.uniform((0.6, 0.5), (1.2, 0.9)), rng.uniform(0.4, 0.8)
    leg, thick = rng.uniform(0.03, 0.08), rng.uniform(0.02, 0.05)
    boxes: list[tuple[float, ...]] = [(x, high, z, x + size[0], high + thick, z + size[1])]
    for u in (x, x + size[0] - leg):
        for v in (z, z + size[1] - leg):
            boxes.append((u, 0.0, v, u + leg, high, v + leg))
    return boxes
