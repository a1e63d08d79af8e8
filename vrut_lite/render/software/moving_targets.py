"""The framebuffers of moving pictures, with one sample per pixel."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL

from vrut_lite.render.reversed_depth import DepthTexture
from vrut_lite.render.unlocked import read_bytes


class Drawn:
    """Radiance and depth in 32-bit floats, both sampled by shaders."""

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
        """Copy another picture's radiance and depth."""
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
    """Framebuffers of radiance, and the picture for display.

    `now` contains opaque surfaces and the sky, and then a copy of them with frame parts and blended
    surfaces, if there are any. `buffer` is its framebuffer, by the name that it has in `Targets`.
    """

    def __init__(self, context: Any, size: tuple[int, int]):
        self.size = size
        self._context = context
        self._solid = Drawn(context, size)
        self._over: Drawn | None = None
        self.now = self._solid
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

    def begin(self) -> None:
        """Draw opaque surfaces and the sky from now on."""
        self.now = self._solid
        self.now.buffer.use()

    def draw_over(self) -> None:
        """Draw into a copy from now on; the opaque picture stays for the next one."""
        if self._over is None:
            self._over = Drawn(self._context, self.size)
        self._over.take(self.now)
        self.now = self._over

    def read_toned(self) -> NDArray[np.uint32]:
        """Tone-mapped picture (h, w) from below: red, green, blue, luma from the lowest byte."""
        return read_bytes(self._toned).view("<u4")[..., 0]

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        over = () if self._over is None else (self._over,)
        for thing in (self._solid, *over, self.toned, self._toned):
            thing.release()
