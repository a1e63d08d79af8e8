"""Decides which meshes a view can show."""

import math
from dataclasses import replace

import numpy as np

from vrut_lite.frame_part import SUN_GLOW_RAD
from vrut_lite.render.frustum import reaches
from vrut_lite.render.passes.view import View
from vrut_lite.render.pyrender_scene import PlacedPrimitive
from vrut_lite.render.tiles import Piece


def in_view(placed: PlacedPrimitive, view: View) -> bool:
    """Whether a mesh's bounding sphere may intersect the view; conservative."""
    return reaches(view.clip_from_eye, placed.centre_m - view.eye_m, placed.radius_m)


def has_glow(view: View, sun_direction: tuple[float, float, float]) -> bool:
    """Whether the glow around the sun may be in the picture, `SUN_GLOW_RAD` wide; conservative."""
    return reaches(view.clip_from_eye, np.array(sun_direction), math.sin(SUN_GLOW_RAD))


def part_of(view: View, size: tuple[int, int], piece: Piece) -> View:
    """The view of a piece of a picture of this size, for culling."""
    projection = view.projection.copy()
    for axis, (low, high) in enumerate(((piece.left, piece.right), (piece.lower, piece.upper))):
        # Clip coordinates 2 low / size - 1 and 2 high / size - 1 become -1 and 1.
        offset = (size[axis] - low - high) / size[axis]
        scale = size[axis] / (high - low)
        projection[axis] = (projection[axis] + offset * projection[3]) * scale
    return replace(view, projection=projection)
