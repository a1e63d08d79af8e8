"""The sum of a still's pictures on a graphics card, which is read once."""

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.graphics_memory import allocated
from vrut_lite.render.shader_files import shader_source
from vrut_lite.render.size_cache import SizeCache
from vrut_lite.render.unlocked import read_rgba, run_compute

_GROUP = 8


class PictureSum:
    """Adds textures of radiance in single precision; on the GL thread only."""

    def __init__(self, context: Any):
        self._context = context
        self._program = context.compute_shader(shader_source("add_picture.comp"))
        self._totals = SizeCache(context, partial(_total, context))

    def add(self, picture: Any, first: bool) -> None:
        """Add a texture, or begin a sum with the `first`."""
        total = self._totals.get(picture.size)
        total.bind_to_image(0, read=True, write=True)
        picture.use(location=0)
        self._program["first"].value = first
        width, height = picture.size
        run_compute(self._program, -(-width // _GROUP), -(-height // _GROUP), 1)
        self._context.memory_barrier()

    def read(self, size: tuple[int, int]) -> NDArray[np.float32]:
        """The sum (h, w, 4), row 0 at the bottom."""
        return read_rgba(self._totals.get(size))

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        self._totals.release()
        self._program.release()


def _total(context: Any, size: tuple[int, int]) -> Any:
    make = partial(context.texture, size, 4, dtype="f4")
    return allocated(context, f"a picture of {size[0]} x {size[1]}", make)[0]
