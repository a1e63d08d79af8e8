"""How near to the sun and how far from it a shadow map's surfaces are, over wider and wider cells.

What lies in a cone of the sun's width before a point is bounded by one look-up a level, so that
only half shadows take many (after Dmitriev and Uralsky 2007, "Soft shadows using hierarchical
min-max shadow maps").
"""

from typing import Any

from vrut_lite.render.shader_files import defined, shader_source
from vrut_lite.render.unlocked import run_compute

# Texels along a cell of the first level that is looked up; sun_shadow.glsl has them too.
_FIRST_CELL = 8
# Of the coarsest level, 256 texels wide: no penumbra is followed farther than half of it.
LEVELS = 6
_GROUP = 8


class ShadowRanges:
    """Nearest and farthest depth, a mip level for each width of cells; used on the GL thread."""

    def __init__(self, context: Any, size: int):
        self._context = context
        source = shader_source("shadow_ranges.comp")
        self._first = context.compute_shader(defined(source, {"FIRST": 1}))
        self._further = context.compute_shader(source)
        self._cells = _with_levels(context, 2 * size // _FIRST_CELL)
        self.texture = _with_levels(context, size // _FIRST_CELL)

    def update(self, depths: Any) -> None:
        """Follow a depth texture (size, size)."""
        compared = depths.compare_func
        depths.compare_func = ""
        depths.use(location=0)
        self._cells.bind_to_image(0, read=False, write=True)
        groups = self._cells.size[0] // _GROUP
        run_compute(self._first, groups, groups, 1)
        self._cells.use(location=0)
        for level in range(LEVELS):
            self._context.memory_barrier()
            self._further["level"].value = level
            self._cells.bind_to_image(0, read=False, write=True, level=level + 1)
            self.texture.bind_to_image(1, read=False, write=True, level=level)
            groups = -(-(self.texture.size[0] >> level) // _GROUP)
            run_compute(self._further, groups, groups, 1)
        self._context.memory_barrier()
        depths.compare_func = compared

    def release(self) -> None:
        """Free everything."""
        for thing in (self.texture, self._cells, self._first, self._further):
            thing.release()


def _with_levels(context: Any, size: int) -> Any:
    """A texture of ranges with all its mip levels, undefined yet."""
    texture = context.texture((size, size), 2, dtype="f4")
    texture.build_mipmaps()
    texture.filter = (context.NEAREST_MIPMAP_NEAREST, context.NEAREST)
    texture.repeat_x = texture.repeat_y = False
    return texture
