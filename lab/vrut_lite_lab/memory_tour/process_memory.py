"""What the memory of a process is made of, as Linux, the C library and Python count it."""

import ctypes
import functools
import gc
import os
import re
import sys
import tempfile
import threading
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

MIB = 1 << 20
_LIBC = ctypes.CDLL(None)
_MAPPING = re.compile(r"^[0-9a-f]+-[0-9a-f]+ (\S+) \S+ \S+ (\d+)\s*(.*)$")


class ProcessMemory(NamedTuple):
    """Memory in MiB.

    Attributes:
        resident: memory in RAM; `proportional` counts pages shared with other processes by parts.
        anonymous: of it, what no file backs.
        heap_used, heap_free: of the C library's allocator, given out and kept for later.
        heap_mapped: blocks that the allocator maps one by one; they are part of `heap_used`.
        heaps: number of the allocator's arenas.
        python: arenas of Python's small objects; `blocks` is the number of objects in them.
        code: compiled at run time, by numba and by the software renderer.
        workers: resident memory of the child processes.
    """

    resident: float
    proportional: float
    anonymous: float
    heap_used: float
    heap_free: float
    heap_mapped: float
    heaps: int
    python: float
    blocks: int
    code: float
    threads: int
    files: int
    workers: float


class _MallInfo(ctypes.Structure):
    _fields_ = tuple(
        (name, ctypes.c_size_t)
        for name in ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks",
                     "uordblks", "fordblks", "keepcost")
    )  # fmt: skip


def process_memory() -> ProcessMemory:
    """The present state; takes 30 ms."""
    sums = _smaps_sums()
    heap = _heap()
    return ProcessMemory(
        resident=sums["Rss"] / MIB,
        proportional=sums["Pss"] / MIB,
        anonymous=sums["Anonymous"] / MIB,
        heap_used=(heap.uordblks + heap.hblkhd) / MIB,
        heap_free=heap.fordblks / MIB,
        heap_mapped=heap.hblkhd / MIB,
        heaps=_heap_count(),
        python=_python_arena_bytes() / MIB,
        blocks=sys.getallocatedblocks(),
        code=sums["code"] / MIB,
        threads=threading.active_count(),
        files=len(os.listdir("/proc/self/fd")),
        workers=sum(map(_resident_bytes, _children(os.getpid()))) / MIB,
    )


def _smaps_sums() -> Counter[str]:
    """Bytes by the kernel's names, and of anonymous executable mappings as "code"."""
    sums: Counter[str] = Counter()
    is_code = False
    for line in Path("/proc/self/smaps").read_text().splitlines():
        found = _MAPPING.match(line)
        if found:
            is_code = "x" in found[1] and found[2] == "0"
            continue
        name, _, rest = line.partition(":")
        if rest.endswith("kB"):
            size = int(rest[:-2]) * 1024
            sums[name] += size
            if is_code and name == "Rss":
                sums["code"] += size
    return sums


def _heap() -> Any:
    _LIBC.mallinfo2.restype = _MallInfo
    return _LIBC.mallinfo2()


def _heap_count() -> int:
    _LIBC.fopen.restype = ctypes.c_void_p
    with tempfile.NamedTemporaryFile() as file:
        stream = ctypes.c_void_p(_LIBC.fopen(file.name.encode(), b"w"))
        _LIBC.malloc_info(0, stream)
        _LIBC.fclose(stream)
        return file.read().count(b"<heap nr=")


def _python_arena_bytes() -> int:
    """Bytes in the arenas of small objects, which Python prints to standard error only."""
    sys.stderr.flush()
    kept = os.dup(2)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 2)
        try:
            sys._debugmallocstats()
            _LIBC.fflush(None)
        finally:
            os.dup2(kept, 2)
            os.close(kept)
        file.seek(0)
        said = file.read().decode()
    found = re.search(r"arenas \* \d+ bytes/arena\s*=\s*([\d,]+)", said)
    return int(found[1].replace(",", "")) if found else 0


def _children(process: int) -> list[int]:
    found = []
    for path in Path(f"/proc/{process}/task").glob("*/children"):
        for child in path.read_text().split():
            found += [int(child), *_children(int(child))]
    return found


def _resident_bytes(process: int) -> int:
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    except OSError:
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


class PythonObjects(NamedTuple):
    """Objects that the collector knows, by type, and MiB of arrays by who holds them first."""

    counts: Counter[str]
    arrays_mib: float
    arrays: int
    caches_mib: dict[str, float]


def python_objects() -> PythonObjects:
    """All objects, and what each `lru_cache` holds in arrays; takes a second."""
    things = gc.get_objects()
    counts = Counter(f"{type(thing).__module__}.{type(thing).__qualname__}" for thing in things)
    owned = _arrays_under(things)
    caches = {}
    for thing in things:
        if isinstance(thing, functools._lru_cache_wrapper):
            size = sum(map(_bytes, _arrays_under([thing], deep=True).values())) / MIB
            if size > 0.1:
                caches[f"{thing.__module__}.{thing.__qualname__}"] = size
    total = sum(map(_bytes, owned.values())) / MIB
    return PythonObjects(counts, total, len(owned), caches)


def _bytes(array: Any) -> int:
    return int(array.nbytes)


def _arrays_under(roots: Iterable[object], deep: bool = False) -> dict[int, Any]:
    """Arrays that are views of no other and are reached from these objects, by identity.

    Objects that the collector tracks are not entered unless `deep`: then all but modules, types and
    functions are.
    """
    found: dict[int, Any] = {}
    seen: set[int] = set()
    waiting = list(roots)
    for root in waiting:
        seen.add(id(root))
    while waiting:
        thing = waiting.pop()
        for part in gc.get_referents(thing):
            if id(part) in seen:
                continue
            if isinstance(part, np.ndarray):
                seen.add(id(part))
                whole = part
                while isinstance(whole.base, np.ndarray):
                    whole = whole.base
                found[id(whole)] = whole
                waiting.append(whole)
            elif not gc.is_tracked(part) or (deep and _may_enter(part)):
                seen.add(id(part))
                waiting.append(part)
    return found


def _may_enter(thing: object) -> bool:
    import types

    closed = types.ModuleType, type, types.FunctionType, types.MethodType, types.FrameType
    return not isinstance(thing, closed) and callable(thing) is False
