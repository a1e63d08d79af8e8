"""Checks that a class can serve as a module, before it gets a seat.

A class that cannot is refused in one sentence, and the others load. The checks call everything that
the class could answer wrongly later, where the kernel could not catch it.
"""

import inspect
import re
from collections.abc import AsyncGenerator, Awaitable, Callable, Coroutine, Generator
from typing import Any

import msgspec

from vrut_lite import checks
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import safe_text, sentence_of
from vrut_lite.host_version import check_host
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel import settings as setting_rules
from vrut_lite.kernel.messages import Input, Message
from vrut_lite.kernel.module import Manifest, Module

# Names stand in keys, lists, options and project files: no dots, commas or line ends.
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_ -]{0,63}")
_LONGEST_TITLE = 200
_ASKS_IF_RUN_LATER = (
    inspect.iscoroutinefunction,
    inspect.isgeneratorfunction,
    inspect.isasyncgenfunction,
)
_CALLED_BY_THE_KERNEL = ("settings_changed", "snapshot", "restore")


def check_module_type(candidate: object) -> None:
    """Pass if the kernel can make an instance of a class and call it.

    Raises:
        UserError: it is no module class; its manifest, settings or handlers are invalid; or reading
            them raises.
    """
    try:
        if not (isinstance(candidate, type) and issubclass(candidate, Module)):
            raise UserError(
                f"{checks.shown(candidate)} is no subclass of vrut_lite.kernel.module.Module"
            )
        _check_manifest(getattr(candidate, "manifest", None))
        _check_handlers(candidate)
        _check_settings(candidate)
    except UserError:
        raise
    except BaseException as error:
        pass_interrupt(error)
        name = safe_text(lambda: candidate.__name__, "it")  # type: ignore[attr-defined]
        raise UserError(f"{name} cannot be used: {sentence_of(error)}") from None


def refuse_unrun(answer: object) -> None:
    """Raise if a call has returned a coroutine or generator, which nobody would run.

    Raises:
        TypeError: it has.
    """
    if isinstance(answer, Awaitable | Generator | AsyncGenerator):
        if isinstance(answer, Coroutine):
            answer.close()
        raise TypeError("it is async or a generator: nothing of it was run")


def _check_manifest(manifest: object) -> None:
    if not isinstance(manifest, Manifest):
        raise UserError(f"its manifest must be a Manifest, not {checks.shown(manifest)}")
    of = "a manifest"
    for field in ("name", "title", "version"):
        text = getattr(manifest, field)
        printable = isinstance(text, str) and text.isprintable() and text.strip()
        if not (printable and len(text) <= _LONGEST_TITLE):
            checks.refuse(manifest, field, "be a line of text", of)
    if not _NAME.fullmatch(manifest.name):
        checks.refuse(manifest, "name", "be letters, digits and _", of)
    for field in ("provides", "requires"):
        slots = getattr(manifest, field)
        if not (isinstance(slots, tuple) and all(map(_is_name, slots))):
            checks.refuse(manifest, field, "be a tuple of names of slots", of)
    if manifest.engine != "" and not _is_name(manifest.engine):
        checks.refuse(manifest, "engine", "be a name of letters, digits, - and _", of)
    checks.flag(manifest, "stand_in", "auxiliary", of=of)
    if not isinstance(manifest.host, str):
        checks.refuse(manifest, "host", "be a text such as '>=1.0,<2'", of)
    check_host(manifest.host)


def _check_handlers(module_type: type[Module]) -> None:
    called = list(_CALLED_BY_THE_KERNEL)
    for kind, method in module_type.handlers():
        if not (isinstance(kind, type) and issubclass(kind, Message)):
            raise UserError(f"{method} handles {checks.shown(kind)}, which is no type of message")
        called.append(method)
    for method in called:
        function = getattr(module_type, method)
        if not callable(function) or _runs_later(function):
            raise UserError(
                f"{method} must be a method that does its work when it is called, neither async "
                "nor a generator"
            )
    if module_type.manifest.engine and not callable(getattr(module_type, "open_engine", None)):
        raise UserError("its manifest names an engine, so it needs a method open_engine")
    _check_types(module_type, "injects", Input)
    _check_types(module_type, "speaks", Message)


def _check_types(module_type: type[Module], field: str, base: type[Message]) -> None:
    kinds = getattr(module_type, field)
    fits = isinstance(kinds, tuple) and all(isinstance(kind, type) for kind in kinds)
    if not (fits and all(issubclass(kind, base) for kind in kinds)):
        what = "inputs" if base is Input else "messages"
        raise UserError(f"{field} must be a tuple of types of {what}, not {checks.shown(kinds)}")


def _check_settings(module_type: type[Module]) -> None:
    kind = module_type.settings_type
    if not (isinstance(kind, type) and issubclass(kind, msgspec.Struct)):
        raise UserError(f"settings_type must be a msgspec.Struct, not {checks.shown(kind)}")
    for field in msgspec.structs.fields(kind):
        if field.required:
            raise UserError(f"its setting {field.name} needs a default")
    for spec in setting_rules.describe(kind).values():
        setting_rules.check_spec(spec, module_type.manifest.name)


def _is_name(text: object) -> bool:
    return isinstance(text, str) and _NAME.fullmatch(text) is not None


def _runs_later(function: Callable[..., Any]) -> bool:
    return any(asks(function) for asks in _ASKS_IF_RUN_LATER)
