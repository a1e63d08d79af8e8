"""The framebuffers, buffers and fences of a graphics card's moving pictures, of one size."""

import weakref
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.errors import UserError
from vrut_lite.render.context_loss import ContextLostError
from vrut_lite.render.graphics_memory import allocated
from vrut_lite.render.reversed_depth import FloatDepth
from vrut_lite.render.targets import SAMPLES
from vrut_lite.render.unlocked import read_rgba

from OpenGL import GL  # isort: skip  (after `reversed_depth`, which prepares it)


# Calls work on the GL thread and returns its result.
CallGl = Callable[[Callable[[Any], Any]], Any]
# Time after which a card that has not finished a picture is given up.
LONGEST_S = 10.0


def no_answer() -> ContextLostError:
    """A card that does not finish a picture is as good as lost."""
    return ContextLostError(f"it has not finished a picture in {LONGEST_S:g} s")


class LentRadiance:
    """A picture's radiance on the card, not overwritten while this object is referenced."""

    def __init__(self, texture: Any):
        self._texture: Any = texture

    def read(self, call_gl: CallGl) -> NDArray[np.float32]:
        """The radiance (h, w, 3), row 0 at the top; on any thread but that of GL.

        Raises:
            UserError: it was released, its context was lost, or the host is closed.
        """
        found: NDArray[np.float32] = call_gl(self._read)
        return found[::-1, :, :3]

    def _read(self, context: Any) -> NDArray[np.float32]:
        if self._texture is None or self._texture.ctx is not context:
            raise UserError("the picture's radiance left the graphics card: draw it again")
        return read_rgba(self._texture)

    def forget(self) -> None:
        """The texture is released."""
        self._texture = None


class _Radiance:
    """A texture of resolved radiance, and who still refers to it."""

    def __init__(self, context: Any, size: tuple[int, int]):
        make = partial(context.texture, size, 4, dtype="f4")
        self.texture = allocated(context, _picture_of(size), make)[0]
        self.buffer = context.framebuffer([self.texture])
        self._lent: weakref.ref[LentRadiance] | None = None

    @property
    def is_free(self) -> bool:
        return self._lent is None or self._lent() is None

    def lend(self) -> LentRadiance:
        lent = LentRadiance(self.texture)
        self._lent = weakref.ref(lent)
        return lent

    def release(self) -> None:
        lent = None if self._lent is None else self._lent()
        if lent is not None:
            lent.forget()
        self.buffer.release()
        self.texture.release()


class CardTargets:
    """Multisampled radiance to draw into, resolved radiance, and the displayed picture.

    `has_one_sample` and `samples` are as in `Targets`.
    """

    has_one_sample = False

    def __init__(self, context: Any, size: tuple[int, int]):
        self.size = size
        self.samples = size[0] * size[1] * SAMPLES
        self._context = context
        self._colour, self.display_texture = allocated(
            context,
            _picture_of(size),
            partial(context.renderbuffer, size, 4, samples=SAMPLES, dtype="f4"),
            partial(context.texture, size, 4),
        )
        self.buffer = context.framebuffer([self._colour])
        self._depth = FloatDepth(self.buffer, size, SAMPLES)
        self._resolved: list[_Radiance] = []
        self.display = context.framebuffer([self.display_texture])

    def resolve(self) -> tuple[Any, LentRadiance]:
        """Resolve the drawn frame into a texture that no picture refers to."""
        free = next((each for each in self._resolved if each.is_free), None)
        if free is None:
            free = _Radiance(self._context, self.size)
            self._resolved.append(free)
        self._context.copy_framebuffer(free.buffer, self.buffer)
        return free.texture, free.lend()

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        self.buffer.release()
        self._colour.release()
        self.display.release()
        for thing in (*self._resolved, self._depth, self.display_texture):
            thing.release()


class Fence:
    """Signals when the card has done all that was asked of it before; on the GL thread."""

    def __init__(self) -> None:
        self._sync = GL.glFenceSync(GL.GL_SYNC_GPU_COMMANDS_COMPLETE, 0)
        GL.glFlush()

    def is_signalled(self) -> bool:
        """Whether it is done; returns at once."""
        return self._wait(0)

    def wait(self) -> None:
        """Wait until it is done.

        Raises:
            ContextLostError: the card does not answer.
        """
        if not self._wait(round(1e9 * LONGEST_S)):
            raise no_answer()

    def _wait(self, timeout_ns: int) -> bool:
        if self._sync is None:
            return True
        said = GL.glClientWaitSync(self._sync, GL.GL_SYNC_FLUSH_COMMANDS_BIT, timeout_ns)
        if said == GL.GL_TIMEOUT_EXPIRED:
            return False
        GL.glDeleteSync(self._sync)
        self._sync = None
        return True


def _picture_of(size: tuple[int, int]) -> str:
    return f"a picture of {size[0]} x {size[1]}"
