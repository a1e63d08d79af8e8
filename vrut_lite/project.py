"""A project: a scene, a place, a time and a view; read from TOML, written, and made inputs."""

import math
import os
import stat
import tomllib
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

import msgspec
import numpy as np
import tomli_w

from vrut_lite.atmosphere.aerosols.own import OwnAerosol
from vrut_lite.atmosphere.aerosols.types import MOST_HUMIDITY, USUAL_HUMIDITY
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, ClockMoved, Input, SetClock, SetSetting
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.glazing import Glazing, GlazingFile
from vrut_lite.messages.ground import DEFAULT_GROUND, SCENE_BORDER, SetGround, parse_ground
from vrut_lite.messages.haze import (
    DEFAULT_AEROSOL,
    DEFAULT_HAZE,
    MOST_NITROGEN_DIOXIDE_DU,
    MOST_OPTICAL_DEPTH,
    MOST_STRATOSPHERE_DEPTH,
    SCALE_HEIGHTS_M,
    STRATOSPHERE_PEAKS_KM,
    AerosolType,
    SetHaze,
)
from vrut_lite.messages.lighting import LampPlacement, LightingControl
from vrut_lite.messages.picture import LARGEST_PICTURE_PX, NightLook, Resize, SetExposure, ToneMap
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.placement import PlacedFile, Placement
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE, Remembers, SetTolerance
from vrut_lite.messages.weather import SetWeather
from vrut_lite.place_time import Place, parse_instant, parse_place
from vrut_lite.scene.ifc_site import place_of_ifc
from vrut_lite.scene.settings import SCENE, SceneSettings
from vrut_lite.text_files import decoded, plain_text
from vrut_lite.weather.weather_file import read_weather
from vrut_lite.write_atomic import atomic_output

PROJECT_SUFFIX = ".toml"
# Ending of new projects, by which a desktop recognises them (`desktop_entry.py`).
PROJECT_ENDING = ".vrut.toml"
# Edge of a picture file.
SMALLEST_PICTURE_PX = 16
Pixels = Annotated[int, msgspec.Meta(ge=SMALLEST_PICTURE_PX, le=LARGEST_PICTURE_PX)]
# A quarter of the way to the moon.
Metres = Annotated[float, msgspec.Meta(ge=-1e8, le=1e8)]
Point = tuple[Metres, Metres, Metres]
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
        """The input that moves the camera there.

        Raises:
            UserError: eye and target are one point, or not finite.
        """
        eye, target = np.array(self.eye_m), np.array(self.target_m)
        if not _NEAREST_TARGET_M < np.linalg.norm(target - eye) < math.inf:
            raise UserError("the camera's eye and target must be two finite points, apart")
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
    night_look: NightLook = "eye"
    glare: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0


class Haze(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The aerosol above the place: the fields of `SetHaze`, with their bounds."""

    optical_depth_550: Annotated[float, msgspec.Meta(ge=0, le=MOST_OPTICAL_DEPTH)]
    aerosol: AerosolType = DEFAULT_AEROSOL
    humidity_percent: Annotated[float, msgspec.Meta(ge=0, le=MOST_HUMIDITY)] = USUAL_HUMIDITY
    own: OwnAerosol | None = None
    nitrogen_dioxide_du: (
        Annotated[float, msgspec.Meta(ge=0, le=MOST_NITROGEN_DIOXIDE_DU)] | None
    ) = None
    scale_height_m: (
        Annotated[float, msgspec.Meta(ge=SCALE_HEIGHTS_M[0], le=SCALE_HEIGHTS_M[1])] | None
    ) = None
    stratosphere_depth_550: Annotated[float, msgspec.Meta(ge=0, le=MOST_STRATOSPHERE_DEPTH)] = (
        DEFAULT_HAZE.stratosphere_depth_550
    )
    stratosphere_peak_km: Annotated[
        float, msgspec.Meta(ge=STRATOSPHERE_PEAKS_KM[0], le=STRATOSPHERE_PEAKS_KM[1])
    ] = DEFAULT_HAZE.stratosphere_peak_km

    def input(self) -> SetHaze:
        """The input that sets it."""
        return SetHaze(**msgspec.structs.asdict(self))


class Project(SceneSettings, msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The content of a picture, with the scene's settings.

    `at` is ISO time, local to the place unless it has an offset.

    `tolerance`: largest relative error of radiance; None leaves it unchanged, and so does a missing
    `haze`. `ground` is the name of a ground, with an albedo after a comma. `weather` is a file of a
    year (EPW), whose place holds where `place` is not said.
    `placement` says the scene's axes and units, `beside` lists further scenes with
    theirs, `scene_camera` is one of the cameras that they bring; `camera` goes before it.
    `luminaires` are IES files by the names of lamps, `variant` is one of the materials' variants.
    `views` are kept by name, for the window. `sensors` is a file of points at which light is
    measured, `glazing` glass by names of materials, `bsdf` measured glazing, `lamp`
    placed luminaires by names and `lighting` the control of their groups, which `vrut-lite
    daylight` reads.
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
    ground: str = SCENE_BORDER
    weather: str = ""
    sensors: str = ""
    glazing: dict[str, Glazing] = {}
    bsdf: dict[str, GlazingFile] = {}
    lamp: dict[str, LampPlacement] = {}
    lighting: dict[str, LightingControl] = {}

    def where(self) -> Place:
        """The place; UserError if the text names none."""
        return parse_place(self.place)

    def instant(self) -> datetime:
        """The aware instant; UserError if the text names none at the place."""
        return parse_instant(self.at, self.where())


class ProjectPart(NamedTuple):
    """Fields of a project that one input carries: what file, window and undo do with them.

    Attributes:
        kind: the type of the input.
        input_of: the input of a project; no input where the project leaves it open.
        fields_of: the fields that stand for an input.
        title: the title of the step that undo takes back, a format of the input; empty where the
            kind has no undo.
        default: the input that holds as long as none was sent.
        last: the input that holds in a kernel or a session; None: the last one of its type.
    """

    kind: type[Input]
    input_of: Callable[[Project], Any]
    fields_of: Callable[[Any], dict[str, Any]]
    title: str = ""
    default: Input | None = None
    last: Callable[[Remembers], Input | None] | None = None

    def sent(self, kernel: Remembers) -> Input | None:
        """The input that holds at present, if one was sent."""
        return kernel.last(self.kind) if self.last is None else self.last(kernel)

    def present(self, kernel: Remembers) -> Input | None:
        """The input that holds at present, or the default."""
        return self.sent(kernel) or self.default


def _place(project: Project) -> SetPlace:
    place = project.where()
    return SetPlace(
        latitude_deg=place.latitude_deg,
        longitude_deg=place.longitude_deg,
        altitude_m=place.altitude_m,
        north_offset_rad=math.radians(project.north_offset_deg),
    )


def _place_fields(place: SetPlace) -> dict[str, Any]:
    return {
        "place": f"{place.latitude_deg:.6g},{place.longitude_deg:.7g},{place.altitude_m:g}",
        "north_offset_deg": round(math.degrees(place.north_offset_rad), 6),
    }


def _last_clock(kernel: Remembers) -> SetClock | None:
    clock = kernel.last(ClockMoved)
    return None if clock is None else SetClock(instant=clock.instant)


def _scene(project: Project) -> LoadScene:
    return LoadScene(
        path=project.scene,
        placement=project.placement,
        beside=project.beside,
        camera=project.scene_camera,
        luminaires=tuple(project.luminaires.items()),
        variant=project.variant,
        glazing=tuple(project.glazing.items()),
    )


def _scene_fields(load: LoadScene) -> dict[str, Any]:
    return {
        "scene": load.path,
        "placement": load.placement,
        "beside": load.beside,
        "scene_camera": load.camera,
        "luminaires": dict(load.luminaires),
        "variant": load.variant,
        "glazing": dict(load.glazing),
    }


def _last_scene(kernel: Remembers) -> LoadScene | None:
    """The scene that is open, with what its file said of axes and units."""
    scene = kernel.last(SceneOpened)
    return None if scene is None else scene.opened or LoadScene(path=scene.path)


_AIR = (
    ProjectPart(
        SetTolerance, default=SetTolerance(tolerance=DEFAULT_TOLERANCE),
        input_of=lambda p: p.tolerance and SetTolerance(tolerance=p.tolerance),
        fields_of=lambda m: {"tolerance": m.tolerance}, title="tolerance {0.tolerance:.4g}",
    ),
    ProjectPart(
        SetHaze, default=DEFAULT_HAZE, input_of=lambda p: p.haze and p.haze.input(),
        fields_of=lambda m: {"haze": Haze(**msgspec.structs.asdict(m))},
        title="haze {0.optical_depth_550:.4g}, {0.aerosol}",
    ),
    ProjectPart(
        SetGround, default=DEFAULT_GROUND, input_of=lambda p: parse_ground(p.ground),
        fields_of=lambda m: {"ground": m.text}, title="ground {0.text}",
    ),
    # Without undo: the slots that come with it are undone.
    ProjectPart(
        SetWeather, input_of=lambda p: p.weather and read_weather(p.weather),
        fields_of=lambda m: {"weather": m.path},
    ),
)  # fmt: skip
_DAYLIGHT = (
    ProjectPart(SetPlace, _place, _place_fields, title="place"),
    ProjectPart(
        SetClock, last=_last_clock, input_of=lambda p: SetClock(instant=p.instant()),
        fields_of=lambda m: {"at": m.instant.isoformat()}, title="time",
    ),
)  # fmt: skip
# Without undo but for the exposure: who looks around or opens a scene does not change it.
_VIEW = (
    ProjectPart(
        Resize, input_of=lambda p: Resize(width_px=p.size[0], height_px=p.size[1]),
        fields_of=lambda m: {"size": (m.width_px, m.height_px)},
    ),
    ProjectPart(
        SetExposure, default=SetExposure(),
        input_of=lambda p: SetExposure(**msgspec.structs.asdict(p.exposure)),
        fields_of=lambda m: {"exposure": Exposure(**msgspec.structs.asdict(m))}, title="exposure",
    ),
    ProjectPart(LoadScene, _scene, _scene_fields, last=_last_scene),
    ProjectPart(
        MoveCamera, input_of=lambda p: p.camera and p.camera.camera(),
        fields_of=lambda m: {"camera": CameraView.of(m)},
    ),
)  # fmt: skip
# All fields of a project but those of the scene manager (`SceneSettings`), of modules (`settings`,
# `slots`), and those that no input carries (`views`, `sensors`, `bsdf`, `lamp`, `lighting`).
PROJECT_PARTS = {part.kind: part for part in (*_AIR, *_DAYLIGHT, *_VIEW)}


def _inputs(parts: Sequence[ProjectPart], project: Project) -> list[Input]:
    return [message for part in parts if (message := part.input_of(project))]


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
        values = tomllib.loads(decoded(plain_text(file.read_bytes())))
        if isinstance(values.get("at"), datetime):
            # A bare TOML date is the natural way to write one.
            values["at"] = values["at"].isoformat()
        exposure = values.get("exposure")
        if isinstance(exposure, dict) and exposure.get("tone_map") == "eye":
            # The look of nights was a tone map.
            exposure["tone_map"] = "agx"
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
    if SCENE in project.settings:
        raise UserError(
            f"the project {file} has a table settings.{SCENE}: write its lines above all tables"
        )
    project = _with_paths(project, lambda path: str(file.parent / path))
    project = _with_named_files(project, file.parent, str)
    if says_place:
        return project
    if project.weather:
        return with_weather(project, project.weather)
    return with_place_of_scene(project)


def with_weather(project: Project, path: str) -> Project:
    """The project under the weather of a file, at its place; UserError if it cannot be read."""
    place = read_weather(path).place
    text = f"{place.latitude_deg:g},{place.longitude_deg:g},{place.altitude_m:g}"
    return msgspec.structs.replace(project, weather=path, place=text)


def with_place_of_scene(project: Project) -> Project:
    """The project at the place and north of its scene's file, where that states them (IFC)."""
    place = place_of_ifc(project.scene)
    return project if place is None else msgspec.structs.replace(project, **_place_fields(place))


def _with_paths(project: Project, change: Callable[[str], str]) -> Project:
    """The project with the paths of its scenes changed."""
    beside = tuple(
        msgspec.structs.replace(placed, scene=change(placed.scene)) for placed in project.beside
    )
    luminaires = {name: change(path) for name, path in project.luminaires.items()}
    bsdf = {name: glazing.with_paths(change) for name, glazing in project.bsdf.items()}
    lamp = {
        name: msgspec.structs.replace(placed, file=placed.file and change(placed.file))
        for name, placed in project.lamp.items()
    }
    return msgspec.structs.replace(
        project,
        scene=change(project.scene),
        beside=beside,
        luminaires=luminaires,
        weather=project.weather and change(project.weather),
        sensors=project.sensors and change(project.sensors),
        bsdf=bsdf,
        lamp=lamp,
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

    The place is the scene's own where its file states one.

    Raises:
        UserError: a project file cannot be read.
    """
    if path is not None and Path(path).suffix.lower() == PROJECT_SUFFIX:
        return load_project(path)
    return with_place_of_scene(Project(scene=path or ""))


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
    # The scene stands first in the file.
    values = {"scene": project.scene, **msgspec.to_builtins(project)}
    # TOML has no null: a missing key means None, and a setting that is None is the text "none".
    for table in values["settings"].values():
        table.update({name: "none" for name, value in table.items() if value is None})
    for placed in (values, *values["beside"]):
        placed["placement"] = _said(placed["placement"])
    if values["haze"] is not None:
        values["haze"] = _without_empty(values["haze"])
    values["beside"] = [_without_empty(placed) for placed in values["beside"]]
    for table in ("lamp", "lighting"):
        values[table] = {name: _without_empty(one) for name, one in values[table].items()}
    return tomli_w.dumps(_without_empty(values))


def _said(placement: dict[str, Any]) -> dict[str, Any]:
    """Fields of a placement that differ from the default."""
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
    for message in _inputs(_AIR, project):
        if isinstance(message, SetWeather):
            inputs += weather_inputs(message, kernel, project.slots)
        else:
            inputs.append(message)
    for module, values in project.settings.items():
        kernel.check_module(module)
        for name, value in values.items():
            checked = kernel.check_setting(module, name, value)
            inputs.append(SetSetting(module=module, name=name, value=checked))
    for slot, module in project.slots.items():
        kernel.check_holder(slot, module)
        inputs.append(ChooseSlot(slot=slot, module=module))
        # A sky with its own sun also holds the slot `sun`, unless the project names another holder.
        own_sun = not getattr(kernel.seats[module].module_type, "follows_sun", True)
        if slot == "sky" and own_sun and "sun" not in project.slots:
            inputs.append(ChooseSlot(slot="sun", module=module))
    return inputs


def daylight_inputs(project: Project) -> list[Input]:
    """Place and time as inputs."""
    return _inputs(_DAYLIGHT, project)


def view_inputs(project: Project) -> list[Input]:
    """The scene's settings, size, exposure, scene and camera as inputs."""
    own = [
        SetSetting(module=SCENE, name=name, value=getattr(project, name))
        for name in SceneSettings.__struct_fields__
    ]
    return [*own, *_inputs(_VIEW, project)]
