"""Temporal reprojection: moving pictures reuse valid pixels of the previous picture.

Radiance does not depend on the camera except for reflections. Each picture shades a sixteenth of
its pixels in turns, an eighth while the light changes, reflections more often, disoccluded pixels,
and those about the edges of moving shadows; all others are reprojected.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL

from vrut_lite.numeric_types import FloatArray
from vrut_lite.render.change_of_light import change_of_light
from vrut_lite.render.passes.view import View, translation
from vrut_lite.render.picture_passes import FrameInputs
from vrut_lite.render.software.moving_targets import Drawn, MovingTargets
from vrut_lite.render.software.reprojection_kernel import edge_blocks, take_over
from vrut_lite.render.software.row_threads import run_in_halves
from vrut_lite.render.unlocked import read_rgba

# Pictures from one turn of a pixel to the next, the same while the light changes, and their step.
_TURNS, _TURNS_OF_LIGHT, _STEP = 16, 8, 3
_NOTHING = np.array([0.0, 0.0, 0.0, 1.0], np.float32)


class _Before(NamedTuple):
    radiance: NDArray[np.float32]
    depth: NDArray[np.float32]
    shot: FrameInputs


class TemporalReprojection:
    """Used on the GL thread only."""

    def __init__(self) -> None:
        self._before: _Before | None = None
        # Overwritten by each picture: allocating them would add a tenth to the time.
        self._filled: tuple[NDArray[np.float32], NDArray[np.float32]] | None = None
        self._turn = 0

    def begin(self, targets: MovingTargets, shot: FrameInputs) -> None:
        """Fill a target that contains the depth of opaque surfaces with reprojected radiance.

        Surfaces and sky then pass the depth test in the other pixels only. Blended surfaces are
        never reused, and nothing is after another reflection has been finished.
        """
        before, brighter = self._before, None
        if before is not None and before.shot.reflection.texture is shot.reflection.texture:
            brighter = change_of_light(before.shot.state, shot.state)
        if before is None or brighter is None:
            GL.glClearBufferfv(GL.GL_COLOR, 0, _NOTHING)
        else:
            self._take_over(targets.now, before, shot, brighter)

    def _take_over(
        self, drawn: Drawn, before: _Before, shot: FrameInputs, brighter: FloatArray
    ) -> None:
        self._turn = (self._turn + _STEP) % _TURNS
        view = shot.view
        shadows_move = not np.array_equal(_sun_matrix(before.shot), _sun_matrix(shot))
        # The edges of moving shadows take the time of the additional turns.
        has_time = np.any(brighter != 1.0) and not shadows_move
        turns = _TURNS_OF_LIGHT if has_time else _TURNS
        moved_m = float(np.linalg.norm(view.eye_m - before.shot.view.eye_m))
        front = drawn.depth.read()
        if self._filled is None or self._filled[1].shape != front.shape:
            self._filled = np.empty((*front.shape, 4), np.float32), np.empty_like(front)
        radiance, depth = self._filled
        run_in_halves(
            take_over,
            len(front),
            front,
            before.radiance,
            before.depth,
            edge_blocks(before.radiance, shadows_move),
            _old_from_pixel(before, view, front.shape).astype(np.float32),
            brighter.astype(np.float32),
            np.float32(moved_m / float(view.projection[2, 3])),
            self._turn,
            turns - 1,
            radiance,
            depth,
        )
        drawn.radiance.write(radiance)
        drawn.depth.write(depth)

    def keep(self, targets: MovingTargets, shot: FrameInputs) -> NDArray[np.float32]:
        """Keep the drawn picture for the next one; returns its radiance (h, w, 4), from below."""
        drawn = targets.now
        radiance = read_rgba(drawn.radiance)
        # A single row or column cannot be interpolated.
        before = _Before(radiance, drawn.depth.read(), shot)
        self._before = before if min(drawn.size) > 1 else None
        return radiance

    def release(self) -> None:
        """Forget the previous picture."""
        self._before = self._filled = None


def _sun_matrix(shot: FrameInputs) -> NDArray[np.float64]:
    """The matrix (4, 4) of the shadow map, perhaps of an earlier sun near by."""
    assert shot.shadows.scene is not None
    return shot.shadows.scene.matrix


def _old_from_pixel(before: _Before, now: View, shape: tuple[int, ...]) -> FloatArray:
    """Matrix (4, 4) from column, row, depth and 1 to the previous ones, homogeneous."""
    eye_from_clip = np.linalg.inv(now.clip_from_eye)
    old = before.shot.view
    old_from_clip = old.clip_from_eye @ translation(now.eye_m - old.eye_m)
    old_size = before.depth.shape[::-1]
    return np.asarray(
        np.linalg.inv(_clip_from_pixel(old_size))
        @ old_from_clip
        @ eye_from_clip
        @ _clip_from_pixel(shape[::-1])
    )


def _clip_from_pixel(size: tuple[int, ...]) -> FloatArray:
    """Matrix (4, 4) from column, row, depth and 1 to clip coordinates."""
    width, height = size
    matrix = np.diag([2.0 / width, 2.0 / height, 1.0, 1.0])
    matrix[:2, 3] = 1.0 / width - 1.0, 1.0 / height - 1.0
    return matrix
