"""Small JSON files of the user; a damaged one counts as empty and is renamed."""

import json
import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import Any

from vrut_lite.write_atomic import atomic_output, make_folder

# The window keeps some kilobytes.
_MOST_BYTES = 1 << 20
_ASIDE = ".damaged"


def read_object(file: Path) -> dict[str, Any]:
    """The object in a file; empty if the file is missing or damaged."""
    return _read(file) or {}


def write_object(file: Path, facts: dict[str, Any]) -> None:
    """Write a file, and its folder if it is missing.

    An unreadable file is renamed before, since the user may want its content back.

    Raises:
        UserError: the folder takes no files.
    """
    make_folder(file.parent)
    if _read(file) is None:
        set_aside(file)
    with atomic_output(file) as beside:
        beside.write_text(json.dumps(facts, indent=1), encoding="utf-8")


def set_aside(file: Path) -> None:
    """Rename the file, if it can be."""
    with suppress(OSError):
        os.replace(file, file.with_name(file.name + _ASIDE))


def _read(file: Path) -> dict[str, Any] | None:
    """The object in a file, empty if there is no file; None if it is damaged."""
    try:
        state = file.stat()
        # Reading a pipe would block, reading a device would never end.
        if not stat.S_ISREG(state.st_mode) or state.st_size > _MOST_BYTES:
            return None
        facts = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, RecursionError):
        return None
    return facts if isinstance(facts, dict) else None
