"""The framebuffers of a picture while something moves: one sample a pixel."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL

from vrut_lite.render.reversed_depth import DepthTexture
from vrut_lite.render.unlocked import read_bytes, read_rgba

# Smooths half of a picture, while the GL thread smooths the other.
_other_half = ThreadPoolExecutor(1, "edges")


class Drawn:
    """Radiance and depth in 32-bit floats, both of which shaders read."""

    def __init__(self, context: Any, size: tuple[int, int]):
        self.size = size
        self.radiance = context.texture(size, 4, dtype="f4")
        self.radiance.filter = (context.LINEAR, context.LINEAR)
        self.radiance.repeat_x = self.radiance.repeat_y = False
        self.depth = DepthTexture(size)
        self.buffer = context.framebuffer([self.radiance])
        self.buffer.use()
        self.depth.attach()

    def take(self, other: "Drawn") -> None:
        """Be the copy of another picture."""
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, other.buffer.glo)
        GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, self.buffer.glo)
        box, both = (0, 0, *self.size), GL.GL_COLOR_BUFFER_BIT | GL.GL_DEPTH_BUFFER_BIT
        GL.glBlitFramebuffer(*box, *box, both, GL.GL_NEAREST)
        self.buffer.use()

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        for thing in (self.buffer, self.radiance, self.depth):
            thing.release()


class MovingTargets:
    """What is drawn into in turns, and what is shown.

    `front` is the depth of solid surfaces; `drawn` is what is solid and the sky, now and before;
    `over` has what shows these too, where there is any. `buffer` is that of the pictures that
    passes draw into just now, by the name that it has in `Targets`.
    """

    def __init__(self, context: Any, size: tuple[int, int]):
        self.size = size
        self.front = DepthTexture(size)
        self._context = context
        self._drawn = [Drawn(context, size), Drawn(context, size)]
        self._over: Drawn | None = None
        self.now = self._drawn[0]
        self._toned = context.texture(size, 4)
        self.toned = context.framebuffer([self._toned])

    @property
    def buffer(self) -> Any:
        """The framebuffer that is drawn into."""
        return self.now.buffer

    @property
    def radiance(self) -> Any:
        """The texture of that framebuffer."""
        return self.now.radiance

    @property
    def samples(self) -> int:
        """Samples of all pixels."""
        return self.size[0] * self.size[1]

    def begin(self) -> Drawn:
        """Draw into the one of the two pictures that was not drawn last; returns it."""
        self._drawn.reverse()
        self.now = self._drawn[0]
        return self.now

    def draw_over(self) -> None:
        """Draw into a copy from now on: the next picture takes over what is solid."""
        if self._over is None:
            self._over = Drawn(self._context, self.size)
        self._over.take(self.now)
        self.now = self._over

    def read_radiance(self) -> NDArray[np.float32]:
        """The picture (h, w, 3) before the tone map, row 0 at the top; a view."""
        return read_rgba(self.radiance)[::-1, :, :3]

    def read_display(self) -> NDArray[np.uint8]:
        """The picture (h, w, 3) for display, its edges smoothed, row 0 at the top."""
        # numba, which no other program of this package needs.
        from vrut_lite.render.edge_kernel import smooth_edges

        toned = read_bytes(self._toned).view("<u4")[..., 0]
        display = np.empty((*toned.shape, 3), np.uint8)
        half, end = len(toned) // 2, len(toned)
        upper = _other_half.submit(smooth_edges, toned, display, half, end)
        smooth_edges(toned, display, 0, half)
        upper.result()
        return display

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        over = () if self._over is None else (self._over,)
        for thing in (self.front, *self._drawn, *over, self.toned, self._toned):
            thing.release()
