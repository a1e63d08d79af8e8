"""What the window shows, as a project: kept up to date from the messages."""

import math
from typing import Any

import msgspec

from vrut_lite.app.roster import Roster
from vrut_lite.app.session import Session
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.picture import Resize, SetExposure
from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.scene import LoadScene, SceneOpened
from vrut_lite.daylight.tolerance import DEFAULT_TOLERANCE, SetTolerance, tolerance_of
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ClockMoved, Input, SetSetting, SettingChanged, SlotChanged
from vrut_lite.project import (
    CameraView,
    Exposure,
    Project,
    daylight_inputs,
    setting_inputs,
    view_inputs,
)

# Settings that a project file has fields of its own for.
_SCENE = "scene"


class ProjectKeeper:
    """Listens to a session; `project` is what it is like now."""

    def __init__(self, session: Session):
        self.project = Project()
        self._defaults: dict[str, dict[str, Any]] = {}
        self._values: dict[str, dict[str, Any]] = {}
        session.ready.connect(self._know)
        session.listen(SceneOpened, lambda m: self._set(scene=m.path))
        session.listen(ClockMoved, lambda m: self._set(at=m.instant.isoformat()))
        session.listen(SetPlace, self._note_place)
        session.listen(SlotChanged, self._note_slot)
        session.listen(SettingChanged, self._note_setting)
        session.listen(SetExposure, self._note_exposure)
        session.listen(SetTolerance, lambda m: self._set(tolerance=m.tolerance))
        session.listen(Resize, lambda m: self._set(size=(m.width_px, m.height_px)))
        session.camera_moved.connect(self._note_camera)

    def _set(self, **changes: Any) -> None:
        self.project = msgspec.structs.replace(self.project, **changes)

    def _know(self, roster: Roster) -> None:
        self._values = {name: dict(info.values) for name, info in roster.modules.items()}
        self._defaults = {
            name: {key: spec.default for key, spec in info.specs.items()}
            for name, info in roster.modules.items()
        }
        self._set(slots={**roster.holders, **self.project.slots})
        self._keep_settings()

    def _note_place(self, place: SetPlace) -> None:
        self._set(
            place=f"{place.latitude_deg:.6g},{place.longitude_deg:.7g},{place.altitude_m:g}",
            north_offset_deg=round(math.degrees(place.north_offset_rad), 6),
        )

    def _note_slot(self, message: SlotChanged) -> None:
        if message.holder:
            self._set(slots={**self.project.slots, message.name: message.holder})

    def _note_setting(self, message: SettingChanged) -> None:
        self._values.setdefault(message.module, {})[message.name] = message.value
        self._keep_settings()

    def _keep_settings(self) -> None:
        """What differs from the defaults, in the project's own fields or among its settings."""
        changed = {
            module: {
                name: value
                for name, value in values.items()
                if value != self._defaults.get(module, {}).get(name)
            }
            for module, values in self._values.items()
        }
        scene = self._values.get(_SCENE, {})
        self._set(
            settings={m: v for m, v in changed.items() if v and m != _SCENE},
            air=scene.get("air", True),
            light_shafts=scene.get("light_shafts", False),
        )

    def _note_exposure(self, wish: SetExposure) -> None:
        self._set(exposure=Exposure(**msgspec.structs.asdict(wish)))

    def _note_camera(self, camera: MoveCamera) -> None:
        self._set(
            camera=CameraView(
                eye_m=camera.eye_m,
                target_m=camera.target_m,
                vertical_field_of_view_deg=math.degrees(camera.vertical_field_of_view_rad),
            )
        )


def inputs_of(project: Project, kernel: Kernel) -> list[Input]:
    """All that a project says, and defaults for what it does not; but for the picture's size.

    Raises:
        UserError: it says something wrong.
    """
    named = setting_inputs(project, kernel)
    said = {(m.module, m.name) for m in named if isinstance(m, SetSetting)}
    rest: list[Input] = [
        SetSetting(module=module, name=name, value=default)
        for module, seat in kernel.seats.items()
        for name, default in msgspec.structs.asdict(type(seat.settings)()).items()
        if (module, name) not in said
        and module != _SCENE
        and getattr(seat.settings, name) != default
    ]
    if project.tolerance is None and tolerance_of(kernel) != DEFAULT_TOLERANCE:
        rest.append(SetTolerance(tolerance=DEFAULT_TOLERANCE))
    left_out = (Resize,) if project.scene else (Resize, LoadScene)
    view = [m for m in view_inputs(project) if not isinstance(m, left_out)]
    return [*rest, *named, *daylight_inputs(project), *view]
