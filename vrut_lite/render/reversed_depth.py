"""A depth buffer that holds a street and a mountain range at once.

Depth is near / distance in 32-bit floats, 1 at the near plane and 0 at infinity: the float's
own exponent then gives a nearly constant relative precision (Reed 2015, "Depth Precision
Visualized"), so that the near plane can be a finger's breadth away in a scene of any size.
"""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.gl_environment import import_pyrender

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)
from OpenGL.platform import PLATFORM  # noqa: E402

# Constants of glClipControl (OpenGL 4.5, ARB_clip_control), which PyOpenGL 3.1.0 lacks.
_ZERO_TO_ONE, _NEGATIVE_ONE_TO_ONE = 0x935F, 0x935E
# Least depth of surfaces. Pictures of one sample give the sky a smaller one
# (`software/reprojection_kernel.py`).
BEFORE_SKY = 1e-20


@lru_cache(maxsize=1)
def _clip_control() -> Any:
    address = PLATFORM.getExtensionProcedure(b"glClipControl")
    if not address:
        raise RuntimeError("this OpenGL has no glClipControl: version 4.5 or newer is needed")
    return ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.c_uint)(address)


@contextmanager
def reversed_depth() -> Iterator[None]:
    """Draw with reversed depth into the bound framebuffer, its depth cleared."""
    _clip_control()(GL.GL_LOWER_LEFT, _ZERO_TO_ONE)
    GL.glDepthMask(GL.GL_TRUE)
    GL.glClearDepth(0.0)
    GL.glClear(GL.GL_DEPTH_BUFFER_BIT)
    GL.glDepthFunc(GL.GL_GREATER)
    try:
        yield
    finally:
        # moderngl and pyrender both rely on the defaults.
        GL.glClearDepth(1.0)
        GL.glDepthFunc(GL.GL_LESS)
        _clip_control()(GL.GL_LOWER_LEFT, _NEGATIVE_ONE_TO_ONE)


class DepthTexture:
    """32-bit float depth texture with one sample per pixel, which moderngl lacks.

    Its own framebuffer `glo` holds nothing else.
    """

    def __init__(self, size: tuple[int, int]):
        self.size = size
        # A unit whose texture is set before each use: others keep theirs.
        GL.glActiveTexture(GL.GL_TEXTURE0)
        self._texture = int(GL.glGenTextures(1))
        GL.glBindTexture(GL.GL_TEXTURE_2D, self._texture)
        GL.glTexStorage2D(GL.GL_TEXTURE_2D, 1, GL.GL_DEPTH_COMPONENT32F, *size)
        for name in (GL.GL_TEXTURE_MIN_FILTER, GL.GL_TEXTURE_MAG_FILTER):
            GL.glTexParameteri(GL.GL_TEXTURE_2D, name, GL.GL_NEAREST)
        for name in (GL.GL_TEXTURE_WRAP_S, GL.GL_TEXTURE_WRAP_T):
            GL.glTexParameteri(GL.GL_TEXTURE_2D, name, GL.GL_CLAMP_TO_EDGE)
        self.glo = int(GL.glGenFramebuffers(1))
        GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, self.glo)
        self.attach()

    def attach(self) -> None:
        """Attach it to the bound framebuffer as its depth."""
        GL.glFramebufferTexture2D(
            GL.GL_DRAW_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, GL.GL_TEXTURE_2D, self._texture, 0
        )

    def bind(self) -> None:
        """Bind its own framebuffer; the viewport is unchanged."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.glo)

    def copy(self, framebuffer: Any) -> None:
        """Copy the depth of a moderngl framebuffer."""
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, framebuffer.glo)
        GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, self.glo)
        box = (0, 0, *self.size)
        GL.glBlitFramebuffer(*box, *box, GL.GL_DEPTH_BUFFER_BIT, GL.GL_NEAREST)

    def read(self) -> NDArray[np.float32]:
        """Depth (h, w), row 0 at the bottom."""
        out = np.empty(self.size[::-1], np.float32)
        self.use(0)
        GL.glGetTexImage(GL.GL_TEXTURE_2D, 0, GL.GL_DEPTH_COMPONENT, GL.GL_FLOAT, out)
        return out

    def write(self, depth: NDArray[np.float32]) -> None:
        """Replace its depth (h, w)."""
        self.use(0)
        box = (0, 0, *self.size)
        GL.glTexSubImage2D(GL.GL_TEXTURE_2D, 0, *box, GL.GL_DEPTH_COMPONENT, GL.GL_FLOAT, depth)

    def use(self, location: int) -> None:
        """Bind it to a texture unit."""
        GL.glActiveTexture(GL.GL_TEXTURE0 + location)
        GL.glBindTexture(GL.GL_TEXTURE_2D, self._texture)

    def release(self) -> None:
        """Free texture and framebuffer."""
        GL.glDeleteFramebuffers(1, [self.glo])
        GL.glDeleteTextures([self._texture])


class FloatDepth:
    """A 32-bit depth attachment of a moderngl framebuffer, which has none yet; several samples."""

    def __init__(self, framebuffer: Any, size: tuple[int, int], samples: int):
        self._name = int(GL.glGenRenderbuffers(1))
        GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, self._name)
        GL.glRenderbufferStorageMultisample(
            GL.GL_RENDERBUFFER, samples, GL.GL_DEPTH_COMPONENT32F, *size
        )
        framebuffer.use()
        GL.glFramebufferRenderbuffer(
            GL.GL_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, GL.GL_RENDERBUFFER, self._name
        )
        status = GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER)
        if status != GL.GL_FRAMEBUFFER_COMPLETE:
            raise RuntimeError(f"the framebuffer with float depth is incomplete ({int(status)})")

    def release(self) -> None:
        """Free the renderbuffer."""
        GL.glDeleteRenderbuffers(1, [self._name])
