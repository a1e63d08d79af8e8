"""A session as a project, and a project as inputs for a session."""

from pathlib import Path

import msgspec
from platformdirs import user_documents_path

from vrut_lite.app.engine.session import Session
from vrut_lite.bundled.places import is_bundled
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ClockMoved, Input, Message, SetClock, SetSetting
from vrut_lite.messages.ground import SetGround
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.picture import Resize, SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.messages.tolerance import SetTolerance
from vrut_lite.project import (
    PROJECT_PARTS,
    CameraView,
    Project,
    daylight_inputs,
    setting_inputs,
    view_inputs,
)
from vrut_lite.scene.settings import SCENE

_FORETOLD = (SetPlace, SetClock, SetTolerance, SetHaze, SetGround, SetExposure)


def project_of(session: Session) -> Project:
    """The present session as a project, with the settings that differ from their defaults."""
    modules = session.catalogue.modules
    fields: dict[str, object] = dict(modules[SCENE].values) if SCENE in modules else {}
    fields["slots"] = {slot: holder for slot, holder in session.catalogue.holders.items() if holder}
    fields["settings"] = {
        name: changed
        for name, module in modules.items()
        if name != SCENE and (changed := module.changed_values)
    }
    for part in PROJECT_PARTS.values():
        if (message := part.sent(session)) is not None:
            fields |= part.fields_of(message)
    # Also a camera that the scene brings, or that frames it.
    if session.camera is not None:
        fields["camera"] = CameraView.of(session.camera)
    return msgspec.structs.replace(Project(), **fields)


def foretold(project: Project) -> list[Message]:
    """The messages of a project that no module computes: a window shows them before its host is
    open. What the project states wrongly is left out, and refused when it is opened."""
    found: list[Message] = []
    for kind in _FORETOLD:
        part = PROJECT_PARTS[kind]
        try:
            message = part.input_of(project) or part.default
        except UserError:
            continue
        if isinstance(message, SetClock):
            found.append(ClockMoved(instant=message.instant))
        elif message is not None:
            found.append(message)
    return found


def folder_of(session: Session) -> str:
    """The folder of the open scene, or an empty text; of an example that of the user's documents.

    An upgrade removes files beside an installed example.
    """
    scene = session.last(SceneOpened)
    if scene is None:
        return ""
    path = Path(scene.path).resolve()
    return str(user_documents_path() if is_bundled(path) else path.parent)


def inputs_of(project: Project, kernel: Kernel) -> list[Input]:
    """Inputs for a project, and for the defaults of all settings that it leaves out, except size.

    Raises:
        UserError: the project contains an impossible value.
    """
    left_out = (Resize,) if project.scene else (Resize, LoadScene)
    named = [
        *setting_inputs(project, kernel),
        *daylight_inputs(project),
        *(m for m in view_inputs(project) if not isinstance(m, left_out)),
    ]
    said = {(m.module, m.name) for m in named if isinstance(m, SetSetting)}
    to_default: list[Input] = [
        SetSetting(module=module, name=name, value=default)
        for module, seat in kernel.seats.items()
        for name, default in msgspec.structs.asdict(type(seat.settings)()).items()
        if (module, name) not in said and getattr(seat.settings, name) != default
    ]
    kinds = {type(m) for m in named}
    to_default += [
        part.default
        for kind, part in PROJECT_PARTS.items()
        if kind not in kinds and part.default is not None and part.present(kernel) != part.default
    ]
    return [*to_default, *named]
