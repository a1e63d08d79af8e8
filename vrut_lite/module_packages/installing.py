"""Installs, updates and removes packages of modules in the running environment, by pip.

A process that runs keeps the modules that it has loaded: changes count from its next start.
"""

import importlib
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, distribution, entry_points
from pathlib import Path

from vrut_lite.errors import UserError, one_line
from vrut_lite.lazy import lazy
from vrut_lite.module_packages.wheels import ModuleWheel, check_installable, make_wheel, run_pip
from vrut_lite.package_facts import MODULES_GROUP, PackageFacts, facts_of, is_own

Version = lazy("packaging.version:Version")
canonicalize_name = lazy("packaging.utils:canonicalize_name")

RIGHTS = "What is installed runs with your rights: it can read and change all that you can."
# A module that takes longer to load keeps the window from starting.
_LONGEST_TRIAL_S = 120.0


def installed_package(name: str) -> PackageFacts | None:
    """Returns the package that has a name or brings a module of that name, else None."""
    for point in entry_points(group=MODULES_GROUP):
        if point.dist is not None:
            facts = facts_of(point.dist)
            if name == point.name or canonicalize_name(name) == canonicalize_name(facts.name):
                return facts
    return None


def package_of_others(name: str) -> PackageFacts:
    """An installed package that is not vrut_lite's own.

    Raises:
        UserError: no package has that name.
    """
    facts = installed_package(name)
    if facts is None:
        raise UserError(f"no package of modules called {name} is installed: see vrut-lite modules")
    if is_own(facts.name):
        raise UserError(
            f"{name} is a part of {facts.name}, which is updated and removed as a whole; switch it "
            "off in the window's Modules panel"
        )
    return facts


def prepare_install(what: str, folder: Path) -> ModuleWheel:
    """The wheel of a package that may be installed, made in a folder; nothing is installed yet.

    Raises:
        UserError: it may not be installed, or is installed already.
    """
    wheel = make_wheel(what, folder)
    present = installed_package(wheel.facts.name)
    if present is not None and not is_own(present.name):
        raise UserError(
            f"{present.name} {present.version} is installed already: update it, by the window's "
            f"Modules panel or by vrut-lite modules update {present.name}"
        )
    check_installable(wheel)
    return wheel


def prepare_update(name: str, what: str | None, folder: Path) -> ModuleWheel:
    """The wheel of another version of an installed package, from the index or from `what`.

    Raises:
        UserError: no package of others has the name, or there is no other version.
    """
    present = package_of_others(name)
    wheel = make_wheel(present.name if what is None else what, folder)
    if canonicalize_name(wheel.facts.name) != canonicalize_name(present.name):
        raise UserError(f"{what} is {wheel.facts.name}, not {present.name}")
    if Version(wheel.facts.version) == Version(present.version):
        raise UserError(f"{present.name} {present.version} is installed, and there is no other")
    check_installable(wheel)
    return wheel


def install(wheel: ModuleWheel) -> None:
    """Install a prepared wheel, in place of another version, with what it requires.

    Raises:
        UserError: pip fails (with its reason), or a fresh process cannot load the package.
    """
    path = Path(wheel.path)
    run_pip(["install", "--upgrade", str(path)], path.parent)
    try_loading(wheel.facts.name, path.parent)


def remove(facts: PackageFacts, folder: Path) -> None:
    """Remove a package of others; `folder` holds no python files.

    Raises:
        UserError: pip says why not, or leaves it where it is.
    """
    run_pip(["uninstall", "--yes", facts.name], folder)
    importlib.invalidate_caches()
    try:
        place = distribution(facts.name).locate_file("")
    except PackageNotFoundError:
        return
    raise UserError(
        f"pip leaves {facts.name} in {place}, outside the environment {sys.prefix}: remove it there"
    )


def try_loading(package: str, folder: Path) -> None:
    """Load a package's modules and frame parts in a fresh process.

    Raises:
        UserError: one cannot be loaded; the sentence says how to remove it.
    """
    remedy = f"`vrut-lite modules remove {package}` removes it"
    try:
        done = subprocess.run(
            [sys.executable, "-m", "vrut_lite.module_packages.trial", package],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="locale",
            errors="replace",
            timeout=_LONGEST_TRIAL_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise UserError(
            f"{package} is installed, and did not load within {_LONGEST_TRIAL_S:.0f} s: {remedy}"
        ) from None
    if done.returncode != 0 or not done.stdout.endswith("loaded\n"):
        lines = (done.stdout + done.stderr).strip().splitlines()
        reason = lines[-1] if lines else f"it ended the process with code {done.returncode}"
        raise UserError(
            f"{package} is installed and cannot be loaded: {one_line(reason, 500)}; {remedy}"
        )
