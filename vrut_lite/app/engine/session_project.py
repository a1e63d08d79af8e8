"""A session as a project, and a project as inputs for a session."""

import math
from pathlib import Path

import msgspec

from vrut_lite.app.engine.session import Session
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ClockMoved, Input, SetSetting
from vrut_lite.messages.haze import DEFAULT_HAZE, SetHaze, haze_of
from vrut_lite.messages.picture import Resize, SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE, SetTolerance, tolerance_of
from vrut_lite.messages.weather import SetWeather
from vrut_lite.project import (
    SCENE_SETTINGS,
    CameraView,
    Exposure,
    Haze,
    Project,
    daylight_inputs,
    setting_inputs,
    view_inputs,
)

# The scene manager: a project file has fields of its own for its settings.
_SCENE = "scene"


def project_of(session: Session) -> Project:
    """The present session as a project, with the settings that differ from their defaults."""
    modules = session.roster.modules
    project = Project(
        slots={slot: holder for slot, holder in session.roster.holders.items() if holder},
        settings={
            name: changed
            for name, module in modules.items()
            if name != _SCENE and (changed := module.changed_values)
        },
    )
    found: dict[str, object] = {}
    if _SCENE in modules:
        found |= {name: modules[_SCENE].values[name] for name in SCENE_SETTINGS}
    if (scene := session.last(SceneOpened)) is not None:
        found["scene"] = scene.path
        if scene.opened is not None:
            opened = scene.opened
            found |= {"placement": opened.placement, "beside": opened.beside}
            found |= {"scene_camera": opened.camera, "luminaires": dict(opened.luminaires)}
            found |= {"variant": opened.variant, "glazing": dict(opened.glazing)}
    if (clock := session.last(ClockMoved)) is not None:
        found["at"] = clock.instant.isoformat()
    if (place := session.last(SetPlace)) is not None:
        found["place"] = f"{place.latitude_deg:.6g},{place.longitude_deg:.7g},{place.altitude_m:g}"
        found["north_offset_deg"] = round(math.degrees(place.north_offset_rad), 6)
    if (exposure := session.last(SetExposure)) is not None:
        found["exposure"] = Exposure(**msgspec.structs.asdict(exposure))
    if (tolerance := session.last(SetTolerance)) is not None:
        found["tolerance"] = tolerance.tolerance
    if (haze := session.last(SetHaze)) is not None:
        found["haze"] = Haze(haze.optical_depth_550, haze.aerosol, haze.humidity_percent, haze.own)
    if (weather := session.last(SetWeather)) is not None:
        found["weather"] = weather.path
    if (size := session.last(Resize)) is not None:
        found["size"] = (size.width_px, size.height_px)
    if session.camera is not None:
        found["camera"] = CameraView.of(session.camera)
    return msgspec.structs.replace(project, **found)


def folder_of(session: Session) -> str:
    """The folder of the open scene; empty if there is none."""
    scene = session.last(SceneOpened)
    return "" if scene is None else str(Path(scene.path).resolve().parent)


def inputs_of(project: Project, kernel: Kernel) -> list[Input]:
    """Inputs for a project, and for the defaults of all settings that it leaves out, except size.

    Raises:
        UserError: the project contains an impossible value.
    """
    named = setting_inputs(project, kernel)
    said = {(m.module, m.name) for m in named if isinstance(m, SetSetting)}
    to_default: list[Input] = [
        SetSetting(module=module, name=name, value=default)
        for module, seat in kernel.seats.items()
        for name, default in msgspec.structs.asdict(type(seat.settings)()).items()
        if (module, name) not in said
        and module != _SCENE
        and getattr(seat.settings, name) != default
    ]
    if project.tolerance is None and tolerance_of(kernel) != DEFAULT_TOLERANCE:
        to_default.append(SetTolerance(tolerance=DEFAULT_TOLERANCE))
    if project.haze is None and haze_of(kernel) != DEFAULT_HAZE:
        to_default.append(DEFAULT_HAZE)
    left_out = (Resize,) if project.scene else (Resize, LoadScene)
    view = [m for m in view_inputs(project) if not isinstance(m, left_out)]
    return [*to_default, *named, *daylight_inputs(project), *view]
