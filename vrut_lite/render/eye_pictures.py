"""Pictures of a headset's eyes, drawn into textures of its runtime.

The eyes of a frame share all that does not depend on where an eye is: uploads, the sky and its
reflection, shadow maps, and the exposure. Sky, surfaces and parts are drawn for each eye. Nothing
is read back but the histogram of the first eye of the frame before, which the card has finished.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.picture import NightLook
from vrut_lite.numeric_types import FloatArray, vector
from vrut_lite.pictures.exposure import metered_ev100
from vrut_lite.pictures.luminance_histogram import luminances_of
from vrut_lite.render.luminance_meter import LuminanceCounts, LuminanceMeter
from vrut_lite.render.picture_passes import FrameInputs, PicturePasses
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.size_cache import SizeCache
from vrut_lite.render.targets import SAMPLES, Targets
from vrut_lite.render.unlocked import copy_bytes
from vrut_lite.scene.scene_state import SceneState

DrawSeen = Callable[[Targets, FrameInputs], None]


class HeadsetEye(NamedTuple):
    """An eye, and the texture that gets its picture.

    Attributes:
        eye_m: its place (3,), world axes.
        rotation: matrix (3, 3) from the eye's axes (x right, y up, -z forward) to the world's.
        tangents: of the angles from the eye's axis to the left, right, lower and upper edge.
        size_px: width and height of the picture.
        texture: name of the OpenGL texture that gets it, of four bytes a pixel, sRGB-encoded.
    """

    eye_m: FloatArray
    rotation: FloatArray
    tangents: tuple[float, float, float, float]
    size_px: tuple[int, int]
    texture: int

    @property
    def camera(self) -> MoveCamera:
        """A camera that looks along the eye's axis as high and low as the eye does."""
        _, _, lower, upper = self.tangents
        return MoveCamera(
            eye_m=vector(self.eye_m),
            target_m=vector(self.eye_m - self.rotation[:, 2]),
            vertical_field_of_view_rad=float(2.0 * np.arctan(max(-lower, upper))),
        )


@dataclass(frozen=True)
class EyesDrawn:
    """The exposure of both eyes, and a histogram of the first one's luminance (BINS,)."""

    ev100: float
    counts: NDArray[np.uint32]

    def metered_ev100(self, white: float, night_look: NightLook, enough: int) -> float:
        """EV100 by which automatic exposure would expose it, by `enough` of its pixels."""
        return metered_ev100(luminances_of(self.counts, enough), white, night_look)


class EyePictures:
    """Draws the shots of a frame's eyes, one after the other; on the GL thread only."""

    def __init__(self, passes: PicturePasses, draw_seen: DrawSeen, several_samples: bool):
        self._passes = passes
        self._draw_seen = draw_seen
        context = passes.context
        samples = SAMPLES if several_samples else 1
        self._targets = SizeCache(context, lambda size: Targets(context, size, samples))
        self._meter, self._counts = LuminanceMeter(context), LuminanceCounts(context)
        # The scene of the last frame, which the counts are of.
        self._scene: PyrenderScene | None = None

    def draw(self, shots: Iterable[FrameInputs], textures: Sequence[int]) -> EyesDrawn:
        """Draw the shots into textures of their sizes, each before the next is taken.

        Automatic exposure is metered by the frame before, the first of a scene by itself.
        """
        ev100: float | None = None
        counts: NDArray[np.uint32] | None = None
        passes = self._passes
        for shot, texture in zip(shots, textures, strict=True):
            state = shot.state
            targets = self._targets.get(state.size_px)
            passes.meshes.read_finer(shot.scene, 0.0)
            passes.counters.did("eye")
            targets.buffer.use()
            targets.buffer.clear()
            self._draw_seen(targets, shot)
            with passes.measure("resolve"):
                radiance = targets.resolved()
            if counts is None:
                with passes.measure("meter"):
                    counts = self._metered(shot.scene, radiance, targets.size)
                ev100 = _ev100(state, counts)
            assert ev100 is not None
            with passes.measure("tone map"):
                pixel_rad = shot.view.pixel_rad(targets.size)
                passes.tone.draw(radiance, targets.display, ev100, state.exposure, pixel_rad)
            copy_bytes(targets.display_texture, texture)
        assert ev100 is not None
        assert counts is not None
        return EyesDrawn(ev100, counts)

    def _metered(
        self, scene: PyrenderScene, radiance: Any, size: tuple[int, int]
    ) -> NDArray[np.uint32]:
        """The histogram of the frame before if it showed this scene, else of this radiance."""
        before = self._counts.read() if self._scene is scene else None
        self._scene = scene
        self._meter.count(radiance, size, self._counts)
        return self._counts.read() if before is None else before

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        for thing in (self._targets, self._meter, self._counts):
            thing.release()


def _ev100(state: SceneState, counts: NDArray[np.uint32]) -> float:
    wish = state.exposure
    if wish.mode == "manual":
        return wish.ev100 - wish.compensation_ev
    metered = metered_ev100(luminances_of(counts), state.white_card, wish.night_look)
    return metered - wish.compensation_ev
