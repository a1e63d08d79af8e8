"""A writable folder for numba's compiled code, and hooks that numba calls when it compiles.

numba tries NUMBA_CACHE_DIR, the package's own folder and the user's cache. If none is writable (a
system-wide installation, an unreadable home) it refuses to compile. A temporary folder for this
process then costs only the seconds of compilation.
"""

import atexit
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Protocol

import platformdirs

_VARIABLE = "NUMBA_CACHE_DIR"


class Ahead(Protocol):
    """Who compiles ahead; called with numba's object of a function and its types of arguments."""

    def note(self, dispatcher: Any, arguments: Any) -> None:
        """A function is compiled."""

    def wait_for(self, dispatcher: Any, arguments: Any) -> None:
        """A function will be looked for on disk, and compiled if it is not there."""


# Set here, numba need not be imported for that.
ahead: Ahead | None = None
# Hooks called before a function is looked for on disk, for lists of called kernels.
before_kernel: list[Callable[[Any, Any], None]] = []
# Number of kernels that this process has compiled; those found on disk do not count.
compilations = 0


def find_room(package: Path) -> None:
    """Set NUMBA_CACHE_DIR to a new temporary folder if none of numba's own is writable.

    Call it before numba is imported, which reads the variable once. Without even a temporary
    folder numba's refusal appears as a module that fails to load.
    """
    named = os.environ.get(_VARIABLE)
    places = [Path(named)] if named else []
    if any(map(_is_open, [*places, package, platformdirs.user_cache_path("numba")])):
        return
    try:
        folder = tempfile.mkdtemp(prefix="vrut_lite-compiled-")
    except OSError:
        return
    os.environ[_VARIABLE] = folder
    atexit.register(shutil.rmtree, folder, ignore_errors=True)


def folders_of(sources: Path) -> Iterator[Path]:
    """Folders in which numba keeps compiled code of a folder of sources."""
    named = os.environ.get(_VARIABLE)
    if not named:
        yield sources / "__pycache__"
    common = Path(named) if named else platformdirs.user_cache_path("numba")
    yield from common.glob(f"{sources.name}_*")


def _is_open(folder: Path) -> bool:
    """Whether files can be created in a folder, which may have to be created first."""
    try:
        there = next((place for place in (folder, *folder.parents) if place.exists()), folder)
        return there.is_dir() and os.access(there, os.W_OK | os.X_OK)
    except OSError:  # A name that is too long, a loop of links.
        return False
