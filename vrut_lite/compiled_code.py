"""Where numba keeps what it compiles: in a folder that can be written.

It tries NUMBA_CACHE_DIR, the package's own folder and the user's cache, and where none of them
takes files (a system-wide installation, a home that cannot be read) it refuses to compile at all.
A folder for this process alone then costs the compilation's seconds, not the sky.
"""

import atexit
import os
import shutil
import tempfile
from pathlib import Path

import platformdirs

_VARIABLE = "NUMBA_CACHE_DIR"


def find_room(package: Path) -> None:
    """Name a new temporary folder in NUMBA_CACHE_DIR if no usual one can be written.

    To be called before numba is imported: it reads the variable once. Where there is not even
    a temporary folder, numba's refusal is told as any module's that fails to load.
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


def _is_open(folder: Path) -> bool:
    """Whether files can be made there, the folder itself too if it is missing."""
    try:
        there = next((place for place in (folder, *folder.parents) if place.exists()), folder)
        return there.is_dir() and os.access(there, os.W_OK | os.X_OK)
    except OSError:  # A name that is too long, a loop of links.
        return False
