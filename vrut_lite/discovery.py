"""Finds modules: installed ones by entry point, others in folders."""

import importlib
import importlib.util
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import interrupts_held, pass_interrupt
from vrut_lite.kernel.contract import check_module_type
from vrut_lite.kernel.module import Module
from vrut_lite.package_facts import (
    MODULES_GROUP,
    SAFE_MODE_OPTION,
    in_safe_mode,
    load_fitting,
    package_of,
    usable_points,
)

FOLDERS_VARIABLE = "VRUT_LITE_MODULES"
# Reserved names: the host itself, its scene manager, its queue of GPU jobs, its sum of skies.
NAMES_OF_THE_HOST = ("host", "scene", "gl_jobs", "sky_sum")


class Candidate(NamedTuple):
    """A module that may be loaded; `remedy` ends the sentence if it cannot be."""

    title: str
    load: Callable[[], object]
    remedy: str = ""


def module_folders() -> list[str]:
    """Folders of modules that are not installed, from the environment; none in safe mode."""
    if in_safe_mode():
        return []
    return [folder for folder in os.environ.get(FOLDERS_VARIABLE, "").split(os.pathsep) if folder]


def discover(folders: Iterable[str | Path] | None = None) -> tuple[list[type[Module]], list[str]]:
    """Module classes in load order, and a sentence for each that failed to load.

    Entry points come first, then the packages and files of each folder, each sorted by name.
    `folders` defaults to those of the environment. In a folder, a package or file names its class
    as `MODULE`, or defines exactly one.
    """
    found: dict[str, type[Module]] = {}
    failures: list[str] = []
    for title, load, remedy in (
        *_by_entry_point(),
        *_by_folders(module_folders() if folders is None else folders),
    ):
        try:
            with interrupts_held():
                module_type = checked(load())
            name = module_type.manifest.name
            if name in found:
                raise UserError(f"another module is called '{name}' too: rename one")
            found[name] = module_type
        except BaseException as error:
            pass_interrupt(error)
            failures.append(f"module {title} failed to load: {sentence_of(error)}{remedy}")
    return list(found.values()), failures


def _by_entry_point() -> Iterator[Candidate]:
    for point in usable_points(MODULES_GROUP):
        title, remedy = f"'{point.name}' ({point.value})", ""
        if (package := package_of(point)) is not None:
            title = f"{title} of {package.title},"
            remedy = (
                f"; `vrut-lite run {SAFE_MODE_OPTION}` starts without modules of others, "
                f"`vrut-lite modules remove {point.name}` removes this one"
            )
        yield Candidate(title, partial(load_fitting, point), remedy)


def _by_folders(folders: Iterable[str | Path]) -> Iterator[Candidate]:
    for folder in map(Path, folders):
        for path in _files_of(folder):
            if path.suffix == ".py" or (path / "__init__.py").is_file():
                yield Candidate(str(path), partial(_load_file, path.resolve()))


def _files_of(folder: Path) -> list[Path]:
    try:
        return sorted(folder.iterdir(), key=lambda path: path.stem)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UserError(
            f"there is no folder of modules {folder} ({reason}): mend {FOLDERS_VARIABLE}"
        ) from None


def _load_file(path: Path) -> object:
    """The module class of a package or file, imported by its own name."""
    folder, name = str(path.parent), path.stem
    if folder not in sys.path:
        sys.path.append(folder)  # At the end: installed packages take precedence.
    importlib.invalidate_caches()
    spec = importlib.util.find_spec(name)
    if spec is None or spec.origin not in (str(path), str(path / "__init__.py")):
        raise UserError(f"a package called '{name}' is installed already: rename this one")
    return class_in(importlib.import_module(name))


def class_in(python_module: ModuleType) -> object:
    """The object named `MODULE` in a python module, or the only module class that it defines.

    Raises:
        UserError: there is no `MODULE`, and not exactly one class.
    """
    if hasattr(python_module, "MODULE"):
        return python_module.MODULE
    own = [
        member
        for member in vars(python_module).values()
        if isinstance(member, type)
        and issubclass(member, Module)
        and f"{member.__module__}.".startswith(f"{python_module.__name__}.")
    ]
    if len(own) != 1:
        raise UserError(f"it defines {len(own)} module classes: name the one to load as MODULE")
    return own[0]


def checked(candidate: object) -> type[Module]:
    """The candidate, if it is a module class that may be loaded."""
    check_module_type(candidate)
    assert isinstance(candidate, type)
    assert issubclass(candidate, Module)
    if candidate.manifest.name in NAMES_OF_THE_HOST:
        raise UserError(f"'{candidate.manifest.name}' is the host's own name: choose another")
    return candidate
