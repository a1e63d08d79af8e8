"""Writes the package of a new module from a template, with a recorded session.

The templates are packages themselves, whose tests pass: `new_sky`, `NewSky`, `New sky` and
`new-sky` stand for the names of the new one.
"""

import keyword
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Literal, get_args

from vrut_lite.discovery import NAMES_OF_THE_HOST, discover
from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.host_version import host_range
from vrut_lite.package_facts import HOST, MODULES_GROUP

Kind = Literal["sky", "layer", "tool"]
KINDS: tuple[str, ...] = get_args(Kind)
_TEMPLATES = Path(__file__).parents[1] / "module_templates"
_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
_LONGEST_NAME = 30
_RANGE_IN_TEMPLATES = re.compile(rf"{HOST}>=[0-9.]+,<[0-9.]+")


def write_package(name: str, kind: Kind, folder: Path) -> list[Path]:
    """Write the package of a module into an empty or a new folder; returns its files.

    Raises:
        UserError: the name is invalid or taken, or the folder is not writable or not empty.
        ModuleFailed: the session could not be recorded.
    """
    _check_name(name)
    folder = folder.absolute()
    try:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise UserError(f"{folder} is not empty: name another folder with --into")
        folder.parent.mkdir(parents=True, exist_ok=True)
        beside = folder.with_name(f"{folder.name}.unfinished")
        beside.mkdir()
        try:
            for path, text in _files(name, kind):
                (beside / path).parent.mkdir(parents=True, exist_ok=True)
                (beside / path).write_text(text, encoding="utf-8", newline="\n")
            _record_session(beside)
            if folder.exists():
                folder.rmdir()
            beside.rename(folder)
        finally:
            shutil.rmtree(beside, ignore_errors=True)
    except OSError as error:
        raise UserError(f"cannot write {folder}: {error.strerror or error}") from None
    return sorted(path for path in folder.rglob("*") if path.is_file())


def title_of(name: str) -> str:
    """The title of a module by its name."""
    return name.replace("_", " ").capitalize()


def package_name(name: str) -> str:
    """The name of a module's package on an index."""
    return name.replace("_", "-")


def _files(name: str, kind: Kind) -> Iterator[tuple[Path, str]]:
    """Paths within the package, and the text of each file."""
    words = {
        f"new_{kind}": name,
        f"new-{kind}": package_name(name),
        f"New{kind.capitalize()}": "".join(word.capitalize() for word in name.split("_")),
        f"New {kind}": title_of(name),
    }
    template = _TEMPLATES / kind
    for path in sorted(template.rglob("*")):
        place = path.relative_to(template)
        # Caches, and a session that somebody recorded there.
        is_left = any(part.startswith(".") or part == "__pycache__" for part in place.parts)
        if path.is_file() and not is_left and path.suffix != ".mcap":
            text = _renamed(path.read_text(encoding="utf-8"), words)
            yield (
                Path(_renamed(place.as_posix(), words)),
                _RANGE_IN_TEMPLATES.sub(f"{HOST}{host_range()}", text),
            )


def _renamed(text: str, words: dict[str, str]) -> str:
    return re.sub("|".join(words), lambda found: words[found[0]], text)


def _record_session(package: Path) -> None:
    """Run the package's script in a fresh process, as its author will."""
    paths = filter(None, [str(package), os.environ.get("PYTHONPATH")])
    done = subprocess.run(
        [sys.executable, str(package / "tests" / "session.py")],
        cwd=package,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        encoding="locale",
        check=False,
    )
    if done.returncode != 0:
        last = (done.stderr.strip() or "no reason").splitlines()[-1]
        raise ModuleFailed(f"the session of the new package could not be recorded: {last}")


def _check_name(name: str) -> None:
    if not _NAME.fullmatch(name) or len(name) > _LONGEST_NAME or keyword.iskeyword(name):
        raise UserError(
            f"{name!r} is no name of a module: write small letters, digits and _, "
            f"{_LONGEST_NAME} at most, such as rain_radar"
        )
    taken = {module.manifest.name for module in discover()[0]} | {*NAMES_OF_THE_HOST}
    if name in taken | {point.name for point in entry_points(group=MODULES_GROUP)}:
        raise UserError(f"a module called {name} is installed already: choose another name")
    found = find_spec(name)
    if name in sys.stdlib_module_names or (found is not None and found.origin is not None):
        raise UserError(f"a python package called {name} is installed already: choose another name")
