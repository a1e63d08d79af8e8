"""Options that several commands share, and a project made from them."""

import math
from collections.abc import Callable, Iterable
from typing import Any

import click
import msgspec

from vrut_lite.atmosphere.aerosol import (
    LEAST_TURBIDITY,
    MOST_TURBIDITY,
    optical_depth_of_turbidity,
)
from vrut_lite.atmosphere.aerosols import type_optics
from vrut_lite.atmosphere.aerosols.types import MOST_HUMIDITY, USUAL_HUMIDITY
from vrut_lite.discovery import discover
from vrut_lite.errors import UserError
from vrut_lite.kernel.settings import SettingSpec, change, describe
from vrut_lite.messages.ground import GROUND_NAMES, OWN_ALBEDOS, parse_ground
from vrut_lite.messages.haze import (
    AEROSOL_TYPES,
    DEFAULT_HAZE,
    MOST_NITROGEN_DIOXIDE_DU,
    MOST_OPTICAL_DEPTH,
    MOST_STRATOSPHERE_DEPTH,
    ONE_LOBE,
    OWN_HAZE,
    SCALE_HEIGHTS_M,
    STRATOSPHERE_PEAKS_KM,
)
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE
from vrut_lite.plain_numbers import plain_float
from vrut_lite.project import Haze, Project, in_words, with_weather
from vrut_lite.scene.settings import SCENE, SceneSettings
from vrut_lite.studio.number_types import FiniteRange
from vrut_lite.weather.weather_checks import far_from
from vrut_lite.weather.weather_file import read_weather

Command = Callable[..., Any]


_PREFIX = "setting_"


def _tolerance(text: str) -> float:
    """The share that --tolerance names, in percent or as a number."""
    number, percent, rest = text.strip().partition("%")
    try:
        share = plain_float(number) / (100.0 if percent else 1.0)
    except ValueError:
        share = math.nan
    if rest or not 0.0 < share <= 1.0:
        raise UserError(f"--tolerance {text} is no share above 0 and up to 1: say 1% or 0.01")
    return share


def _ground(text: str) -> str:
    """The text of --ground, which names a ground."""
    return parse_ground(text).text


def daylight_options(command: Command) -> Command:
    """Add --at, --place, --north-offset, --weather, --haze, --turbidity, --aerosol, --humidity,
    --haze-height, --stratosphere, --stratosphere-peak, --no2, --ground, --sky, --tolerance, --set
    and an option per setting.

    Stands above the command's own options, which are listed first all the same. A setting whose
    name is that of another option is reached by --set alone.
    """
    own = _taken_from(command)
    shared = [
        click.option("--at", metavar="TIME", help="ISO time; local at the place if it has no "
                     "offset, as 2026-06-21T18:30 or 2026-06-21T16:30Z."),
        click.option("--place", metavar="LAT,LON[,ALT]",
                     help="Degrees, north and east positive; altitude in metres."),
        click.option("--north-offset", "north_offset_deg", type=FiniteRange(-360.0, 360.0),
                     metavar="DEG", help="How far the scene's -Z axis points clockwise of "
                     "true north."),
        click.option("--weather", metavar="FILE.epw",
                     help="A year of weather: its place, and the sky of its hours."),
        click.option("--haze", "optical_depth_550", type=FiniteRange(0.0, MOST_OPTICAL_DEPTH),
                     metavar="DEPTH", help="Haze of every sky: the aerosol's optical depth at "
                     f"550 nm. Default {DEFAULT_HAZE.optical_depth_550:.2f}."),
        click.option("--turbidity", type=FiniteRange(LEAST_TURBIDITY, MOST_TURBIDITY),
                     metavar="T", help="The same on Preetham's scale: 2 is clear, 6 is hazy, "
                     f"{DEFAULT_HAZE.turbidity:g} is the default haze."),
        click.option("--aerosol", type=click.Choice(AEROSOL_TYPES), metavar="TYPE",
                     help="What that haze is made of: a type of OPAC, as desert, or one-lobe. "
                     "Without --haze the type's published depth. Default "
                     f"{DEFAULT_HAZE.aerosol}."),
        click.option("--humidity", "humidity_percent", type=FiniteRange(0.0, MOST_HUMIDITY),
                     metavar="%", help="Of the lower air, in which particles grow. Default "
                     f"{USUAL_HUMIDITY:g}."),
        click.option("--haze-height", "scale_height_m", type=FiniteRange(*SCALE_HEIGHTS_M),
                     metavar="M", help="Over which its lower layer thins by a factor e. Default "
                     "the type's."),
        click.option("--stratosphere", "stratosphere_depth_550", metavar="DEPTH",
                     type=FiniteRange(0.0, MOST_STRATOSPHERE_DEPTH),
                     help="What of the haze lies in the stratosphere, whose dusk is pink. Default "
                     f"{DEFAULT_HAZE.stratosphere_depth_550:g}; 0.02 and more after an eruption."),
        click.option("--stratosphere-peak", "stratosphere_peak_km", metavar="KM",
                     type=FiniteRange(*STRATOSPHERE_PEAKS_KM), help="Altitude about which it "
                     f"lies. Default {DEFAULT_HAZE.stratosphere_peak_km:g}."),
        click.option("--no2", "nitrogen_dioxide_du", metavar="DU",
                     type=FiniteRange(0.0, MOST_NITROGEN_DIOXIDE_DU),
                     help="Nitrogen dioxide above the place. Default 1 above a city (type urban), "
                     "0.2 elsewhere."),
        click.option("--ground", type=_ground, metavar="NAME[,ALBEDO]",
                     help=f"What lies around the scene: {', '.join(GROUND_NAMES)}. Default "
                     "scene: as open ground at the scene's border, grey of 0.1 without any. none "
                     "draws no ground."),
        click.option("--sky", "sky_module", metavar="MODULE",
                     help="The module that holds the sky; `vrut-lite modules` lists them."),
        click.option("--tolerance", type=_tolerance, metavar="SHARE",
                     help="How far radiance may be off, as 1% or 0.01: sizes, orders and "
                     f"thresholds follow. Default {DEFAULT_TOLERANCE:.0%}."),
        click.option("--set", "assignments", multiple=True, metavar="MODULE.NAME=VALUE",
                     help="One setting of one module, or of the `scene`; may be repeated. What a "
                     "still waits for, as light between surfaces, has a setting `on`."),
    ]  # fmt: skip
    for option in reversed(shared):
        command = option(command)
    others = _taken_from(command)
    taken = {flag for option in (*own, *others) for flag in (*option.opts, *option.secondary_opts)}
    for name, specs in reversed(_settings_by_name().items()):
        if _flag(name) not in (*taken, "--help"):
            command = _setting_option(name, specs)(command)
    settings = _taken_from(command)
    # click lists the last first.
    command.__click_params__ = [*settings, *others, *own]  # type: ignore[attr-defined]
    return command


def _taken_from(command: Command) -> list[click.Parameter]:
    """Take the options off a function to which click has attached them."""
    noted: list[click.Parameter] = getattr(command, "__click_params__", [])
    command.__click_params__ = []  # type: ignore[attr-defined]
    return noted


def with_options(project: Project, options: dict[str, Any]) -> Project:
    """The project with the shared options applied, and those called as its fields.

    Removes their keys from `options`.

    Raises:
        UserError: an option has an impossible value.
    """
    weather = options.pop("weather")
    if weather is not None:
        if options["place"] is not None:
            raise UserError("--weather and --place both name a place: say one of them")
        project = with_weather(project, weather)
    changes = said(options, Project.__struct_fields__)
    sky = options.pop("sky_module")
    if sky is not None:
        changes["slots"] = {**project.slots, "sky": sky}
    haze = _haze(project.haze, options.pop("turbidity"), said(options, Haze.__struct_fields__))
    if haze is not None:
        changes["haze"] = haze
        project = _without_own(project, OWN_HAZE)
    if "ground" in changes:
        project = _without_own(project, *OWN_ALBEDOS)
    settings = _merged_settings(project, options)
    changes |= _scene_settings(project, settings.pop(SCENE, {}))
    changes["settings"] = settings
    changed = _checked(msgspec.structs.replace(project, **changes))
    if changed.weather:
        _tell_weather(changed)
    return changed


def said(options: dict[str, Any], names: Iterable[str]) -> dict[str, Any]:
    """The values of the options of these names that were said; takes their keys out."""
    values = {name: options.pop(name, None) for name in names}
    return {name: value for name, value in values.items() if value is not None}


def _scene_settings(project: Project, texts: dict[str, str]) -> dict[str, Any]:
    """The project's fields for settings of the scene."""
    if texts and not project.scene:
        raise UserError("settings of the scene need a scene: name one")
    scene: Any = SceneSettings()
    for name, text in texts.items():
        scene = change(scene, SCENE, name, text)
    return {name: getattr(scene, name) for name in texts}


def at_weather(project: Project, path: str) -> Project:
    """The project under a file's weather; prints the file's faults to standard error."""
    changed = with_weather(project, path)
    _tell_weather(changed)
    return changed


def _tell_weather(project: Project) -> None:
    """Prints what a project's file lacks, and where it contradicts sun, place or itself."""
    weather, place = read_weather(project.weather), project.where()
    for line in (*weather.lacks, *far_from(weather, place.latitude_deg, place.longitude_deg)):
        click.echo(f"vrut-lite: {project.weather}: {line}", err=True)


def _haze(haze: Haze | None, turbidity: float | None, changes: dict[str, Any]) -> Haze | None:
    """The haze of the options, each of which changes its part of the project's."""
    if turbidity is not None:
        if "optical_depth_550" in changes:
            raise UserError("--haze and --turbidity name the same thing: say one of them")
        changes["optical_depth_550"] = float(optical_depth_of_turbidity(turbidity))
    if not changes:
        return None
    known = haze or Haze(DEFAULT_HAZE.optical_depth_550)
    if "aerosol" in changes:
        changed = msgspec.structs.replace(known, **changes, own=None)
        if changed.aerosol != ONE_LOBE and "optical_depth_550" not in changes:
            published = type_optics(changed.aerosol, changed.humidity_percent).optical_depth_550
            changes["optical_depth_550"] = published + changed.stratosphere_depth_550
        changes["own"] = None
    return msgspec.structs.replace(known, **changes)


def _without_own(project: Project, *names: str) -> Project:
    """The project with skies that follow the place, as the command line asks."""
    settings = {
        module: {name: value for name, value in values.items() if name not in names}
        for module, values in project.settings.items()
    }
    return msgspec.structs.replace(project, settings=settings)


def _merged_settings(project: Project, options: dict[str, Any]) -> dict[str, dict[str, Any]]:
    merged = {module: dict(values) for module, values in project.settings.items()}
    for name, specs in _settings_by_name().items():
        value = options.pop(_PREFIX + name, None)
        if value is not None:
            for module in _takers(specs, value):
                merged.setdefault(module, {})[name] = value
    for assignment in options.pop("assignments"):
        target, equals, value = assignment.partition("=")
        module, dot, name = target.partition(".")
        if not (equals and dot):
            raise UserError(f"--set {assignment} is not of the form MODULE.NAME=VALUE")
        merged.setdefault(module, {})[name] = value
    return merged


def _checked(project: Project) -> Project:
    """The project again, its bounds checked: `replace` does not look at them."""
    try:
        return msgspec.convert(msgspec.to_builtins(project), Project)
    except msgspec.ValidationError as error:
        raise UserError(in_words(error)) from None


def _takers(specs: dict[str, SettingSpec], value: str) -> list[str]:
    """The modules that an option is for; the value `none` only goes to those that accept it."""
    if value != "none":
        return list(specs)
    return [module for module, spec in specs.items() if spec.may_be_none] or list(specs)


def _settings_by_name() -> dict[str, dict[str, SettingSpec]]:
    """Every setting name of the installed modules but the auxiliary ones, described by module."""
    found: dict[str, dict[str, SettingSpec]] = {}
    for module in discover()[0]:
        if not module.manifest.auxiliary:
            for name, spec in describe(module.settings_type).items():
                found.setdefault(name, {})[module.manifest.name] = spec
    return found


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")


def _setting_option(name: str, specs: dict[str, SettingSpec]) -> Command:
    first = next(iter(specs.values()))
    each: dict[str, list[str]] = {}
    for module, spec in specs.items():
        unit = f" {spec.unit}" if spec.unit else ""
        each.setdefault(f"{spec.range_text()}; default {spec.default_text()}{unit}", []).append(
            module
        )
    ranges = "; ".join(f"{', '.join(modules)}: {text}" for text, modules in each.items())
    # As text: a bad value is refused with the same sentence here and in a project file.
    return click.option(
        _flag(name),
        _PREFIX + name,
        metavar="|".join(first.choices) or "VALUE",
        help=f"{first.help.rstrip('.')} ({ranges}).",
    )
