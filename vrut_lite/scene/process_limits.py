"""Limits and error messages of a process that reads one scene file."""

import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import msgspec

from vrut_lite.scene.mesh_file import MeshFile

_resource: Any = None
with suppress(ModuleNotFoundError):
    import resource as _resource  # POSIX.

_TIME_IS_UP = 124
# Statuses of a process that has used up its CPU time.
TIME_IS_UP = (
    _TIME_IS_UP,
    *(-number for number in signal.Signals if number.name in ("SIGXCPU", "SIGKILL")),
)
_LOOK_S = 0.5
# C++'s messages when memory for objects, or for a thread's stack, ends.
_LACKS_MEMORY = ("bad_alloc", "Resource temporarily unavailable")


class Damaged(Exception):
    """A fault of the file that the library would not name."""


def run_reader(
    read: Callable[[str, bytes], MeshFile], seconds: float, seconds_per_byte: float
) -> None:
    """Reads standard input by `read` and writes its `MeshFile`, under `sys.argv`'s limit of memory.

    CPU time is limited to `seconds` and `seconds_per_byte` of the input. Windows does not limit a
    process's memory, and macOS only some of it: there the content alone is bounded, by who reads
    the answer.
    """
    suffix, most_bytes = sys.argv[1], int(sys.argv[2])
    # The answer has standard output alone: libraries in C++ write messages there.
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    if _resource is not None:
        # Systems may refuse a limit that is less than what the process has mapped.
        with suppress(ValueError, OSError):
            _resource.setrlimit(_resource.RLIMIT_AS, (most_bytes, most_bytes))
    try:
        data = sys.stdin.buffer.read()
        _end_after(seconds + seconds_per_byte * len(data))
        told = msgspec.msgpack.encode(answered(read, suffix, data))
    except MemoryError:
        told = msgspec.msgpack.encode(MeshFile(fault="memory", lacks_memory=True))
    with answer:
        answer.write(told)


def _end_after(seconds: float) -> None:
    """Let this process end once it has used so much CPU time."""
    if _resource is not None:
        limit = int(seconds)
        _resource.setrlimit(_resource.RLIMIT_CPU, (limit, limit))
        return

    # A library that never lets Python run outlives it, until the reader of the answer gives up.
    def watch() -> None:
        while time.process_time() < seconds:
            time.sleep(_LOOK_S)
        os._exit(_TIME_IS_UP)

    threading.Thread(target=watch, name="time-limit", daemon=True).start()


def answered(read: Callable[[str, bytes], MeshFile], suffix: str, data: bytes) -> MeshFile:
    """The content of a file, or its fault."""
    try:
        return read(suffix, data)
    except ImportError as fault:
        return MeshFile(fault=str(fault), lacks_library=True)
    except MemoryError:
        return MeshFile(fault="memory", lacks_memory=True)
    except Exception as fault:
        if any(words in str(fault) for words in _LACKS_MEMORY):
            return MeshFile(fault="memory", lacks_memory=True)
        return MeshFile(fault=" ".join(str(fault).split())[:120] or type(fault).__name__)
