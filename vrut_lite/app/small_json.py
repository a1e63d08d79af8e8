"""Small JSON files of the user's: one that is damaged counts as none, and is set aside."""

import json
import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import Any

from vrut_lite.errors import UserError
from vrut_lite.write_atomic import atomic_output

# What the window keeps takes some kilobytes.
_MOST_BYTES = 1 << 20
_ASIDE = ".damaged"


def read_object(file: Path) -> dict[str, Any]:
    """What a file holds by name; nothing if it is not there or damaged, however."""
    return _read(file) or {}


def write_object(file: Path, facts: dict[str, Any]) -> None:
    """Write a file, and its folder if there is none.

    One that cannot be read is given a longer name before: it may hold what its user wants back.

    Raises:
        UserError: the folder takes no files.
    """
    make_folder(file.parent)
    if _read(file) is None:
        set_aside(file)
    with atomic_output(file) as beside:
        beside.write_text(json.dumps(facts, indent=1), encoding="utf-8")


def set_aside(file: Path) -> None:
    """Give whatever lies there a longer name, if it can be done."""
    with suppress(OSError):
        os.replace(file, file.with_name(file.name + _ASIDE))


def make_folder(folder: Path) -> None:
    """Make a folder, and those that it lies in.

    Raises:
        UserError: it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot make the folder {folder}: {error.strerror}") from None


def _read(file: Path) -> dict[str, Any] | None:
    """What a file holds, nothing if there is none; None for one that is damaged."""
    try:
        state = file.stat()
        # A pipe would be waited for, a device read without end.
        if not stat.S_ISREG(state.st_mode) or state.st_size > _MOST_BYTES:
            return None
        facts = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, RecursionError):
        return None
    return facts if isinstance(facts, dict) else None
