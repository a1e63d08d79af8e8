"""Moving pictures of a graphics card: nothing is read back, or waited for, while one is drawn.

Resolve, metering, tone map and the bytes for display are the card's. A fence signals when bytes
and histogram are there; the caller polls it between other work of the GL thread. Automatic
exposure is metered by the picture before, the first by its own histogram, which is waited for.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures.exposure import metered_ev100
from vrut_lite.pictures.luminance_histogram import luminances_of
from vrut_lite.pictures.picture import PictureOnCard
from vrut_lite.render.card_targets import CallGl, CardTargets, Fence, LentRadiance
from vrut_lite.render.luminance_meter import LuminanceCounts, LuminanceMeter
from vrut_lite.render.picture_passes import FrameInputs, PicturePasses
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.shader_files import shader_source
from vrut_lite.render.size_cache import SizeCache
from vrut_lite.render.unlocked import read_buffer, run_compute

# Pixels of the bytes' work group, and of its rows.
_GROUP_PX, _ROW_GROUPS = 4 * 256, 1024
DrawSeen = Callable[[CardTargets, FrameInputs], None]


class DrawnPicture:
    """A picture that the card is drawing; on the GL thread."""

    def __init__(
        self,
        radiance: LentRadiance,
        size: tuple[int, int],
        buffers: "_Buffers",
        ev100: float,
        pixel_rad: float,
    ):
        self._radiance, self._size, self._buffers = radiance, size, buffers
        self._ev100, self._pixel_rad = ev100, pixel_rad
        self._fence = Fence()

    def taken(self, call_gl: CallGl) -> PictureOnCard | None:
        """The picture once the card is done, None before; returns at once.

        `call_gl` reads the radiance, if anybody asks for it.
        """
        if not self._fence.is_signalled():
            return None
        width, height = self._size
        lent = self._radiance
        return PictureOnCard(
            lambda: lent.read(call_gl),
            self._buffers.counts.read(),
            self._buffers.read_bytes()[: 3 * width * height].reshape(height, width, 3),
            self._ev100,
            self._pixel_rad,
        )


class CardPictures:
    """Draws a shot with several samples a pixel; on the GL thread only."""

    def __init__(self, passes: PicturePasses, draw_seen: DrawSeen):
        self._passes = passes
        self._draw_seen = draw_seen
        context = passes.context
        self._targets = SizeCache(context, lambda size: CardTargets(context, size))
        self._buffers = SizeCache(context, lambda size: _Buffers(context, size))
        self._largest_bytes = int(context.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"])
        self._meter = LuminanceMeter(context)
        self._bytes = context.compute_shader(shader_source("display_bytes.comp"))
        # The scene of the last picture, and its buffers.
        self._metered: tuple[PyrenderScene, _Buffers] | None = None

    def can_draw(self, shot: FrameInputs) -> bool:
        """Whether it draws such a picture: neither false colours nor glare, nor too large."""
        state = shot.state
        plain = state.shows == "picture" and state.exposure.glare == 0.0
        return plain and _bytes_of(state.size_px) <= self._largest_bytes

    def draw(self, shot: FrameInputs) -> DrawnPicture:
        """Begin a shot; returns before the card is done."""
        passes, state = self._passes, shot.state
        targets = self._targets.get(state.size_px)
        passes.meshes.read_finer(shot.scene, 0.0)
        passes.counters.did("picture")
        targets.buffer.use()
        targets.buffer.clear()
        self._draw_seen(targets, shot)
        with passes.measure("resolve"):
            radiance, lent = targets.resolve()
        buffers = self._buffers.get(state.size_px)
        counts = self._last_counts(shot.scene)
        with passes.measure("meter"):
            self._meter.count(radiance, targets.size, buffers.counts)
        ev100 = self._ev100(shot, counts, buffers)
        self._metered = shot.scene, buffers
        pixel_rad = shot.view.pixel_rad(targets.size)
        with passes.measure("tone map"):
            passes.tone.draw(radiance, targets.display, ev100, state.exposure, pixel_rad)
        with passes.measure("bytes for display"):
            self._pack(targets, buffers)
        return DrawnPicture(lent, targets.size, buffers, ev100, pixel_rad)

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        self._metered = None
        for thing in (self._targets, self._buffers, self._meter, self._bytes):
            thing.release()

    def _last_counts(self, scene: PyrenderScene) -> NDArray[np.uint32] | None:
        """The histogram of the picture before, if it showed this scene."""
        if self._metered is None or self._metered[0] is not scene:
            return None
        return self._metered[1].counts.read_last

    def _ev100(
        self, shot: FrameInputs, counts: NDArray[np.uint32] | None, buffers: "_Buffers"
    ) -> float:
        wish: SetExposure = shot.state.exposure
        if wish.mode == "manual":
            return wish.ev100 - wish.compensation_ev
        if counts is None:
            Fence().wait()
            counts = buffers.counts.read()
        metered = metered_ev100(luminances_of(counts), shot.state.white_card, wish.night_look)
        return metered - wish.compensation_ev

    def _pack(self, targets: CardTargets, buffers: "_Buffers") -> None:
        buffers.bind_bytes()
        self._bytes["row_groups"].value = _ROW_GROUPS
        targets.display_texture.use(location=0)
        groups = -(-targets.size[0] * targets.size[1] // _GROUP_PX)
        run_compute(self._bytes, min(groups, _ROW_GROUPS), -(-groups // _ROW_GROUPS), 1)
        self._passes.context.memory_barrier()


class _Buffers:
    """The histogram and the bytes for display of a picture, in buffers to be read later."""

    def __init__(self, context: Any, size: tuple[int, int]):
        self.counts = LuminanceCounts(context)
        self._bytes = context.buffer(reserve=_bytes_of(size), dynamic=True)

    def bind_bytes(self) -> None:
        self._bytes.bind_to_storage_buffer(1)

    def read_bytes(self) -> NDArray[np.uint8]:
        return read_buffer(self._bytes, np.empty(self._bytes.size, np.uint8))

    def release(self) -> None:
        self.counts.release()
        self._bytes.release()


def _bytes_of(size: tuple[int, int]) -> int:
    """Bytes of a picture for display, in whole quads of pixels."""
    return 12 * -(-size[0] * size[1] // 4)
