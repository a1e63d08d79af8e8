"""Meshes that deferred shading lights: each visible point once, after all triangles are drawn."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.frustum import bounds
from vrut_lite.render.passes.caster_renderer import is_all_solid
from vrut_lite.render.passes.programs import Program
from vrut_lite.render.passes.surface_buffer import MOST_SURFACES
from vrut_lite.render.passes.triangles import draw_whole_picture
from vrut_lite.render.passes.view import View
from vrut_lite.render.pyrender_scene import PlacedPrimitive
from vrut_lite.render.surface_terms import term_defines
from vrut_lite.render.tiles import Piece, set_scissor

# Mean pixels of a triangle from which shading it at once is as quick on Mesa's llvmpipe, and
# triangles of a picture up to which it is, since changes of the framebuffer take time.
MOST_TRIANGLE_PX = 100.0
LEAST_TRIANGLES = 1000


@dataclass(frozen=True)
class DeferredMeshes:
    """The deferred meshes of a picture: numbers, and boxes of pixels that contain them."""

    numbers: dict[PlacedPrimitive, int]
    boxes: dict[PlacedPrimitive, Piece]
    eye_from_clip: NDArray[np.float64]

    @staticmethod
    def among(
        placed_in_order: Iterable[PlacedPrimitive], view: View, size_px: tuple[int, int]
    ) -> "DeferredMeshes":
        """Those meshes that are shaded faster deferred, perhaps none."""
        boxes: dict[PlacedPrimitive, Piece] = {}
        triangles = 0
        for placed in placed_in_order:
            if len(boxes) < MOST_SURFACES and can_be_deferred(placed):
                box = _box_px(placed, view, size_px)
                if _triangle_px(placed, box) < MOST_TRIANGLE_PX:
                    boxes[placed] = box
                    triangles += _triangles(placed)
        if triangles < LEAST_TRIANGLES:
            boxes = {}
        numbers = {placed: 1 + number for number, placed in enumerate(boxes)}
        return DeferredMeshes(numbers, boxes, np.asarray(np.linalg.inv(view.clip_from_eye)))

    def within(self, placed: Iterable[PlacedPrimitive], piece: Piece) -> "DeferredMeshes":
        """Those of them that are among the meshes of a piece, with their pixels in it."""
        boxes = {each: self.boxes[each].within(piece) for each in placed if each in self.boxes}
        return replace(self, boxes=boxes, numbers={each: self.numbers[each] for each in boxes})

    def set_place(self, program: Program, placed: PlacedPrimitive) -> None:
        """Set the uniforms of a mesh's attributes."""
        first_px, size_px = placed.primitive.chart_px
        program.set_uniform("chart_first_px", first_px)
        program.set_uniform("chart_size_px", size_px)
        program.set_uniform("surface_number", self.numbers[placed])

    def draw(self, program: Program, placed: PlacedPrimitive) -> None:
        """Light the pixels of a mesh, within GL's scissor box."""
        program.set_uniform("eye_from_clip", self.eye_from_clip)
        self.set_place(program, placed)
        set_scissor(self.boxes[placed])
        draw_whole_picture(placed.primitive)


def can_be_deferred(placed: PlacedPrimitive) -> bool:
    """Whether the buffer has all attributes of a mesh: it is opaque, one-sided and without maps."""
    primitive, material = placed.primitive, placed.primitive.material
    maps = (
        material.baseColorTexture,
        material.normalTexture,
        material.occlusionTexture,
        material.emissiveTexture,
        material.metallicRoughnessTexture,
    )
    return (
        is_all_solid(material)
        and not placed.is_ground
        and not placed.is_two_sided
        and primitive.color_0 is None
        and all(each is None for each in maps)
        and not term_defines(material, blended=False)
    )


def _box_px(placed: PlacedPrimitive, view: View, size_px: tuple[int, int]) -> Piece:
    """The pixels that a mesh's bounding sphere may cover."""
    found = bounds(view.clip_from_eye, placed.centre_m - view.eye_m, placed.radius_m)
    (left, lower), (right, upper) = (0.5 + 0.5 * found) * size_px
    return Piece(int(left), int(lower), math.ceil(right), math.ceil(upper))


def _triangle_px(placed: PlacedPrimitive, box: Piece) -> float:
    """Mean pixels of a visible triangle, half of all, of a mesh that fills its box."""
    area = (box.right - box.left) * (box.upper - box.lower)
    return 2.0 * area / max(_triangles(placed), 1)


def _triangles(placed: PlacedPrimitive) -> int:
    return int(placed.primitive.indices.size) // 3
