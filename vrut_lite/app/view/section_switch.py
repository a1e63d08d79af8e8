"""Switches the section plane on and off."""

from vrut_lite.app.engine.session import Session
from vrut_lite.kernel.messages import SetSetting

_SCENE, _SETTING, _OFF = "scene", "section", "off"
_FIRST_AXIS = "y"


class SectionSwitch:
    """Axis, place and side are settings of the scene, in its panel; this remembers the axis."""

    def __init__(self, session: Session):
        self._session = session
        self._axis = _FIRST_AXIS

    def cut(self, on: bool) -> None:
        """Cut the picture, or show all of it again."""
        if not on:
            self._axis = str(self._session.catalogue.modules[_SCENE].values[_SETTING])
        value = self._axis if on else _OFF
        self._session.send(SetSetting(module=_SCENE, name=_SETTING, value=value))
