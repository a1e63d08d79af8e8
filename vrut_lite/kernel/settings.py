"""Settings: one struct per module, from which validation, CLI options and panels are made.

A settings class is a frozen `msgspec.Struct` whose fields all have defaults and are annotated by
`setting`. A field may also be None, for unset: its description states the effect.
"""

import math
from types import NoneType
from typing import Any, Literal, get_args, get_origin, get_type_hints

import msgspec

from vrut_lite.checks import shown
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt

# Longest part (characters) of a refused text that an error quotes.
_LONGEST_TOLD = 200


def setting(
    description: str,
    low: float | None = None,
    high: float | None = None,
    *,
    unit: str = "",
    source: str = "",
    label: str = "",
    choice_labels: dict[str, str] | None = None,
    file_kinds: str = "",
) -> msgspec.Meta:
    """Annotates a field: its meaning, its least and greatest value, and the formula's source.

    Windows show `label` for the name, `choice_labels` for choices and "none"; a text with
    `file_kinds`, such as "Pictures (*.png *.jpg)", names a file.
    """
    words = {"unit": unit, "source": source, "label": label, "file_kinds": file_kinds}
    extra = {**words, "choice_labels": choice_labels or {}}
    return msgspec.Meta(ge=low, le=high, description=description, extra=extra)


class SettingSpec(msgspec.Struct, frozen=True, kw_only=True):
    """Description of one setting, from which options and panel rows are made."""

    name: str
    type: type
    default: Any
    help: str = ""
    unit: str = ""
    source: str = ""
    label: str = ""
    choice_labels: dict[str, str] = {}
    file_kinds: str = ""
    at_least: float | None = None
    at_most: float | None = None
    choices: tuple[str, ...] = ()
    may_be_none: bool = False

    def range_text(self) -> str:
        """The accepted values, for people."""
        return self._values_text() + (", or none" if self.may_be_none else "")

    def default_text(self) -> str:
        """The default, as one would type it."""
        return "none" if self.default is None else str(self.default)

    def _values_text(self) -> str:
        if self.choices:
            return "one of " + ", ".join(self.choices)
        unit = f" {self.unit}" if self.unit else ""
        if self.at_least is not None and self.at_most is not None:
            return f"between {self.at_least:g} and {self.at_most:g}{unit}"
        if self.at_least is not None:
            return f"at least {self.at_least:g}{unit}"
        if self.at_most is not None:
            return f"at most {self.at_most:g}{unit}"
        plain = {bool: "true or false", int: "a whole number", float: "a number"}
        return plain.get(self.type, "a text")


def describe(settings_type: type[msgspec.Struct]) -> dict[str, SettingSpec]:
    """The settings of a class by name, in order of declaration."""
    hints = get_type_hints(settings_type, include_extras=True)
    defaults = msgspec.structs.asdict(settings_type())
    return {name: _spec(name, hints[name], default) for name, default in defaults.items()}


def _spec(name: str, hint: Any, default: Any) -> SettingSpec:
    hint, outer = _without_meta(hint)
    may_be_none = NoneType in get_args(hint)
    if may_be_none:
        hint = next(part for part in get_args(hint) if part is not NoneType)
    # Annotated may stand around the union or inside it.
    hint, inner = _without_meta(hint)
    meta = outer or inner or msgspec.Meta()
    is_choice = get_origin(hint) is Literal
    return SettingSpec(
        name=name,
        type=str if is_choice else hint,
        default=default,
        help=meta.description or "",
        **{k: v for k, v in (meta.extra or {}).items() if k in SettingSpec.__struct_fields__},
        at_least=None if meta.ge is None else float(meta.ge),
        at_most=None if meta.le is None else float(meta.le),
        choices=get_args(hint) if is_choice else (),
        may_be_none=may_be_none,
    )


def _without_meta(hint: Any) -> tuple[Any, msgspec.Meta | None]:
    """A type without its annotations, and the meta among them."""
    if not hasattr(hint, "__metadata__"):
        return hint, None
    meta = next((m for m in hint.__metadata__ if isinstance(m, msgspec.Meta)), None)
    return hint.__origin__, meta


def check_spec(spec: SettingSpec, module: str) -> None:
    """Check that a setting can be described, set and shown, and that its default is valid.

    Raises:
        UserError: the setting is unusable, or the default does not satisfy the type.
    """
    if spec.type not in (bool, int, float, str):
        raise UserError(
            f"its setting {spec.name} must be of bool, int, float, str or a Literal of texts"
        )
    texts = (spec.help, spec.unit, spec.source, spec.label, spec.file_kinds, *spec.choices)
    if not all(isinstance(text, str) for text in texts):
        raise UserError(f"its setting {spec.name} has a unit, source or choice that is no text")
    kept = parse(spec, module, spec.default)
    if type(kept) is not type(spec.default) or kept != spec.default:
        raise UserError(
            f"its setting {spec.name} must be {spec.range_text()}, not its default {spec.default!r}"
        )


def change(settings: msgspec.Struct, module: str, name: str, value: Any) -> msgspec.Struct:
    """The settings with one value changed.

    Raises:
        UserError: no such setting, or the value is outside its range.
    """
    specs = describe(type(settings))
    if name not in specs:
        raise UserError(
            f"module {module} has no setting '{name}': it has {', '.join(specs) or 'none'}"
        )
    parsed = parse(specs[name], module, value)
    try:
        return msgspec.structs.replace(settings, **{name: parsed})
    # A module's own settings may have a rule for several of them.
    except BaseException as error:
        pass_interrupt(error)
        raise UserError(f"{name} of {module} cannot be {parsed}: {sentence_of(error)}") from None


def carry_over(
    old: msgspec.Struct, settings_type: type[msgspec.Struct], module: str
) -> tuple[msgspec.Struct, list[str]]:
    """Settings of a new type with the values of old ones, and a sentence for each that is lost."""
    settings, losses = settings_type(), []
    for name, value in msgspec.structs.asdict(old).items():
        try:
            settings = change(settings, module, name, value)
        except UserError as error:
            losses.append(str(error))
    return settings, losses


def parse(spec: SettingSpec, module: str, value: Any) -> Any:
    """A value of the setting's type from a value or its text form; see `change` for errors."""
    if spec.may_be_none and (value is None or (isinstance(value, str) and value == "none")):
        return None
    try:
        parsed: Any = msgspec.convert(value, spec.type, strict=False)
    except (msgspec.ValidationError, OverflowError):
        raise _refusal(spec, module, value) from None
    # A NaN passes every comparison that asks "is it too large".
    inside = not isinstance(parsed, float) or math.isfinite(parsed)
    if spec.at_least is not None:
        inside = inside and parsed >= spec.at_least
    if spec.at_most is not None:
        inside = inside and parsed <= spec.at_most
    if not inside or (spec.choices and parsed not in spec.choices):
        raise _refusal(spec, module, value)
    return parsed


def _refusal(spec: SettingSpec, module: str, value: Any) -> UserError:
    told = value[:_LONGEST_TOLD] if isinstance(value, str) else shown(value)
    return UserError(f"{spec.name} of {module} must be {spec.range_text()}, not {told}")
