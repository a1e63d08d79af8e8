"""The framebuffers of deferred shading: attributes of visible surfaces, and the light of each.

Where a processor renders, a triangle costs as many pixels as the blocks of 4 x 4 pixels that it
touches: a sphere of 4000 triangles in 6000 pixels is shaded six times. Deferred shading (Saito and
Takahashi 1990, "Comprehensible rendering of 3-D shapes") draws its triangles with a shader of a few
instructions, and shades each block once.
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from OpenGL import GL

from vrut_lite.render.graphics_memory import allocated
from vrut_lite.render.passes.full_screen import FullScreen
from vrut_lite.render.reversed_depth import DepthTexture
from vrut_lite.render.tiles import Piece, set_scissor

# Texture units of surface_buffer.glsl.
_ATTRIBUTES_UNIT, _DEPTH_UNIT = 36, 37
# Number of surfaces that 8 bits tell apart; 0 marks a pixel without one.
MOST_SURFACES = 255


class SurfaceBuffer:
    """Attributes and numbers of the surfaces in a picture; made and used on the GL thread only."""

    def __init__(self, context: Any, drawn: Any, radiance: Any, depth: DepthTexture):
        """`drawn`: the framebuffer of the picture's `radiance` and `depth`."""
        self.size: tuple[int, int] = radiance.size
        self._drawn, self._depth = drawn, depth
        self._numbers = DepthTexture(self.size)
        make = partial(context.texture, self.size, 4, dtype="u4")
        what = f"the surfaces of a picture of {self.size[0]} x {self.size[1]}"
        (self._attributes,) = allocated(context, what, make)
        self._attributes.filter = (context.NEAREST, context.NEAREST)
        self._written = context.framebuffer([self._attributes])
        self._lit = context.framebuffer([radiance])
        for buffer, its_depth in ((self._written, depth), (self._lit, self._numbers)):
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, buffer.glo)
            its_depth.attach()
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, drawn.glo)
        self._number = FullScreen(context, "surface_numbers.frag")

    def begin(self, boxes: Iterable[Piece]) -> None:
        """Bind attributes and the picture's depth; no pixel in these boxes has a surface."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._written.glo)
        for box in boxes:
            set_scissor(box)
            GL.glClearBufferuiv(GL.GL_COLOR, 0, (0, 0, 0, 0))

    def number(self, boxes: Iterable[Piece]) -> None:
        """Find the pixels of the surfaces drawn in these boxes since `begin`; bind the picture."""
        self._numbers.bind()
        self._attributes.use(location=_ATTRIBUTES_UNIT)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthMask(GL.GL_TRUE)
        GL.glDepthFunc(GL.GL_ALWAYS)
        GL.glDisable(GL.GL_CULL_FACE)
        for box in boxes:
            set_scissor(box)
            self._number.draw()
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._drawn.glo)

    @contextmanager
    def lit(self) -> Iterator[None]:
        """Draw into the radiance, with surfaces' numbers as its depth."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._lit.glo)
        self._depth.use(_DEPTH_UNIT)
        try:
            yield
        finally:
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._drawn.glo)

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        for thing in (self._written, self._lit, self._numbers, self._attributes, self._number):
            thing.release()
