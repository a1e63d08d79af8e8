"""The framebuffers of one picture size."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.reversed_depth import FloatDepth
from vrut_lite.render.unlocked import read_rgba

SAMPLES = 4


class Targets:
    """Radiance with one sample a pixel or several, resolved radiance, and the picture for display.

    Radiance is in 32-bit floats: the sun's disc is brighter than half precision can hold.
    """

    def __init__(self, context: Any, size: tuple[int, int], samples: int = SAMPLES):
        self.size = size
        self.is_released = False
        self.samples_a_pixel = samples
        # Of OpenGL's, 0 is one sample, whose depth is tested before it is shaded.
        stored = samples if samples > 1 else 0
        self._colour = context.renderbuffer(size, 4, samples=stored, dtype="f4")
        self.multisampled = context.framebuffer([self._colour])
        self._depth = FloatDepth(self.multisampled, size, stored)
        self.radiance = context.texture(size, 4, dtype="f4")
        self.resolved = context.framebuffer([self.radiance])
        self._display = context.texture(size, 4)
        self.display = context.framebuffer([self._display])

    @property
    def samples(self) -> int:
        """Samples of all pixels."""
        return self.size[0] * self.size[1] * self.samples_a_pixel

    def read_resolved(self) -> NDArray[np.float32]:
        """The resolved picture (h, w, 4), row 0 at the top."""
        return read_rgba(self.radiance)[::-1].copy()

    def write_resolved(self, radiance: NDArray[np.float32]) -> None:
        """Let this (h, w, 4), row 0 at the top, be the resolved picture."""
        self.radiance.write(np.ascontiguousarray(radiance[::-1]).tobytes())

    def read_display(self) -> NDArray[np.uint8]:
        """The tone-mapped picture (h, w, 3), row 0 at the top."""
        width, height = self.size
        pixels = np.frombuffer(self.display.read(components=3, alignment=1), np.uint8)
        return pixels.reshape(height, width, 3)[::-1].copy()

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        self.is_released = True
        for thing in (self.multisampled, self.resolved, self.display, self._colour, self._depth,
                      self.radiance, self._display):  # fmt: skip
            thing.release()
