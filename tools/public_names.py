"""The names that users and authors may build on, one a line: docs/promises.md says what holds.

    python -m tools.public_names

writes them to tests/promises/, where a test compares them with the code. The reference page shows
the same Python names (tools/docs_site.py).
"""

import importlib
import inspect
import re
from collections.abc import Iterator
from importlib.metadata import entry_points
from pathlib import Path
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import click
import msgspec

from vrut_lite import cli
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.deprecation import SINCE
from vrut_lite.kernel.messages import KERNEL_MESSAGES, Derived, Input, Message
from vrut_lite.kernel.settings import describe
from vrut_lite.messages.vocabulary import DAYLIGHT_MESSAGES
from vrut_lite.project import Project

ROOT = Path(__file__).parents[1]
NAMES = ROOT / "tests" / "promises" / "public_names.txt"
FIELDS = ROOT / "tests" / "promises" / "message_fields.txt"
# Public Python names by title and python module; None: all that the module lists in `__all__`.
PYTHON: dict[str, dict[str, tuple[str, ...] | None]] = {
    "Skies": {"bruneton_sky": None, "dynamic_skylight": None},
    "Daylight in numbers": {
        "daylight_numbers": (
            "annual", "colour_temperature", "daylight_factor", "eye_responses", "numbers_now",
            "work_of",
        ),
    },
    "Scenes": {
        "vrut_lite.host": ("Host",),
        "vrut_lite.notebook": ("LitScene",),
        "vrut_lite.daylight_kernel": None,
    },
    "Modules": {
        "vrut_lite.kernel.module": ("Manifest", "Module", "Link", "handles"),
        "vrut_lite.kernel.messages": (
            "Message", "Input", "Derived", *(kind.__name__ for kind in KERNEL_MESSAGES),
        ),
        "vrut_lite.kernel.settings": ("setting",),
        "vrut_lite.kernel.bus": ("Kernel",),
        "vrut_lite.errors": ("UserError", "ModuleFailed", "GivenUp"),
        "vrut_lite.array": ("Array",),
    },
    "Skies of one's own": {
        "vrut_lite.sky.sky_module": ("SkyModule", "PRODUCTS"),
        "vrut_lite.sky.sky_of_hour": (
            "Background", "MotionThreshold", "Prepared", "Quality", "Sky", "SkyInputs",
            "SkySpectra", "Spectrum", "SunDisc", "Work",
        ),
        "vrut_lite.sky.clear_sun": ("sun_irradiance_rgb",),
        "vrut_lite.sky.sky_sum": ("SkySum",),
        "vrut_lite.sky.sky_layer": ("SkyLayer", "Viewpoint"),
        "vrut_lite.sky.effective_defaults": ("Preset",),
        "vrut_lite.sky.air_volume": ("AirGrid", "node_rays", "slice_shares"),
    },
    "What modules draw and show": {
        "vrut_lite.frame_part": (
            "Casters", "DepthCopy", "FramePart", "GROUND", "Heard", "Hit", "MeshChart", "PartFrame",
            "PartGl", "PartShadow", "PartTarget", "PartView", "PlacedSurface", "Screen", "Tiles",
        ),
        "vrut_lite.uniform_block": ("UniformBlock",),
        "vrut_lite.panel_kit": None,
        "vrut_lite.headless": None,
        "vrut_lite.scene_engine": None,
    },
    "Values": {
        "vrut_lite.checks": (
            "array", "arrays", "choice", "direction", "flag", "instance", "instant", "is_finite",
            "light", "number", "numbers", "text", "whole",
        ),
        "vrut_lite.numeric_types": ("BoolArray", "Float32Array", "FloatArray", "Vector", "vector"),
        "vrut_lite.geometry.colour": (
            "LUMENS_PER_WATT", "SKYLIGHT_NM", "SRGB_FROM_XYZ", "luminance", "rgb_from_spectrum",
            "solar_irradiance",
        ),
        "vrut_lite.geometry.cube_map": ("texel_directions", "texel_solid_angles"),
        "vrut_lite.geometry.spherical_harmonics": (
            "evaluate_irradiance", "horizontal_irradiance", "irradiance_coefficients",
        ),
        "vrut_lite.atmosphere.aerosol": ("optical_depth_of_turbidity",),
        "vrut_lite.atmosphere.aerosols": ("PhaseTable", "optics_of_aerosol", "type_optics"),
        "vrut_lite.messages.haze": ("haze_of",),
    },
    "Journals": {
        "vrut_lite.recording.recorder": ("Recorder",),
        "vrut_lite.recording.replay": ("Outcome", "Replay"),
        "vrut_lite.recording.replay_runner": ("ReplayRunner",),
        "vrut_lite.testing": ("replay_journal",),
        "vrut_lite.testing.sky_contract": ("SkyContract", "cube_of"),
        "vrut_lite.testing.sky_on_bus": ("SkyOnBus", "SunAndEye"),
    },
}  # fmt: skip
GROUPS = ("commands", "frame_parts", "modules", "panels", "sky_layers")
_OURS = ("vrut_lite", "bruneton_sky", "dynamic_skylight")


def public_names() -> list[str]:
    """All public names but the fields of messages, sorted."""
    return sorted({*_python(), *_commands(), *_settings(), *_project(), *_groups()})


def python_modules() -> dict[str, set[str]]:
    """The public Python names by module, messages of the host included."""
    found: dict[str, set[str]] = {}
    for modules in PYTHON.values():
        for module, names in modules.items():
            found.setdefault(module, set()).update(names or _listed(module))
    for kind in (*DAYLIGHT_MESSAGES, *_structures(DAYLIGHT_MESSAGES)):
        found.setdefault(kind.__module__, set()).add(kind.__name__)
    return found


def _listed(module: str) -> list[str]:
    return list(importlib.import_module(module).__all__)


def _python() -> Iterator[str]:
    for module, names in python_modules().items():
        for name in names:
            value = getattr(importlib.import_module(module), name)
            yield from _with_members(f"{module}.{name}", value)
    for source in [*ROOT.glob("vrut_lite/**/__init__.py"), *ROOT.glob("modules/*/__init__.py")]:
        if "MovedNames" in source.read_text(encoding="utf-8"):
            old: Any = importlib.import_module(source.parent.name).__getattr__
            for name in old.homes:
                yield f"python {old.module}.{name} (deprecated since {old.since})"


def _with_members(path: str, value: Any) -> Iterator[str]:
    yield f"python {path}{_deprecation(value)}"
    if not inspect.isclass(value):
        yield from _parameters(path, value)
        return
    # Messages have their fields in a list of their own, and what all of them have with `Message`.
    is_message = issubclass(value, Message) and value not in (Message, Input, Derived)
    fields = getattr(value, "__struct_fields__", ())
    known = {*dir(Input), *dir(Derived), *fields} if is_message else set()
    if not is_message:
        yield from _parameters(path, value)
    for name in dir(value):
        owner = next((kind for kind in value.__mro__ if name in vars(kind)), None)
        is_ours = owner is not None and owner.__module__.partition(".")[0] in _OURS
        if is_ours and name not in known and not name.startswith(("_", "test_")):
            member = inspect.getattr_static(value, name)
            member = getattr(member, "__func__", member)
            # The kernel alone calls handlers.
            if not hasattr(member, "handled_types"):
                yield f"python {path}.{name}{_deprecation(member)}"
                yield from _parameters(f"{path}.{name}", member)


def _deprecation(value: Any) -> str:
    since = getattr(value, SINCE, None)
    return f" (deprecated since {since})" if isinstance(since, str) else ""


def _parameters(path: str, value: Any) -> Iterator[str]:
    """A line for each parameter of a function or class; `name=` has a default."""
    if not callable(value) or getattr(value, "_is_protocol", False):
        return
    try:
        parameters = inspect.signature(value).parameters.values()
    except (TypeError, ValueError):
        return
    for one in parameters:
        if one.name not in ("self", "cls") and one.kind not in (
            inspect.Parameter.VAR_POSITIONAL,
            inspect.Parameter.VAR_KEYWORD,
        ):
            default = "" if one.default is inspect.Parameter.empty else "="
            yield f"python {path}({one.name}{default})"


def _commands() -> Iterator[str]:
    yield from _command("vrut-lite", cli.root)


def _command(path: str, command: click.Command) -> Iterator[str]:
    yield f"command {path}"
    for parameter in command.params:
        if isinstance(parameter, click.Option):
            for option in (*parameter.opts, *parameter.secondary_opts):
                yield f"option {path} {option}"
        else:
            yield f"argument {path} {parameter.human_readable_name}"
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            inner = command.get_command(context, name)
            # The laboratory promises nothing.
            if inner is not None and name not in cli.LABORATORY:
                yield from _command(f"{path} {name}", inner)


def _settings() -> Iterator[str]:
    kernel, _ = daylight_kernel()
    for loaded in kernel.seats.values():
        name = loaded.manifest.name
        yield f"module {name}"
        for slot in loaded.manifest.provides:
            yield f"slot {slot} of {name}"
        for spec in describe(loaded.module_type.settings_type).values():
            yield f"setting {name}.{spec.name}: {spec.type.__name__}"
            yield from (f"setting {name}.{spec.name} = {choice}" for choice in spec.choices)
    kernel.close()


def _project() -> Iterator[str]:
    for kind in (Project, *_structures((Project,))):
        for line in field_lines(kind):
            yield f"project {line.partition(' = ')[0]}"


def _groups() -> Iterator[str]:
    yield from (f"entry points vrut_lite.{group}" for group in GROUPS)
    for source in sorted([*ROOT.glob("vrut_lite/**/*.py"), *ROOT.glob("modules/**/*.py")]):
        for variable in re.findall(r"\"(VRUT_LITE_[A-Z_]+)\"", source.read_text(encoding="utf-8")):
            yield f"environment {variable}"


def message_fields() -> list[str]:
    """Fields of all messages of the host and of installed modules, and of structures in them."""
    kinds: set[type] = {*KERNEL_MESSAGES, *DAYLIGHT_MESSAGES}
    for point in entry_points(group="vrut_lite.modules"):
        if point.dist is not None and point.dist.name == "vrut-lite":
            kinds.update(point.load().speaks)
    return sorted(line for kind in {*kinds, *_structures(kinds)} for line in field_lines(kind))


def field_lines(kind: Any) -> Iterator[str]:
    """`Type.field: type = default`, and a line for each choice of a field that has some."""
    hints = get_type_hints(kind)
    for field in msgspec.structs.fields(kind):
        name, hint = f"{kind.__name__}.{field.name}", hints[field.name]
        default = "" if field.required else f" = {_default(field)}"
        yield f"{name}: {_text(hint)}{default}"
        yield from (f"{name} may be {choice!r}" for choice in sorted(_choices(hint), key=repr))


def _default(field: Any) -> str:
    made = field.default_factory
    value = field.default if made is msgspec.NODEFAULT else made()
    return re.sub(r" at 0x\w+", "", repr(value))


def _text(hint: Any) -> str:
    """A type, its choices left out."""
    text = inspect.formatannotation(hint)
    text = re.sub(r"Literal\[[^\]]*\]", "choice", text)
    return re.sub(r"(?:\w+\.)+(\w+)", r"\1", text)


def _choices(hint: Any) -> set[Any]:
    if get_origin(hint) is Literal:
        return set(get_args(hint))
    return {choice for part in get_args(hint) for choice in _choices(part)}


def _structures(kinds: Any) -> set[Any]:
    """Structures in the fields of types, and in theirs."""
    found: set[Any] = set()
    waiting = list(kinds)
    while waiting:
        hints = get_type_hints(waiting.pop())
        for hint in hints.values():
            for part in _parts(hint):
                is_structure = isinstance(part, type) and issubclass(part, msgspec.Struct)
                if is_structure and part not in found and part not in kinds:
                    found.add(part)
                    waiting.append(part)
    return found


def _parts(hint: Any) -> Iterator[Any]:
    yield hint
    if get_origin(hint) in (Union, UnionType) or get_args(hint):
        for part in get_args(hint):
            yield from _parts(part)


def main() -> None:
    """Write both lists."""
    for path, lines in ((NAMES, public_names()), (FIELDS, message_fields())):
        path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
        print(f"{path.relative_to(ROOT)}: {len(lines)} lines")


if __name__ == "__main__":
    main()
