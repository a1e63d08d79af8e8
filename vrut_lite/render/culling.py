"""Decides which meshes a view can show."""

from dataclasses import replace

from vrut_lite.render.frustum import reaches
from vrut_lite.render.passes.view import View
from vrut_lite.render.pyrender_scene import PlacedPrimitive
from vrut_lite.render.tiles import Piece


def in_view(placed: PlacedPrimitive, view: View) -> bool:
    """Whether the sphere around a mesh reaches into the view: a conservative answer."""
    return reaches(view.clip_from_eye, placed.centre_m - view.eye_m, placed.radius_m)


def part_of(view: View, size: tuple[int, int], piece: Piece) -> View:
    """The view of a piece of a picture of this size, for culling."""
    projection = view.projection.copy()
    for axis, (low, high) in enumerate(((piece.left, piece.right), (piece.lower, piece.upper))):
        # In clip space -1 is to be where 2 low / size - 1 was, and 1 where 2 high / size - 1 was.
        offset = (size[axis] - low - high) / size[axis]
        scale = size[axis] / (high - low)
        projection[axis] = (projection[axis] + offset * projection[3]) * scale
    return replace(view, projection=projection)
