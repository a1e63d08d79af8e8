"""Wheels of packages of modules: made by pip, read without importing or installing them."""

import hashlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Sequence
from importlib.metadata import PathDistribution, entry_points, packages_distributions
from pathlib import Path

import msgspec

from vrut_lite.errors import UserError, one_line
from vrut_lite.host_version import check_host
from vrut_lite.lazy import lazy
from vrut_lite.package_facts import MODULES_GROUP, PackageFacts, facts_of, is_own

Requirement = lazy("packaging.requirements:Requirement")
canonicalize_name = lazy("packaging.utils:canonicalize_name")

_LONGEST_REASON = 500
_NOT_SOURCES = ("build", "dist", "*.egg-info", "__pycache__", ".venv", ".*_cache")
# Folders of a wheel's data whose content is installed beside the packages.
_DATA_FOLDER = re.compile(r"^[^/]+\.data/(purelib|platlib)/")
_NAME = re.compile(r"[A-Za-z0-9]([A-Za-z0-9._-]*[A-Za-z0-9])?\s*([<>=!~].*)?")


class ModuleWheel(msgspec.Struct, frozen=True):
    """A wheel of a package of modules, its facts, and its top-level python packages."""

    path: str
    facts: PackageFacts
    python_packages: tuple[str, ...]


def run_pip(arguments: Sequence[str], folder: Path) -> None:
    """Run pip of this environment in a folder that holds no python files.

    Its temporary files go there too: a pip that is killed leaves them.

    Raises:
        UserError: the environment has no pip, or pip says why not.
    """
    if importlib.util.find_spec("pip") is None:
        raise UserError(
            f"the environment {sys.prefix} has no pip: bring it in by python -m ensurepip, or "
            "install the package by the tool that made the environment"
        )
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--no-input"]
    done = subprocess.run(
        [*command, *arguments],
        cwd=folder,
        env={**os.environ, "TMPDIR": str(folder)},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        encoding="locale",
        errors="replace",
        check=False,
    )
    if done.returncode != 0:
        lines = [line.strip() for line in (done.stdout + done.stderr).splitlines() if line.strip()]
        errors = [line.removeprefix("ERROR: ") for line in lines if line.startswith("ERROR: ")]
        reason = next(iter(errors or lines[-1:]), "it says nothing")
        raise UserError(f"pip {arguments[0]}: {one_line(reason, _LONGEST_REASON)}")


def make_wheel(what: str, folder: Path) -> ModuleWheel:
    """The wheel of a package: `what` is a wheel, a folder, or a name on pip's index.

    Nothing is installed. A folder or an archive of sources runs its own build.

    Raises:
        UserError: the source is unknown, pip cannot make a wheel, or the wheel brings no module.
    """
    run_pip(["wheel", "--no-deps", "--wheel-dir", str(folder), _source(what, folder)], folder)
    wheels = sorted(folder.glob("*.whl"))
    if len(wheels) != 1:
        raise UserError(f"pip made {len(wheels)} wheels of {what}, where one is needed")
    return read_wheel(wheels[0])


def read_wheel(path: Path) -> ModuleWheel:
    """A wheel's facts, with its hash.

    Raises:
        UserError: it is no wheel, or it brings no module.
    """
    try:
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
            (info,) = {top for name in names if (top := name.split("/")[0]).endswith(".dist-info")}
            # A zipfile.Path has all that is read of a folder.
            distribution = PathDistribution(zipfile.Path(archive, f"{info}/"))
            facts = msgspec.structs.replace(facts_of(distribution), sha256=digest)
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise UserError(f"{path} is no wheel that can be read: {error}") from None
    if not facts.modules:
        raise UserError(
            f"{facts.name or path.name} brings no module: its metadata have no entry point of the "
            f"group {MODULES_GROUP}"
        )
    places = (_DATA_FOLDER.sub("", name) for name in names if name.endswith(".py"))
    tops = {place.split("/")[0].removesuffix(".py") for place in places}
    # Other folders of data are scripts and headers, which nothing imports.
    packages = sorted(top for top in tops if not top.endswith(".data"))
    return ModuleWheel(str(path), facts, tuple(packages))


def check_installable(wheel: ModuleWheel) -> None:
    """Pass if a package may be installed beside the others.

    Raises:
        UserError: it is vrut_lite's own, or for another version of vrut_lite, or a name that it
            brings is another package's.
    """
    facts = wheel.facts
    own_name = canonicalize_name(facts.name)
    if is_own(facts.name):
        raise UserError(f"{facts.name} is vrut_lite itself: update it as you installed it")
    try:
        check_host(facts.host)
    except UserError as error:
        raise UserError(f"{facts.title}, is not for this version: {error}") from None
    for point in entry_points(group=MODULES_GROUP):
        owner = point.dist.name if point.dist is not None else "another package"
        if point.name in facts.modules and canonicalize_name(owner) != own_name:
            raise UserError(
                f"{facts.title}, brings a module called {point.name}, which {owner} has already: "
                f"remove {owner} first"
            )
    owners = packages_distributions()
    for package in wheel.python_packages:
        others = {name for name in owners.get(package, ()) if canonicalize_name(name) != own_name}
        standard = package in sys.stdlib_module_names
        if others or standard or package == "vrut_lite":
            owner = ", ".join(sorted(others)) or ("Python" if standard else "vrut_lite")
            raise UserError(
                f"{facts.title}, brings a python package called {package}, which {owner} has "
                "already: its author must rename it"
            )


def _source(what: str, folder: Path) -> str:
    """The argument for pip: an absolute path, or a requirement by name alone.

    Of a folder it is a copy: a build there would leave its files, and take up those of an earlier
    one that the package has no more.
    """
    path = Path(what).expanduser()
    if path.is_dir():
        if not any((path / file).is_file() for file in ("pyproject.toml", "setup.py")):
            raise UserError(f"{what} is no package: the folder has no pyproject.toml")
        copy = folder / "source"
        shutil.copytree(path, copy, symlinks=True, ignore=shutil.ignore_patterns(*_NOT_SOURCES))
        return str(copy)
    if path.suffix == ".whl":
        if not path.is_file():
            raise UserError(f"cannot open {what}: there is no such file")
        return str(path.absolute())
    if not _NAME.fullmatch(what):
        raise UserError(
            f"{what!r} cannot be installed: name a wheel (.whl), a folder with a pyproject.toml, "
            "or a package on the index"
        )
    try:
        return str(Requirement(what))
    except ValueError:
        raise UserError(f"{what!r} is no name of a package") from None
