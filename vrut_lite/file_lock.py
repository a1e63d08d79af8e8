"""Locks of files between processes, by the system's own way."""

import contextlib
import errno
from typing import Any

_fcntl: Any = None
_msvcrt: Any = None
with contextlib.suppress(ModuleNotFoundError):
    import fcntl as _fcntl  # POSIX.
with contextlib.suppress(ModuleNotFoundError):
    import msvcrt as _msvcrt  # Windows.


def lock_file(handle: int, wait: bool) -> None:
    """Lock an open file, or a folder on POSIX, until its handle is closed.

    Args:
        handle: the file's number.
        wait: for the process that has the lock.

    Raises:
        BlockingIOError: another process has it, and `wait` is off.
        OSError: there are no locks here.
    """
    if _fcntl is not None:
        _fcntl.flock(handle, _fcntl.LOCK_EX | (0 if wait else _fcntl.LOCK_NB))
    elif _msvcrt is not None:
        _lock_first_byte(handle, wait)
    else:
        raise OSError(errno.ENOLCK, "this system has no locks of files")


def _lock_first_byte(handle: int, wait: bool) -> None:
    """Windows locks bytes; it waits for ten seconds at most, then raises OSError."""
    try:
        _msvcrt.locking(handle, _msvcrt.LK_LOCK if wait else _msvcrt.LK_NBLCK, 1)
    except PermissionError as error:
        if wait:
            raise
        raise BlockingIOError(error.errno, error.strerror) from None
