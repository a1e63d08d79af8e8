"""Atomic files: written beside their place, then renamed."""

import os
import signal
import stat
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from vrut_lite.errors import UserError
from vrut_lite.interrupts import interrupts_held

# The longest name that systems accept.
_LONG_NAME = 4096


@contextmanager
def atomic_output(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A path in the same folder to write to; it becomes `path` when the block ends well.

    An older file at `path` is replaced in one step; after an exception it is as it was and the
    unfinished one is gone. A symbolic link is followed, so that its target is replaced.

    Raises:
        UserError: the folder or the disk refuses the file (any OSError of the block).
    """
    target = Path(os.path.realpath(path))
    beside = _beside(target)
    try:
        yield beside
        os.replace(beside, target)
    except OSError as error:
        raise UserError(f"cannot write {path}: {_reason(error)}") from error
    finally:
        # Removal fails only where no file was made.
        with suppress(OSError):
            beside.unlink()


def check_writable(path: str | os.PathLike[str]) -> None:
    """Check before long work that `path` can be written.

    A file is made beside it and removed: permission bits alone say little about mounts,
    access lists and root.

    Raises:
        UserError: the folder is missing or refuses files, or `path` is no plain writable file.
    """
    folder = Path(path).parent
    try:
        target = Path(os.path.realpath(path))
        folder = target.parent
        objection = _objection(target)
        if not objection:
            _try_a_file(_beside(target))
    except OSError as error:
        objection = f"{_reason(error)} in {folder}"
    except ValueError:
        objection = "its name holds what no name of a file can"
    if objection:
        raise UserError(f"cannot write {_shown(path)}: {objection}")


def check_all_writable(paths: Sequence[str | os.PathLike[str]]) -> None:
    """`check_writable` for files of one folder: the first in full, the others by their names.

    Raises:
        UserError: one of them cannot be written.
    """
    check_writable(paths[0])
    for path in paths[1:]:
        try:
            objection = _objection(Path(path))
        except OSError as error:
            objection = _reason(error)
        if objection:
            raise UserError(f"cannot write {_shown(path)}: {objection}")


def make_folder(folder: Path) -> None:
    """Make a folder and its parents.

    Raises:
        UserError: it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise UserError(f"cannot make the folder {folder}: it is a file") from None
    except OSError as error:
        raise UserError(f"cannot make the folder {folder}: {error.strerror or error}") from None


def _shown(path: str | os.PathLike[str]) -> str:
    """A path for a sentence; of a path that is too long, its end."""
    text = os.fspath(path)
    if len(text) > _LONG_NAME:
        return f"{text[: _LONG_NAME // 2]}...{text[-_LONG_NAME // 2 :]}"
    return repr(text) if "\0" in text else text


def _objection(target: Path) -> str:
    """The reason why the path cannot be a picture's, or an empty text; may also raise OSError."""
    if not target.parent.is_dir():
        return f"there is no folder {target.parent}; make it first"
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        return ""
    if stat.S_ISDIR(mode):
        return "it is a folder; name a file in it"
    if not stat.S_ISREG(mode):
        return "it is no plain file; name another"
    # Opened without truncation: an older write-protected file must stay.
    os.close(os.open(target, os.O_WRONLY))
    return ""


def _try_a_file(path: Path) -> None:
    """Make a file and remove it, also when the process is interrupted between the two."""
    with interrupts_held(signal.SIGINT, signal.SIGTERM):
        path.touch(exist_ok=False)
        path.unlink()


def _beside(target: Path) -> Path:
    # Not derived from the target's name, which may have the largest length.
    return target.with_name(f".unfinished-{uuid.uuid4().hex}{target.suffix}")


def _reason(error: OSError) -> str:
    return error.strerror.lower() if error.strerror else str(error)
