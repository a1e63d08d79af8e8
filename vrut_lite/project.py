"""A project: a scene, a place, a time and a view; read from TOML, written, and made inputs."""

import math
import os
import stat
import tomllib
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import msgspec
import numpy as np
import tomli_w

from vrut_lite.atmosphere.aerosols.own import OwnAerosol
from vrut_lite.atmosphere.aerosols.types import MOST_HUMIDITY, USUAL_HUMIDITY
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, Input, SetClock, SetSetting
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.glazing import Glazing
from vrut_lite.messages.haze import DEFAULT_AEROSOL, MOST_OPTICAL_DEPTH, AerosolType, SetHaze
from vrut_lite.messages.picture import Resize, SetExposure, ToneMap
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.placement import PlacedFile, Placement
from vrut_lite.messages.scene import LoadScene
from vrut_lite.messages.section import Axis, Side
from vrut_lite.messages.tolerance import SetTolerance
from vrut_lite.messages.weather import SetWeather
from vrut_lite.place_time import Place, parse_instant, parse_place
from vrut_lite.scene.scene_state import Shown
from vrut_lite.weather.weather_file import read_weather
from vrut_lite.write_atomic import atomic_output

PROJECT_SUFFIX = ".toml"
Pixels = Annotated[int, msgspec.Meta(ge=16, le=8192)]
# A quarter of the way to the moon.
Metres = Annotated[float, msgspec.Meta(ge=-1e8, le=1e8)]
Point = tuple[Metres, Metres, Metres]
# Of the scene manager, which a project has as fields of its own.
SCENE_SETTINGS = (
    "air", "light_shafts", "shows", "animation", "animation_time_s",
    "section", "section_at", "section_keeps",
)  # fmt: skip
_NEAREST_TARGET_M = 1e-6
_MOST_BYTES = 1 << 20


class CameraView(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The camera's eye and target, metres in world axes."""

    eye_m: Point
    target_m: Point
    vertical_field_of_view_deg: Annotated[float, msgspec.Meta(ge=1, le=150)] = 43.0

    @classmethod
    def of(cls, camera: MoveCamera) -> Self:
        """The view of a camera."""
        return cls(
            eye_m=camera.eye_m,
            target_m=camera.target_m,
            vertical_field_of_view_deg=math.degrees(camera.vertical_field_of_view_rad),
        )

    def camera(self) -> MoveCamera:
        """The input that moves the camera there."""
        return MoveCamera(
            eye_m=self.eye_m,
            target_m=self.target_m,
            vertical_field_of_view_rad=math.radians(self.vertical_field_of_view_deg),
        )


class Exposure(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Exposure, white balance and tone map: the fields of `SetExposure`, with their bounds."""

    mode: Literal["auto", "manual"] = "auto"
    ev100: Annotated[float, msgspec.Meta(ge=-20, le=40)] = 15.0
    compensation_ev: Annotated[float, msgspec.Meta(ge=-20, le=20)] = 0.0
    tone_map: ToneMap = "agx"
    white_temperature_k: Annotated[float, msgspec.Meta(ge=1700, le=25000)] = 6504.0
    white_duv: Annotated[float, msgspec.Meta(ge=-0.05, le=0.05)] = 0.0


class Haze(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The aerosol above the place: the fields of `SetHaze`, with their bounds."""

    optical_depth_550: Annotated[float, msgspec.Meta(ge=0, le=MOST_OPTICAL_DEPTH)]
    aerosol: AerosolType = DEFAULT_AEROSOL
    humidity_percent: Annotated[float, msgspec.Meta(ge=0, le=MOST_HUMIDITY)] = USUAL_HUMIDITY
    own: OwnAerosol | None = None

    def input(self) -> SetHaze:
        """The input that sets it."""
        return SetHaze(
            optical_depth_550=self.optical_depth_550,
            aerosol=self.aerosol,
            humidity_percent=self.humidity_percent,
            own=self.own,
        )


class Project(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The content of a picture. `at` is ISO time, local to the place unless it has an offset.

    `tolerance`: largest relative error of radiance; None leaves it unchanged, and so does a missing
    `haze`. `weather` is a file of a year (EPW), whose place holds where `place` is not said.
    `placement` says the scene's axes and units, `beside` lists further scenes with
    theirs, `scene_camera` is one of the cameras that they bring; `camera` goes before it.
    `luminaires` are IES files by the names of lamps, `variant` is one of the materials' variants.
    `animation` and `animation_time_s` say how the scene's own animations stand.
    `views` are kept by name, for the window. `sensors` is a file of points at which light is
    measured, `glazing` glass by names of materials.
    """

    scene: str = ""
    placement: Placement = Placement()
    beside: tuple[PlacedFile, ...] = ()
    scene_camera: str = ""
    luminaires: dict[str, str] = {}
    variant: str = ""
    place: str = "50.0755,14.4378,200"
    at: str = "2026-06-21T16:00"
    north_offset_deg: Annotated[float, msgspec.Meta(ge=-360, le=360)] = 0.0
    slots: dict[str, str] = {}
    settings: dict[str, dict[str, Any]] = {}
    camera: CameraView | None = None
    views: dict[str, CameraView] = {}
    exposure: Exposure = Exposure()
    size: tuple[Pixels, Pixels] = (960, 540)
    tolerance: Annotated[float, msgspec.Meta(gt=0, le=1)] | None = None
    haze: Haze | None = None
    weather: str = ""
    air: bool = True
    light_shafts: bool = False
    shows: Shown = "picture"
    animation: Literal["rest", "time", "clock"] = "rest"
    animation_time_s: Annotated[float, msgspec.Meta(ge=0, le=3600)] = 0.0
    sensors: str = ""
    glazing: dict[str, Glazing] = {}
    section: Axis = "off"
    section_at: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.5
    section_keeps: Side = "below"

    def where(self) -> Place:
        """The place; UserError if the text names none."""
        return parse_place(self.place)

    def instant(self) -> datetime:
        """The aware instant; UserError if the text names none at the place."""
        return parse_instant(self.at, self.where())


def load_project(path: str | Path) -> Project:
    """Read a project file; paths are relative to it, also those among the settings.

    Raises:
        UserError: the file is missing, no TOML, or has unknown or invalid entries.
    """
    file = Path(path)
    try:
        state = file.stat()
        if not stat.S_ISREG(state.st_mode):
            raise UserError(f"cannot open the project {file}: it is not a regular file")
        if state.st_size > _MOST_BYTES:
            raise UserError(
                f"the project {file} is too large, {state.st_size:,} bytes: none has more than "
                f"{_MOST_BYTES:,}"
            )
        values = tomllib.loads(file.read_text(encoding="utf-8"))
        if isinstance(values.get("at"), datetime):
            # A bare TOML date is the natural way to write one.
            values["at"] = values["at"].isoformat()
        project = msgspec.convert(values, Project)
        says_place = "place" in values
    except OSError as error:
        raise UserError(f"cannot open the project {file}: {error.strerror or error}") from None
    except msgspec.ValidationError as error:
        raise UserError(f"cannot read the project {file}: {in_words(error)}") from None
    except ValueError as error:
        raise UserError(f"the project {file} is no TOML: {error}") from None
    except RecursionError:
        raise UserError(f"the project {file} is nested too deeply: write it anew") from None
    if not project.scene:
        raise UserError(f'the project {file} names no scene: add a line scene = "FILE"')
    project = _with_paths(project, lambda path: str(file.parent / path))
    project = _with_named_files(project, file.parent, str)
    if project.weather and not says_place:
        return with_weather(project, project.weather)
    return project


def with_weather(project: Project, path: str) -> Project:
    """The project under the weather of a file, at its place; UserError if it cannot be read."""
    place = read_weather(path).place
    text = f"{place.latitude_deg:g},{place.longitude_deg:g},{place.altitude_m:g}"
    return msgspec.structs.replace(project, weather=path, place=text)


def _with_paths(project: Project, change: Callable[[str], str]) -> Project:
    """The project with the paths of its scenes changed."""
    beside = tuple(
        msgspec.structs.replace(placed, scene=change(placed.scene)) for placed in project.beside
    )
    luminaires = {name: change(path) for name, path in project.luminaires.items()}
    return msgspec.structs.replace(
        project,
        scene=change(project.scene),
        beside=beside,
        luminaires=luminaires,
        weather=project.weather and change(project.weather),
        sensors=project.sensors and change(project.sensors),
    )


def _with_named_files(project: Project, folder: Path, change: Callable[[Path], str]) -> Project:
    """The project with texts among its settings changed that name a file, seen from a folder.

    Modules have settings that are paths; the host does not know which.
    """

    def changed(value: Any) -> Any:
        if not (isinstance(value, str) and value):
            return value
        path = os.path.join(folder, os.path.expanduser(value))
        return change(Path(path)) if os.path.isfile(path) else value

    settings = {
        module: {name: changed(value) for name, value in values.items()}
        for module, values in project.settings.items()
    }
    return msgspec.structs.replace(project, settings=settings)


def project_of_path(path: str | None) -> Project:
    """The project in a project file; of a scene's file, or none, a project with defaults.

    Raises:
        UserError: a project file cannot be read.
    """
    if path is not None and Path(path).suffix.lower() == PROJECT_SUFFIX:
        return load_project(path)
    return Project(scene=path or "")


def save_project(path: str | Path, project: Project) -> None:
    """Write a project file; paths are made relative to it.

    Raises:
        UserError: it cannot be written.
    """
    file = Path(path)
    folder = file.resolve().parent
    project = _with_paths(project, lambda path: _relative(path, folder))
    project = _with_named_files(project, Path(), lambda path: _relative(str(path), folder))
    text = project_text(project)
    try:
        with atomic_output(file) as unfinished:
            unfinished.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UserError(f"cannot write {file}: {error.strerror or error}") from None


def _relative(path: str, folder: Path) -> str:
    return Path(os.path.relpath(Path(path).resolve(), folder)).as_posix()


def project_text(project: Project) -> str:
    """A project as TOML."""
    values = msgspec.to_builtins(project)
    # TOML has no null: a missing key means None, and a setting that is None is the text "none".
    for table in values["settings"].values():
        table.update({name: "none" for name, value in table.items() if value is None})
    for placed in (values, *values["beside"]):
        placed["placement"] = _said(placed["placement"])
    if values["haze"] is not None:
        values["haze"] = _without_empty(values["haze"])
    values["beside"] = [_without_empty(placed) for placed in values["beside"]]
    return tomli_w.dumps(_without_empty(values))


def _said(placement: dict[str, Any]) -> dict[str, Any]:
    """What a placement says that is not the default."""
    default = msgspec.to_builtins(Placement())
    return {key: value for key, value in placement.items() if value != default[key]}


def _without_empty(values: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in values.items() if value not in (None, {}, [], ())}


def in_words(error: msgspec.ValidationError) -> str:
    """The error with the path of its value, as `camera.eye_m: expected array of length 3`."""
    text, _, path = str(error).replace("`", "").partition(" - at $")
    text = text[:1].lower() + text[1:]
    return f"{path.lstrip('.')}: {text}" if path else text


def weather_inputs(weather: SetWeather, kernel: Kernel, slots: Mapping[str, str]) -> list[Input]:
    """The weather, and its sky and sun in the slots that `slots` leaves open.

    A module that hears `SetWeather` and makes a sky follows the weather. Where another sky is
    chosen, no slot is handed over.

    Raises:
        UserError: no such module is installed.
    """
    followers = [
        seat.module_type.manifest
        for seat in kernel.seats.values()
        if SetWeather in seat.methods and "sky" in seat.manifest.provides
    ]
    if not followers:
        raise UserError("no installed module follows the weather: see `vrut-lite modules`")
    name = slots.get("sky", followers[0].name)
    follower = next((manifest for manifest in followers if manifest.name == name), None)
    handed = [
        ChooseSlot(slot=slot, module=name)
        for slot in (() if follower is None else follower.provides)
        if slot not in slots
    ]
    return [weather, *handed]


def setting_inputs(project: Project, kernel: Kernel) -> list[Input]:
    """Tolerance, haze, weather, settings and slots as inputs, checked against the modules."""
    inputs: list[Input] = []
    if project.tolerance is not None:
        inputs.append(SetTolerance(tolerance=project.tolerance))
    if project.haze is not None:
        inputs.append(project.haze.input())
    if project.weather:
        inputs += weather_inputs(read_weather(project.weather), kernel, project.slots)
    for module, values in project.settings.items():
        kernel.check_module(module)
        for name, value in values.items():
            checked = kernel.check_setting(module, name, value)
            inputs.append(SetSetting(module=module, name=name, value=checked))
    for slot, module in project.slots.items():
        kernel.check_holder(slot, module)
        inputs.append(ChooseSlot(slot=slot, module=module))
        # A sky with a sun of its own tells where that stands, unless another is asked for.
        own_sun = not getattr(kernel.seats[module].module_type, "follows_sun", True)
        if slot == "sky" and own_sun and "sun" not in project.slots:
            inputs.append(ChooseSlot(slot="sun", module=module))
    return inputs


def daylight_inputs(project: Project) -> list[Input]:
    """Place and time as inputs."""
    place = project.where()
    return [
        SetPlace(
            latitude_deg=place.latitude_deg,
            longitude_deg=place.longitude_deg,
            altitude_m=place.altitude_m,
            north_offset_rad=math.radians(project.north_offset_deg),
        ),
        SetClock(instant=project.instant()),
    ]


def view_inputs(project: Project) -> list[Input]:
    """Air, light shafts, animations, size, exposure, scene and camera as inputs."""
    exposure = SetExposure(**msgspec.structs.asdict(project.exposure))
    inputs: list[Input] = [
        *(
            SetSetting(module="scene", name=name, value=getattr(project, name))
            for name in SCENE_SETTINGS
        ),
        Resize(width_px=project.size[0], height_px=project.size[1]),
        exposure,
        LoadScene(
            path=project.scene,
            placement=project.placement,
            beside=project.beside,
            camera=project.scene_camera,
            luminaires=tuple(project.luminaires.items()),
            variant=project.variant,
            glazing=tuple(project.glazing.items()),
        ),
    ]
    if project.camera is not None:
        eye, target = np.array(project.camera.eye_m), np.array(project.camera.target_m)
        if not _NEAREST_TARGET_M < np.linalg.norm(target - eye) < math.inf:
            raise UserError("the camera's eye and target must be two finite points, apart")
        inputs.append(project.camera.camera())
    return inputs
