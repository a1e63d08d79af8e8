"""The user's hand on the camera: what drags, the wheel and keys do in each mode."""

from copy import copy
from enum import Enum

from PySide6.QtCore import Qt

from vrut_lite.app.view.camera_rig import CameraRig
from vrut_lite.app.view.surroundings import OccupiedCells

_TURNS = {
    Qt.Key.Key_Left: (0.02, 0.0), Qt.Key.Key_Right: (-0.02, 0.0),
    Qt.Key.Key_Up: (0.0, -0.02), Qt.Key.Key_Down: (0.0, 0.02),
}  # fmt: skip
_CLIMBS = {Qt.Key.Key_PageUp: 2.0, Qt.Key.Key_PageDown: -2.0}
_DOLLIES = {Qt.Key.Key_Plus: 1.0, Qt.Key.Key_Minus: -1.0}


class CameraMode(Enum):
    """The camera's modes, each with a hint for the mouse."""

    ORBIT = "drag to turn (among walls: to look around), right drag to shift, wheel to go nearer"
    FLY = "drag to look, W A S D to fly, Q E down and up, Shift faster, wheel for the view's angle"
    SPACE = "wheel to climb, drag to look around"


class Hand:
    """Moves its `rig`; with `surroundings` turning stays above ground and out of walls."""

    def __init__(self) -> None:
        self.rig = CameraRig()
        self.mode = CameraMode.ORBIT
        self.surroundings: OccupiedCells | None = None
        # Whether this drag looks around, since the eye stands among walls.
        self._looks_around = False

    def begin_drag(self) -> None:
        """Find out what the drag that begins here does."""
        around = self.surroundings
        self._looks_around = around is not None and around.encloses(
            self.rig.eye_m, self.rig.target_m
        )

    def drag(self, right: float, up: float, shifting: bool) -> None:
        """Follow the hand, in shares of the picture's height."""
        if shifting:
            self.rig.pan(right, up)
        elif self.mode is CameraMode.ORBIT and not self._looks_around:
            self._turn(right, up)
        else:
            self.rig.look_around(right, up)

    def wheel(self, steps: float) -> None:
        """Move nearer, narrow the view or climb, by the mode."""
        if self.mode is CameraMode.ORBIT:
            self.rig.dolly(steps)
        elif self.mode is CameraMode.FLY:
            self.rig.zoom(steps)
        else:
            self.rig.climb(steps)

    def press(self, key: Qt.Key) -> bool:
        """Turn, climb or go nearer by a key; False if it moves nothing."""
        if key in _TURNS:
            self.begin_drag()
            self.drag(*_TURNS[key], shifting=False)
        elif key in _CLIMBS:
            self.rig.climb(_CLIMBS[key])
        elif key in _DOLLIES:
            self.rig.dolly(_DOLLIES[key])
        else:
            return False
        return True

    def _turn(self, right: float, up: float) -> None:
        """Turn around the target, along a wall where one is in the way; in a corner look around."""
        around = self.surroundings
        if around is None:
            self.rig.orbit(right, up)
            return
        for way in ((right, up), (right, 0.0), (0.0, up)):
            turned = copy(self.rig)
            turned.orbit(*way, lowest_m=around.lowest_m)
            if around.is_free(self.rig.eye_m, turned.eye_m):
                self.rig = turned
                return
        self.rig.look_around(right, up)
