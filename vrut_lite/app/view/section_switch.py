"""Switches the section plane on, through the middle of the scene, and off."""

from vrut_lite.app.engine.session import Session
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.kernel.messages import SetSetting

_SCENE, _OFF = "scene", "off"
_FIRST_AXIS = "y"


class SectionSwitch:
    """Axis, place and side are settings of the scene, in its panel; this remembers the axis."""

    def __init__(self, session: Session):
        self._session = session
        self._axis = _FIRST_AXIS
        # The scene through whose middle a cut was laid.
        self._laid: SceneOpened | None = None

    def cut(self, on: bool) -> None:
        """Cut the picture, or show all of it again."""
        values = self._session.roster.modules[_SCENE].values
        if not on:
            self._axis = str(values["section"])
            self._send(section=_OFF)
            return
        scene = self._session.last(SceneOpened)
        if scene is None or scene is self._laid:
            self._send(section=self._axis)
            return
        self._laid = scene
        axis = "xyz".index(self._axis)
        middle_m = 0.5 * (scene.lower_m[axis] + scene.upper_m[axis])
        self._send(section=self._axis, section_m=round(middle_m, 2))

    def _send(self, **values: object) -> None:
        self._session.send(
            *(SetSetting(module=_SCENE, name=name, value=value) for name, value in values.items())
        )
