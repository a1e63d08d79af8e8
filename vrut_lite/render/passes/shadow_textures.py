"""The textures of a shadow map: depth from the sun, its ranges, and transmittance of glass.

A map is as wide as the scene from any side. Only texels that the scene covers now, or covered
before, are cleared and read.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from vrut_lite.render.light import Shadow
from vrut_lite.render.passes.mesh_renderer import MeshRenderer
from vrut_lite.render.passes.shadow_ranges import FIRST_CELL, ShadowRanges
from vrut_lite.render.pyrender_scene import PyrenderScene


class Box(NamedTuple):
    """A box of texels from the left and from below; right and upper are excluded."""

    left: int
    lower: int
    right: int
    upper: int

    def joined(self, other: "Box") -> "Box":
        """The smallest box that contains both."""
        low, high = np.minimum(self, other), np.maximum(self, other)
        return Box(int(low[0]), int(low[1]), int(high[2]), int(high[3]))

    def scissor(self, texels: int = 1) -> tuple[int, int, int, int]:
        """Corner and size for OpenGL, in cells of `texels` along an edge."""
        left, lower = (side // texels for side in self[:2])
        return left, lower, -(-self.right // texels) - left, -(-self.upper // texels) - lower


class ShadowTextures:
    """Square textures of `size` texels; made and used on the GL thread only."""

    def __init__(self, context: Any, size: int):
        self._context = context
        self._size = size
        self.depth = context.depth_texture((size, size))
        self.depth.compare_func = "<="
        self.depth.filter = (context.LINEAR, context.LINEAR)
        self._buffer = context.framebuffer(depth_attachment=self.depth)
        self._ranges = ShadowRanges(context, size)
        self._tint: Any = None
        self._tint_buffer: Any = None
        self._tint_alone: Any = None
        # Texels that may have been drawn.
        self._filled = Box(0, 0, size, size)

    @property
    def ranges(self) -> Any:
        """The texture of `ShadowRanges`."""
        return self._ranges.texture

    def tint_of(self, scene: PyrenderScene) -> Any:
        """The transmittance of glass, created for the first scene with glass; None without."""
        if not scene.dims_sun:
            return None
        if self._tint is None:
            size = (self._size, self._size)
            self._tint = self._context.texture(size, 4, dtype="f2")
            self._tint.repeat_x = self._tint.repeat_y = False
            self._tint_buffer = self._context.framebuffer([self._tint], self.depth)
            self._tint_alone = self._context.framebuffer([self._tint])
        return self._tint

    def draw(
        self,
        meshes: MeshRenderer,
        scene: PyrenderScene,
        shadows: Iterable[tuple[Shadow, tuple[int, int]]],
        texels: int,
    ) -> None:
        """Draw shadows into squares of `texels` a side, each with its lower left corner."""
        shadows = list(shadows)
        has_tint = self.tint_of(scene) is not None
        filled = covered(scene, shadows, texels)
        anew, self._filled = self._filled.joined(filled), filled
        self._buffer.scissor = anew.scissor()
        self._buffer.viewport = (0, 0, self._size, self._size)
        self._buffer.use()
        self._buffer.clear()
        if has_tint:
            self._tint_alone.clear(1.0, 1.0, 1.0, 1.0)
        for shadow, corner in shadows:
            self._buffer.viewport = (*corner, texels, texels)
            self._buffer.use()
            meshes.draw_depth(scene, shadow)
            if has_tint:
                # With the depth test: glass behind opaque surfaces tints nothing.
                self._tint_buffer.viewport = (*corner, texels, texels)
                self._tint_buffer.use()
                meshes.draw_tint(scene, shadow, texels)
        self._buffer.scissor = None
        self._ranges.update(self.depth, anew.scissor(FIRST_CELL))

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        for thing in (self._tint_buffer, self._tint_alone, self._tint, self._buffer, self.depth,
                      self._ranges):  # fmt: skip
            if thing is not None:
                thing.release()


def covered(
    scene: PyrenderScene, shadows: Iterable[tuple[Shadow, tuple[int, int]]], texels: int
) -> Box:
    """Texels that a scene may cover in squares, each with its lower left corner."""
    found: Box | None = None
    for shadow, corner in shadows:
        middle = shadow.matrix[:2, :3] @ (scene.centre_m - shadow.centre_m) + shadow.matrix[:2, 3]
        half = np.abs(shadow.matrix[:2, :3]) @ scene.half_extent_m
        # A texel more each way, for rounding.
        low = np.floor((0.5 + 0.5 * (middle - half)) * texels) - 1.0
        high = np.ceil((0.5 + 0.5 * (middle + half)) * texels) + 1.0
        low, high = (np.clip(side, 0, texels).astype(int) + corner for side in (low, high))
        box = Box(*low.tolist(), *high.tolist())
        found = box if found is None else found.joined(box)
    return found or Box(0, 0, 0, 0)
