"""The headset's thread: it waits for the runtime's clock and draws each frame for both eyes.

It draws the state that the engine has shown it last, whole as the window's pictures are, at the
poses that the runtime predicts. The kernel hears of where one stands and of the hour by inputs,
as from any panel.
"""

import math
import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np

from vrut_lite.app.engine.adaptation import Adaptation
from vrut_lite.app.headset.aim import Aim
from vrut_lite.app.headset.controllers import Controllers, Wishes
from vrut_lite.app.headset.marker import TeleportMarker
from vrut_lite.app.headset.openxr import HeadsetFrame, LocatedEye, OpenXrSession
from vrut_lite.app.headset.runtime import failure
from vrut_lite.app.headset.standing import (
    RoomPose,
    Standing,
    azimuth_rad,
    floor_below,
    standing_at,
)
from vrut_lite.app.view.camera_rig import EYE_HEIGHT_M
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.host import Host
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import FloatArray, vector
from vrut_lite.render.eye_pictures import HeadsetEye
from vrut_lite.render.rays import SceneRays
from vrut_lite.scene.scene_state import SceneState

# Seconds of the clock a second at full deflection of a thumbstick.
HOUR_RATE = 3600.0
# Longest time by which one frame moves the hour.
_LONGEST_STEP_S = 0.25
# Time between two looks at a runtime that wants no frames yet.
_IDLE_S = 0.02
# Time after which a runtime that does not end the session is left.
_LONGEST_END_S = 3.0


class HeadsetLoop:
    """Draws for a headset from `start` until `stop`, `close` or the runtime's end.

    `tell(kind, value)` is called on the headset's thread, with these kinds and values: `entered`,
    the size of an eye's picture in pixels; `moved`, a level camera at the head's new place; `hour`,
    the seconds by which the clock must move; and last `left`, a sentence on a failure or "".
    """

    def __init__(self, host: Host, tell: Callable[[str, Any], None]):
        self._host, self._tell = host, tell
        self._state: SceneState | None = None
        self._ending = threading.Event()
        self._adaptation = Adaptation()
        self._standing: Standing | None = None
        # The scene in which one stands, and rays against one pose of it.
        self._stands_in: Any = None
        self._rays: tuple[SceneOpened, SceneRays] | None = None
        self._framed_s = perf_counter()
        self._aim = Aim()
        # Made with the session.
        self._marker: TeleportMarker | None = None
        self._thread = threading.Thread(target=self._run, name="vrut-lite headset", daemon=True)

    # --- from any thread -------------------------------------------------------------------

    def start(self) -> None:
        """Enter the headset."""
        self._thread.start()

    def show(self, state: SceneState) -> None:
        """Draw this from the next frame on."""
        self._state = state

    def stop(self) -> None:
        """Leave the headset soon; `left` follows."""
        self._ending.set()

    def close(self) -> None:
        """Leave the headset, and wait until nothing is drawn any more, or the runtime hangs."""
        self.stop()
        self._thread.join(2.0 * _LONGEST_END_S)

    # --- on the headset's thread -----------------------------------------------------------

    def _run(self) -> None:
        problem = ""
        try:
            openxr = OpenXrSession()
            try:
                self._host.gl.call(lambda _: openxr.begin())
                self._marker = self._host.gl.call(lambda _: TeleportMarker(openxr))
                self._live(openxr, Controllers(openxr))
            finally:
                self._aim.close()
                self._host.gl.call(lambda _: openxr.close())
        except BaseException as error:
            problem = failure(error) or sentence_of(error)
        self._tell("left", problem)

    def _live(self, openxr: OpenXrSession, controllers: Controllers) -> None:
        self._tell("entered", openxr.sizes_px[0])
        ends_at_s = math.inf
        while not openxr.has_ended and perf_counter() < ends_at_s:
            openxr.poll()
            if self._ending.is_set() and ends_at_s == math.inf:
                openxr.ask_to_end()
                ends_at_s = perf_counter() + _LONGEST_END_S
            elif openxr.is_running:
                self._draw_next(openxr, controllers)
            else:
                self._ending.wait(_IDLE_S)

    def _draw_next(self, openxr: OpenXrSession, controllers: Controllers) -> None:
        frame, state = openxr.wait(), self._state
        wishes = controllers.wishes(frame)
        eyes: list[LocatedEye] = []
        if frame.is_seen and state is not None and not state.missing:
            eyes = openxr.eyes(frame)
        if eyes:
            assert state is not None
            self._act(wishes, state, middle_of(eyes))
        self._host.gl.call(lambda _: self._draw(openxr, frame, state, eyes))

    def _act(self, wishes: Wishes, state: SceneState, head: RoomPose) -> None:
        """Stand where the head and the controllers ask for, and pass the hour on."""
        now_s = perf_counter()
        elapsed_s = min(now_s - self._framed_s, _LONGEST_STEP_S)
        self._framed_s = now_s
        if wishes.hour:
            self._tell("hour", HOUR_RATE * wishes.hour * elapsed_s)
        before, scene = self._standing, state.scene
        assert scene is not None
        if before is None or scene.opened != self._stands_in:
            self._stands_in = scene.opened
            standing = self._below_camera(state, head)
        else:
            standing = before
        if wishes.turn_rad:
            standing = standing.turned(wishes.turn_rad, head)
        if wishes.aims_from is not None:
            hand = standing.in_world(wishes.aims_from)
            self._aim.point(hand, lambda: self._rays_of(scene).first_hit)
        else:
            target_m = self._aim.release()
            if wishes.teleports and target_m is not None:
                standing = standing.with_head_at(target_m, head)
        if standing is not before:
            assert state.camera is not None
            self._standing = standing
            self._tell("moved", level_camera(standing.in_world(head), state.camera))

    def _below_camera(self, state: SceneState, head: RoomPose) -> Standing:
        """The room on the floor below the window's camera; at its own height over nothing."""
        camera = state.camera
        assert camera is not None
        assert state.scene is not None
        eye_m = np.array(camera.eye_m)
        floor_m = floor_below(eye_m, self._rays_of(state.scene).first_hit)
        if floor_m is None:
            floor_m = eye_m - (0.0, EYE_HEIGHT_M, 0.0)
        return standing_at(floor_m, azimuth_rad(np.array(camera.target_m) - eye_m), head)

    def _rays_of(self, scene: SceneOpened) -> SceneRays:
        if self._rays is None or self._rays[0] is not scene:
            self._rays = scene, SceneRays(scene)
        return self._rays[1]

    # --- on the GL thread ------------------------------------------------------------------

    def _draw(
        self,
        openxr: OpenXrSession,
        frame: HeadsetFrame,
        state: SceneState | None,
        eyes: list[LocatedEye],
    ) -> None:
        openxr.begin_frame()
        shown: list[LocatedEye] = []
        try:
            if eyes:
                assert state is not None
                textures = openxr.take_textures()
                self._draw_eyes(state, self._views(eyes, openxr.sizes_px, textures))
                shown = eyes
        finally:
            openxr.give_textures_back()
            openxr.end_frame(frame, shown, self._over(shown))

    def _over(self, shown: list[LocatedEye]) -> list[Any]:
        """Layers over the eyes' pictures: the ring while the hand aims at a place."""
        target_m, standing = self._aim.target_m, self._standing
        if not shown or target_m is None or standing is None or self._marker is None:
            return []
        return [self._marker.layer(standing.in_room(target_m))]

    def _draw_eyes(self, state: SceneState, views: list[HeadsetEye]) -> None:
        exposure = self._adaptation.next_exposure(state, perf_counter())
        drawn = self._host.draw_eyes(replace(state, exposure=exposure), views)
        self._adaptation.drew(drawn, exposure, perf_counter())

    def _views(
        self, eyes: list[LocatedEye], sizes_px: list[tuple[int, int]], textures: list[int]
    ) -> list[HeadsetEye]:
        assert self._standing is not None
        views = []
        for eye, size_px, texture in zip(eyes, sizes_px, textures, strict=True):
            pose = self._standing.in_world(eye.pose)
            views.append(HeadsetEye(pose.position_m, pose.rotation, eye.tangents, size_px, texture))
        return views


def middle_of(eyes: Sequence[LocatedEye]) -> RoomPose:
    """The pose of a head, between its eyes; its axes are the first one's."""
    middle_m: FloatArray = np.mean([eye.pose.position_m for eye in eyes], axis=0)
    return RoomPose(middle_m, eyes[0].pose.rotation)


def level_camera(head: RoomPose, like: MoveCamera) -> MoveCamera:
    """A camera at a head (in world axes) that looks level ahead, with another one's angle."""
    azimuth = azimuth_rad(head.forward)
    ahead = np.array([math.sin(azimuth), 0.0, -math.cos(azimuth)])
    eye_m = head.position_m
    return MoveCamera(
        eye_m=vector(eye_m),
        target_m=vector(eye_m + ahead),
        vertical_field_of_view_rad=like.vertical_field_of_view_rad,
    )
