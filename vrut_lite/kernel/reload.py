"""Importing a module's package afresh, or leaving all as it was."""

import importlib
import sys
from collections.abc import Callable
from types import ModuleType

from vrut_lite.errors import UserError
from vrut_lite.kernel.contract import check_module_type
from vrut_lite.kernel.module import Module

_HOST_PACKAGE = "vrut_lite"


def root_package(python_type: type) -> str:
    """Name of the top-level package in which a class was defined."""
    return python_type.__module__.partition(".")[0]


def import_afresh(module_type: type[Module]) -> tuple[type[Module], Callable[[], None]]:
    """The class as its files have it now, and a function that brings the old package back.

    Raises:
        UserError: the module is part of the host, or its class is gone or got another name.
        Exception: an exception of the new version's import; the old package is then restored.
    """
    root = root_package(module_type)
    if root in (_HOST_PACKAGE, "__main__"):
        raise UserError(
            f"module {module_type.manifest.name} is part of the host: start it again to reload"
        )
    old = _take_out(root)

    def undo() -> None:
        _take_out(root)
        sys.modules.update(old)

    try:
        importlib.invalidate_caches()
        return _find_again(module_type), undo
    except BaseException:
        undo()
        raise


def _take_out(root: str) -> dict[str, ModuleType]:
    names = [name for name in sys.modules if name == root or name.startswith(root + ".")]
    return {name: sys.modules.pop(name) for name in names}


def _find_again(module_type: type[Module]) -> type[Module]:
    python_module = importlib.import_module(module_type.__module__)
    found = getattr(python_module, module_type.__name__, None)
    name = module_type.manifest.name
    if not (isinstance(found, type) and issubclass(found, Module)):
        raise UserError(f"{python_module.__name__} has no module class {module_type.__name__} now")
    check_module_type(found)
    if found.manifest.name != name:
        raise UserError(f"module '{name}' calls itself '{found.manifest.name}' now: start again")
    return found
