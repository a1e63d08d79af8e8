"""Histograms of luminance that a graphics card counts, by which automatic exposure is metered."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMINANCE_WEIGHTS
from vrut_lite.pictures.luminance_histogram import BINS, BINS_PER_STOP, LEAST_LOG2
from vrut_lite.render.shader_files import defined, shader_source
from vrut_lite.render.unlocked import clear_buffer, read_buffer, run_compute

# Pixels of the shader's work group along an edge.
_TILE = 64


class LuminanceCounts:
    """A histogram (BINS,) in a buffer, to be read later; on the GL thread only."""

    def __init__(self, context: Any):
        self._buffer = context.buffer(reserve=4 * BINS, dynamic=True)
        # The histogram as read last; None before.
        self.read_last: NDArray[np.uint32] | None = None

    def clear(self) -> None:
        """Fill it with zeros, and bind it for the shader."""
        clear_buffer(self._buffer)
        self._buffer.bind_to_storage_buffer(0)

    def read(self) -> NDArray[np.uint32]:
        """The histogram; waits for the card if it still counts."""
        self.read_last = read_buffer(self._buffer, np.empty(BINS, np.uint32))
        return self.read_last

    def release(self) -> None:
        """Free the buffer."""
        self._buffer.release()


class LuminanceMeter:
    """LuminanceCounts the luminances of textures; made and used on the GL thread only."""

    def __init__(self, context: Any):
        self._context = context
        source = defined(shader_source("luminance_histogram.comp"), {"BINS": BINS})
        self._program = context.compute_shader(source)

    def count(self, radiance: Any, size: tuple[int, int], counts: LuminanceCounts) -> None:
        """Count the pixels of a texture of radiance; returns before the card is done."""
        counts.clear()
        program = self._program
        program["luminance_weights"].value = tuple(LUMINANCE_WEIGHTS)
        program["least_log2"].value = LEAST_LOG2
        program["bins_per_stop"].value = float(BINS_PER_STOP)
        radiance.use(location=0)
        run_compute(program, -(-size[0] // _TILE), -(-size[1] // _TILE), 1)
        self._context.memory_barrier()

    def release(self) -> None:
        """Free the program."""
        self._program.release()
