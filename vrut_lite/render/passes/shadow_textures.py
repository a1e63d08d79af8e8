"""The textures of a shadow map: depth from the sun, its ranges, and what glass leaves of light."""

from collections.abc import Iterable
from typing import Any

from vrut_lite.render.light import Shadow
from vrut_lite.render.passes.mesh_renderer import MeshRenderer
from vrut_lite.render.passes.shadow_ranges import ShadowRanges
from vrut_lite.render.pyrender_scene import PyrenderScene


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

    @property
    def ranges(self) -> Any:
        """The texture of `ShadowRanges`."""
        return self._ranges.texture

    def tint_of(self, scene: PyrenderScene) -> Any:
        """The texture of what glass leaves, made when a scene first has some; None without."""
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
        """Draw shadows into squares of so many texels, each from its lower left corner on."""
        shadows = list(shadows)
        has_tint = self.tint_of(scene) is not None
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
                # With the depth: what is behind solid things tints nothing.
                self._tint_buffer.viewport = (*corner, texels, texels)
                self._tint_buffer.use()
                meshes.draw_tint(scene, shadow, texels)
        self._ranges.update(self.depth)

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        for thing in (self._tint_buffer, self._tint_alone, self._tint, self._buffer, self.depth,
                      self._ranges):  # fmt: skip
            if thing is not None:
                thing.release()
