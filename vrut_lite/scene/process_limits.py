"""Limits and error messages of a process that reads one scene file."""

import os
import resource
import sys
from collections.abc import Callable

import msgspec

from vrut_lite.scene.mesh_file import MeshFile

# C++'s messages when memory for objects, or for a thread's stack, ends.
_LACKS_MEMORY = ("bad_alloc", "Resource temporarily unavailable")


class Damaged(Exception):
    """A fault of the file that the library would not name."""


def run_reader(
    read: Callable[[str, bytes], MeshFile], seconds: float, seconds_per_byte: float
) -> None:
    """Reads standard input by `read` and writes its `MeshFile`, under `sys.argv`'s limit of memory.

    CPU time is limited to `seconds` and `seconds_per_byte` of the input.
    """
    suffix, most_bytes = sys.argv[1], int(sys.argv[2])
    # The answer has standard output alone: libraries in C++ write messages there.
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    resource.setrlimit(resource.RLIMIT_AS, (most_bytes, most_bytes))
    try:
        data = sys.stdin.buffer.read()
        limit = int(seconds + seconds_per_byte * len(data))
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
        told = msgspec.msgpack.encode(answered(read, suffix, data))
    except MemoryError:
        told = msgspec.msgpack.encode(MeshFile(fault="memory", lacks_memory=True))
    with answer:
        answer.write(told)


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
