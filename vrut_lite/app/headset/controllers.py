"""Actions of the controllers: hour, turns and teleports.

The left thumbstick moves the hour, the right one turns by steps. The right hand aims while its
trigger is held; released, it teleports. A simple controller has a button a hand: the right one
teleports, the left one turns.
"""

import math
from typing import Any, NamedTuple

from vrut_lite.app.headset.openxr import HeadsetFrame, OpenXrSession, pose_of
from vrut_lite.app.headset.standing import RoomPose

SNAP_TURN_RAD = math.radians(30.0)
# Deflections of a thumbstick from which it turns, below which it may turn again, and up to which
# the hour rests.
_TURNS_FROM, _TURNS_AGAIN, _RESTS_TO = 0.7, 0.4, 0.15
_PROFILES = "/interaction_profiles"
_LEFT, _RIGHT = "/user/hand/left/input", "/user/hand/right/input"
# The inputs of each action, by the kind of controller.
_BINDINGS = {
    f"{_PROFILES}/oculus/touch_controller": {
        "hour": f"{_LEFT}/thumbstick/x",
        "turn": f"{_RIGHT}/thumbstick/x",
        "teleport": f"{_RIGHT}/trigger/value",
        "hand": f"{_RIGHT}/aim/pose",
    },
    f"{_PROFILES}/khr/simple_controller": {
        "turn": f"{_LEFT}/select/click",
        "teleport": f"{_RIGHT}/select/click",
        "hand": f"{_RIGHT}/aim/pose",
    },
}


class Wishes(NamedTuple):
    """Requests of the controllers in a frame.

    Attributes:
        hour: share of the clock's full speed, -1 (back) to 1.
        turn_rad: angle of a snap turn, clockwise as seen from above.
        aims_from: the pointing hand (in the room) while its trigger is held, else None.
        teleports: whether it has just been released.
    """

    hour: float = 0.0
    turn_rad: float = 0.0
    aims_from: RoomPose | None = None
    teleports: bool = False


class SnapTurn:
    """Turns once each time that a thumbstick is pushed aside."""

    def __init__(self) -> None:
        self._is_ready = True

    def turn_rad(self, deflection: float) -> float:
        """The turn that a deflection (-1 to 1, right is positive) begins; mostly 0."""
        if abs(deflection) < _TURNS_AGAIN:
            self._is_ready = True
        if not self._is_ready or abs(deflection) < _TURNS_FROM:
            return 0.0
        self._is_ready = False
        return math.copysign(SNAP_TURN_RAD, deflection)


class Controllers:
    """The actions of a session; used on the headset's thread."""

    def __init__(self, openxr: OpenXrSession):
        self._openxr, xr = openxr, openxr.xr
        self._snap_turn = SnapTurn()
        self._aims = False
        kinds = xr.ActionType
        self._set = xr.create_action_set(
            openxr.instance, xr.ActionSetCreateInfo("standing", "Standing in the scene", 0)
        )
        self._actions = {
            name: self._action(name, title, kind)
            for name, title, kind in (
                ("hour", "Move the hour", kinds.FLOAT_INPUT),
                ("turn", "Turn", kinds.FLOAT_INPUT),
                ("teleport", "Teleport", kinds.BOOLEAN_INPUT),
                ("hand", "Pointing hand", kinds.POSE_INPUT),
            )
        }
        for profile, inputs in _BINDINGS.items():
            bindings = [
                xr.ActionSuggestedBinding(
                    self._actions[name], xr.string_to_path(openxr.instance, path)
                )
                for name, path in inputs.items()
            ]
            suggested = xr.InteractionProfileSuggestedBinding(
                interaction_profile=xr.string_to_path(openxr.instance, profile),
                suggested_bindings=bindings,
            )
            xr.suggest_interaction_profile_bindings(openxr.instance, suggested)
        attached = xr.SessionActionSetsAttachInfo(action_sets=[self._set])
        xr.attach_session_action_sets(openxr.session, attached)
        self._hand = xr.create_action_space(
            openxr.session, xr.ActionSpaceCreateInfo(self._actions["hand"])
        )

    def _action(self, name: str, title: str, kind: Any) -> Any:
        xr = self._openxr.xr
        info = xr.ActionCreateInfo(action_name=name, action_type=kind, localized_action_name=title)
        return xr.create_action(self._set, info)

    def wishes(self, frame: HeadsetFrame) -> Wishes:
        """Requests since the frame before; none while another program has the focus."""
        xr, session = self._openxr.xr, self._openxr.session
        try:
            xr.sync_actions(session, xr.ActionsSyncInfo(active_action_sets=[self._active]))
        except xr.SessionNotFocused:
            return Wishes()
        pressed = xr.get_action_state_boolean(session, self._get("teleport"))
        was_aiming, self._aims = self._aims, bool(pressed.is_active and pressed.current_state)
        hour = self._deflection("hour")
        return Wishes(
            hour=hour if abs(hour) > _RESTS_TO else 0.0,
            turn_rad=self._snap_turn.turn_rad(self._deflection("turn")),
            aims_from=self._hand_at(frame) if self._aims else None,
            teleports=was_aiming and not self._aims,
        )

    @property
    def _active(self) -> Any:
        return self._openxr.xr.ActiveActionSet(self._set, self._openxr.xr.NULL_PATH)

    def _get(self, name: str) -> Any:
        return self._openxr.xr.ActionStateGetInfo(self._actions[name])

    def _deflection(self, name: str) -> float:
        state = self._openxr.xr.get_action_state_float(self._openxr.session, self._get(name))
        return float(state.current_state) if state.is_active else 0.0

    def _hand_at(self, frame: HeadsetFrame) -> RoomPose | None:
        """The pointing hand in the room; None while it is not tracked."""
        xr = self._openxr.xr
        found = xr.locate_space(self._hand, self._openxr.room, frame.display_time)
        flags = xr.SpaceLocationFlags
        needed = flags.ORIENTATION_VALID_BIT | flags.POSITION_VALID_BIT
        return pose_of(found.pose) if found.location_flags & needed == needed else None
