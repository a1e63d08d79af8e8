"""Mipmapped copy of the framebuffer, sampled by glass that refracts or blurs."""

from typing import Any

from vrut_lite.render.size_cache import SizeCache
from vrut_lite.render.surface_terms import BACKDROP_UNIT


class _Copy:
    """Radiance texture of one size; 32-bit floats, since it may contain the sun."""

    def __init__(self, context: Any, size: tuple[int, int]):
        self.texture = context.texture(size, 4, dtype="f4")
        self.texture.repeat_x = self.texture.repeat_y = False
        self.buffer = context.framebuffer([self.texture])

    def release(self) -> None:
        self.buffer.release()
        self.texture.release()


class Backdrop:
    """Made and used on the GL thread only."""

    def __init__(self, context: Any):
        self._context = context
        self._copies = SizeCache(context, lambda size: _Copy(context, size))

    def take(self, drawn: Any, size: tuple[int, int]) -> None:
        """Copy a framebuffer, and bind the copy; `drawn` is bound again."""
        copy = self._copies.get(size)
        self._context.copy_framebuffer(copy.buffer, drawn)
        copy.texture.build_mipmaps()
        copy.texture.filter = (self._context.LINEAR_MIPMAP_LINEAR, self._context.LINEAR)
        copy.texture.use(location=BACKDROP_UNIT)
        drawn.use()

    def release(self) -> None:
        """Free the GL objects."""
        self._copies.release()
