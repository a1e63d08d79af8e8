"""The folder of compiled kernels, and hooks that numba calls when it compiles.

Kernels lie in the user's cache folder, by version of vrut_lite: an upgrade in place finds none of
an earlier version, and uninstalling leaves nothing beside the packages. Below the version numba's
own names hold the path of the sources, so that installations side by side keep to their own. Those
that no start has used for 30 days are removed when something compiles. NUMBA_CACHE_DIR names
another folder, in which nothing is removed. If neither can be written, a temporary folder costs the
seconds of compilation in each process.
"""

import atexit
import hashlib
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

import platformdirs

_VARIABLE = "NUMBA_CACHE_DIR"
_FOLDER = "kernels"
_UNUSED_S = 30 * 86_400.0
# An index is marked as used once a day: a start need not write 60 files.
_MARKED_S = 86_400.0


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
# Version of vrut_lite.
_version = ""


def find_room(version: str) -> None:
    """Set NUMBA_CACHE_DIR to a new temporary folder if the folder of kernels is not writable.

    Call it before a kernel is called. Without even a temporary folder numba's refusal appears as a
    module that fails to load.

    Args:
        version: of vrut_lite.
    """
    global _version
    _version = version
    if _is_open(kernels_folder()):
        return
    try:
        folder = tempfile.mkdtemp(prefix="vrut_lite-compiled-")
    except OSError:
        return
    os.environ[_VARIABLE] = folder
    atexit.register(shutil.rmtree, folder, ignore_errors=True)


def kernels_folder() -> Path:
    """The folder of this version's kernels, or the one that NUMBA_CACHE_DIR names."""
    named = os.environ.get(_VARIABLE)
    return Path(named) if named else _all_versions() / _version


def share_kernels() -> None:
    """Let this process and those that it starts use one folder, whatever their cache folders."""
    os.environ[_VARIABLE] = str(kernels_folder())


def folder_of(sources: Path) -> Path:
    """The folder of compiled code of a folder of sources, by numba's rule."""
    path = os.path.abspath(sources)
    digest = hashlib.sha1(path.encode(), usedforsecurity=False).hexdigest()
    return kernels_folder() / f"{os.path.basename(path)}_{digest}"


def mark_used(index: Path) -> None:
    """Note that an index of compiled code was used, by its time of change."""
    with suppress(OSError):
        if time.time() - index.stat().st_mtime > _MARKED_S:
            os.utime(index)


def remove_unused() -> None:
    """Remove kernels of all versions and installations that were not used for 30 days."""
    if os.environ.get(_VARIABLE):
        return
    for index in _all_versions().glob("*/*/*.nbi"):
        with suppress(OSError):
            if time.time() - index.stat().st_mtime > _UNUSED_S:
                index.unlink()
                for code in _code_of(index):
                    code.unlink()
    # Only an empty folder can be removed.
    for depth in ("*/*", "*"):
        for folder in _all_versions().glob(depth):
            with suppress(OSError):
                folder.rmdir()


def _code_of(index: Path) -> Iterator[Path]:
    """Files of machine code that belong to an index: its name, a number, `nbc`."""
    for file in index.parent.glob("*.nbc"):
        if file.name.rsplit(".", 2)[0] == index.stem:
            yield file


def _all_versions() -> Path:
    return platformdirs.user_cache_path("vrut_lite") / _FOLDER


def _is_open(folder: Path) -> bool:
    """Whether files can be created in a folder, which may have to be created first."""
    try:
        there = next((place for place in (folder, *folder.parents) if place.exists()), folder)
        return there.is_dir() and os.access(there, os.W_OK | os.X_OK)
    except OSError:  # A name that is too long, a loop of links.
        return False
