"""The framebuffers of one picture size."""

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.graphics_memory import allocated
from vrut_lite.render.passes.surface_buffer import SurfaceBuffer
from vrut_lite.render.reversed_depth import DepthTexture, FloatDepth
from vrut_lite.render.unlocked import read_colours, read_rgba

SAMPLES = 4


class Targets:
    """Radiance with one or several samples per pixel, resolved radiance, and the displayed picture.

    `buffer` is drawn into. Radiance is in 32-bit floats: the sun's disc is brighter than half
    precision can hold.
    """

    def __init__(self, context: Any, size: tuple[int, int], samples: int):
        self.size = size
        self.is_released = False
        self.samples = size[0] * size[1] * samples
        makes = [partial(context.texture, size, 4, dtype="f4"), partial(context.texture, size, 4)]
        if samples > 1:
            makes.append(partial(context.renderbuffer, size, 4, samples=samples, dtype="f4"))
        what = f"a picture of {size[0]} x {size[1]}"
        self.radiance, self.display_texture, *colours = allocated(context, what, *makes)
        self._colour = colours[0] if colours else None
        self._context = context
        self._resolved = context.framebuffer([self.radiance])
        self.buffer = self._resolved
        if self._colour is not None:
            self.buffer = context.framebuffer([self._colour])
        self._depth: FloatDepth | DepthTexture
        if samples > 1:
            self._depth = FloatDepth(self.buffer, size, samples)
        else:
            self._depth = DepthTexture(size)
            self.buffer.use()
            self._depth.attach()
        self._surfaces: SurfaceBuffer | None = None
        self.display = context.framebuffer([self.display_texture])

    @property
    def has_one_sample(self) -> bool:
        """Whether pixels have one sample each."""
        return self.buffer is self._resolved

    @property
    def surfaces(self) -> SurfaceBuffer:
        """Attributes of the surfaces in a picture with one sample per pixel, made on first use."""
        assert isinstance(self._depth, DepthTexture)
        if self._surfaces is None:
            self._surfaces = SurfaceBuffer(self._context, self.buffer, self.radiance, self._depth)
        return self._surfaces

    def resolved(self) -> Any:
        """The texture with the mean of each pixel's samples."""
        if not self.has_one_sample:
            self._context.copy_framebuffer(self._resolved, self.buffer)
        return self.radiance

    def read_resolved(self) -> NDArray[np.float32]:
        """The mean of each pixel's samples (h, w, 4), row 0 at the bottom."""
        return read_rgba(self.resolved())

    def write_resolved(self, radiance: NDArray[np.float32]) -> None:
        """Replace the resolved radiance by (h, w, 4), row 0 at the top."""
        self.radiance.write(np.ascontiguousarray(radiance[::-1]))

    def read_display(self) -> NDArray[np.uint8]:
        """The tone-mapped picture (h, w, 3), row 0 at the top."""
        return read_colours(self.display_texture)[::-1].copy()

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        self.is_released = True
        if self._colour is not None:
            self.buffer.release()
            self._colour.release()
        if self._surfaces is not None:
            self._surfaces.release()
        for thing in (self._resolved, self.display, self._depth, self.radiance,
                      self.display_texture):  # fmt: skip
            thing.release()
