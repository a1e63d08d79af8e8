"""Hierarchy of minimum and maximum depth in a shadow map's cells.

One look-up per level bounds the casters in a cone of the sun's width in front of a point, so that
only penumbras need many (after Dmitriev and Uralsky 2007, "Soft shadows using hierarchical min-max
shadow maps").
"""

from typing import Any

from vrut_lite.render.passes.full_screen import FullScreen

# Texels along a cell of the first level; sun_shadow.glsl repeats it and the last level's.
FIRST_CELL = 8
# Levels; a cell of the last is 256 texels wide, which limits penumbra radii to 128.
LEVELS = 6


class ShadowRanges:
    """Nearest and farthest depth around the corners of each level's cells.

    Made and used on the GL thread only.
    """

    def __init__(self, context: Any, size: int):
        self._context = context
        self._first, self._wider, self._corners = (
            FullScreen(context, "shadow_ranges.frag", names)
            for names in (("FIRST",), (), ("CORNERS",))
        )
        cells = size // FIRST_CELL
        self._cells = [_ranges(context, cells >> level, cells >> level) for level in range(LEVELS)]
        self._buffers = [context.framebuffer([texture]) for texture in self._cells]
        # All levels side by side: software renderers are slow at fetching from a mip level.
        self.texture = _ranges(context, 2 * cells, cells)
        self._buffer = context.framebuffer([self.texture])
        # Cleared, since it is sampled before the first sun too: garbage may be NaN.
        self._buffer.clear(0.0, 1.0)

    def update(self, depths: Any, changed: tuple[int, int, int, int]) -> None:
        """Update from depths (size, size) that `changed` in these cells: corner and size."""
        context = self._context
        context.disable(context.DEPTH_TEST | context.CULL_FACE | context.BLEND)
        compared = depths.compare_func
        depths.compare_func = ""
        depths.use(location=0)
        self._buffers[0].scissor = changed
        self._buffers[0].use()
        self._first.draw()
        self._buffers[0].scissor = None
        depths.compare_func = compared
        left = 0
        for finer, texture, buffer in zip(
            [None, *self._cells[:-1]], self._cells, self._buffers, strict=True
        ):
            if finer is not None:
                finer.use(location=0)
                buffer.use()
                self._wider.draw()
            texture.use(location=0)
            self._buffer.viewport = (left, 0, *texture.size)
            self._buffer.use()
            self._corners.draw()
            left += texture.size[0]

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        for thing in (*self._buffers, self._buffer, *self._cells, self.texture, self._first,
                      self._wider, self._corners):  # fmt: skip
            thing.release()


def _ranges(context: Any, width: int, height: int) -> Any:
    texture = context.texture((width, height), 2, dtype="f4")
    texture.filter = (context.NEAREST, context.NEAREST)
    texture.repeat_x = texture.repeat_y = False
    return texture
