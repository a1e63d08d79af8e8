"""How near to the sun and how far from it a shadow map's surfaces are, over wider and wider cells.

What lies in a cone of the sun's width before a point is bounded by one look-up a level, so that
only half shadows take many (after Dmitriev and Uralsky 2007, "Soft shadows using hierarchical
min-max shadow maps").
"""

from typing import Any

from vrut_lite.render.shader_files import defined, shader_source
from vrut_lite.render.unlocked import run_compute

# Texels along a cell of the first level; sun_shadow.glsl has it and the last level too.
_FIRST_CELL = 8
# Of the coarsest level, 256 texels wide: no penumbra is followed farther than half of it.
LEVELS = 6
_GROUP = 8


class ShadowRanges:
    """Nearest and farthest depth around the corners of cells, of each width.

    Made and used on the GL thread only.
    """

    def __init__(self, context: Any, size: int):
        self._context = context
        source = shader_source("shadow_ranges.comp")
        self._first, self._wider, self._corners = (
            context.compute_shader(defined(source, dict.fromkeys(names, 1)))
            for names in (["FIRST"], [], ["CORNERS"])
        )
        cells = size // _FIRST_CELL
        self._cells = context.texture((cells, cells), 2, dtype="f4")
        self._cells.build_mipmaps()
        # All levels side by side: software renderers are slow at fetching from a level.
        self.texture = context.texture((2 * cells, cells), 2, dtype="f4")
        self.texture.filter = (context.NEAREST, context.NEAREST)

    def update(self, depths: Any) -> None:
        """Follow a depth texture (size, size)."""
        compared = depths.compare_func
        depths.compare_func = ""
        depths.use(location=0)
        self._run(self._first, self._cells, 0, 0)
        depths.compare_func = compared
        self._cells.use(location=0)
        for level in range(1, LEVELS):
            self._wider["level"].value = level - 1
            self._run(self._wider, self._cells, level, level)
        for level in range(LEVELS):
            self._corners["level"].value = level
            self._corners["left"].value = 2 * (self._cells.size[0] - (self._cells.size[0] >> level))
            self._run(self._corners, self.texture, 0, level)

    def release(self) -> None:
        """Free everything."""
        for thing in (self.texture, self._cells, self._first, self._wider, self._corners):
            thing.release()

    def _run(self, program: Any, into: Any, into_level: int, level: int) -> None:
        into.bind_to_image(0, read=False, write=True, level=into_level)
        groups = -(-(self._cells.size[0] >> level) // _GROUP)
        run_compute(program, groups, groups, 1)
        self._context.memory_barrier()
