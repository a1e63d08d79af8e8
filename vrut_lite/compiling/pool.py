"""Processes that compile announced kernels side by side while their user goes on.

Within a process numba compiles one kernel at a time. A process saves its kernels in numba's cache
on disk, where this process finds them: it waits for the kernels that it needs. Kernels with the
same named tuples call the same inner functions, which each process compiles for itself: they go to
one process, which saves a seventh of the CPU time on two. All are forked from one that has imported
numba; where a process cannot be forked, each imports it.
"""

import atexit
import json
import socket
import subprocess
import sys
import threading
import time
from collections import defaultdict, deque
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import IO, Any, NamedTuple

import platformdirs

from vrut_lite.compiling.kernel_list import KernelGroup, ListedKernel, kernel_of
from vrut_lite.file_lock import lock_file
from vrut_lite.operating_system import can_fork, end_group, usable_cores

# Each process takes 0.45 GB.
MOST_PROCESSES = 4
_WORKER = "import sys; sys.path[0:1] = []; from vrut_lite.compiling.worker import main; main()"


class Progress(NamedTuple):
    """Progress of a compilation.

    Attributes:
        title: title of the kernel being compiled; empty at the end.
        done: number of compiled kernels.
        total: number of kernels.
        left_s: remaining seconds at the present pace.
    """

    title: str
    done: int
    total: int
    left_s: float


class WorkerLines(NamedTuple):
    """Our ends of the way to a process: kernels to compile, a line each, and its answers."""

    orders: IO[str]
    answers: IO[str]


Key = tuple[str, str, str]
Follow = Callable[[Progress], None]


class KernelPool:
    """Compiles groups of kernels in their order.

    `follow` is called with each step, on the threads of the pool; its last call has
    `done == total`.
    """

    def __init__(self, follow: Follow, processes: int | None = None, niceness: int = 0):
        self._follow, self._niceness = follow, niceness
        self.processes = processes or min(MOST_PROCESSES, usable_cores())
        self._changed = threading.Condition()
        self._queue: deque[tuple[str, ListedKernel]] = deque()
        # Number of the process that compiles the kernels of a family.
        self._owners: dict[str, int] = {}
        # Titles of the kernels being compiled, by key.
        self._running: dict[Key, str] = {}
        self._known: set[Key] = set()
        self._done = 0
        self._done_s = self._total_s = 0.0
        self._start_s = time.perf_counter()
        self._servers: list[threading.Thread] = []
        # How many of them still feed a process.
        self._serving = 0
        # The first of them, which has forked the others of its group; or all of them.
        self._processes: list[subprocess.Popen[str]] = []
        self._lock: IO[str] | None = None
        self._closed = False

    @property
    def is_on(self) -> bool:
        """Whether kernels are still to come."""
        with self._changed:
            return bool(self._queue or self._running)

    def add(self, groups: Iterable[KernelGroup], but: ListedKernel | None = None) -> None:
        """Add groups to compile, except the kernel `but`, which the caller compiles."""
        with self._changed:
            for group in groups:
                for kernel in group.kernels:
                    if kernel.key not in self._known and not (but and kernel.key == but.key):
                        self._known.add(kernel.key)
                        self._total_s += kernel.seconds
                        self._queue.append((group.title, kernel))
        self._start()

    def wait_for(self, dispatcher: Any, arguments: Any) -> None:
        """Return when the pool has no more to do with this kernel; it comes next of its group.

        Compiling it here would not be sooner: all cores compile kernels that were needed before.

        Args:
            dispatcher: numba's object of a compiled function.
            arguments: numba types.
        """
        if not self.is_on:
            return
        kernel = kernel_of(dispatcher, arguments)
        if kernel is None:
            return
        with self._changed:
            self._put_first(kernel.key)
            self._changed.wait_for(lambda: not self._is_to_come(kernel.key))

    def _put_first(self, key: Key) -> None:
        own = next((each for each in self._queue if each[1].key == key), None)
        if own is not None:
            self._queue.remove(own)
            titles = [title for title, _ in self._queue]
            at = titles.index(own[0]) if own[0] in titles else len(titles)
            self._queue.insert(at, own)

    def _is_to_come(self, key: Key) -> bool:
        return key in self._running or any(kernel.key == key for _, kernel in self._queue)

    def close(self) -> None:
        """End the processes; what they have saved stays."""
        with self._changed:
            self._closed = True
            self._queue.clear()
            self._running.clear()
            self._changed.notify_all()
        for process in self._processes:
            if process.poll() is None:
                end_group(process.pid)
                process.wait()
        for server in self._servers:
            server.join()

    def join(self) -> None:
        """Wait until all kernels are there."""
        for server in self._servers:
            server.join()

    def _start(self) -> None:
        """Start processes, unless they run, or those of another program compile the same."""
        if self._servers or not self._queue or not self._is_alone():
            return
        atexit.register(self.close)
        count = self._serving = min(self.processes, len(self._queue))
        # The process of the largest family begins with it, while others begin with the first group.
        family_s: dict[str, float] = defaultdict(float)
        for _, kernel in self._queue:
            family_s[kernel.family] += kernel.seconds
        self._owners[max(family_s, key=lambda family: family_s[family])] = 0
        try:
            ends = self._forked(count) if can_fork() else self._started(count)
        except OSError:  # No memory for a process, say: kernels are compiled where they are needed.
            self._serving = 1
            self._end()
            return
        self._servers = [
            threading.Thread(
                target=self._serve, args=(k, end), name=f"vrut-lite compiling_{k}", daemon=True
            )
            for k, end in enumerate(ends)
        ]
        for server in self._servers:
            server.start()

    def _forked(self, count: int) -> list[WorkerLines]:
        """Start a process that forks the others; returns our ends of the sockets to them."""
        pairs = [socket.socketpair() for _ in range(count)]
        numbers = [theirs.fileno() for _, theirs in pairs]
        try:
            self._processes.append(self._process(numbers))
        finally:
            for _, theirs in pairs:
                theirs.close()
        ends = []
        for ours, _ in pairs:
            # The socket is closed with its file.
            with ours:
                lines = ours.makefile("rw", encoding="utf-8")
            ends.append(WorkerLines(lines, lines))
        return ends

    def _started(self, count: int) -> list[WorkerLines]:
        """Start all processes; returns our ends of their pipes."""
        self._processes = [self._process([]) for _ in range(count)]
        return [
            WorkerLines(process.stdin, process.stdout)
            for process in self._processes
            if process.stdin is not None and process.stdout is not None
        ]

    def _process(self, sockets: list[int]) -> "subprocess.Popen[str]":
        """A process for the sockets of these numbers; without any, for its standard pipes."""
        pipe = subprocess.DEVNULL if sockets else subprocess.PIPE
        return subprocess.Popen(
            [sys.executable, "-c", _WORKER, str(self._niceness), *map(str, sockets)],
            stdin=pipe,
            stdout=pipe,
            stderr=subprocess.DEVNULL,
            pass_fds=sockets,
            process_group=0,
            encoding="utf-8",
        )

    def _is_alone(self) -> bool:
        """Whether no other program compiles; if so, none will until this one has ended."""
        file = _lock_file()
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            self._lock = open(file, "w", encoding="utf-8")  # noqa: SIM115
            lock_file(self._lock.fileno(), wait=False)
        except BlockingIOError:
            with self._changed:
                self._queue.clear()
                self._changed.notify_all()
            return False
        except OSError:  # There is no such folder, or it has no locks.
            pass
        return True

    def _serve(self, number: int, ends: WorkerLines) -> None:
        """Feed one process."""
        try:
            # It ends when its socket or pipe is closed.
            with ends.answers, ends.orders:
                while not self._closed and self._feed(ends, number):
                    pass
        except OSError:  # The process has ended.
            pass
        finally:
            # After any error, a follower's too, nobody may wait for ever.
            self._end()

    def _feed(self, ends: WorkerLines, number: int) -> bool:
        """Compile the next kernel; False without one, or if the process has ended."""
        with self._changed:
            if not self._queue:
                return False
            title, kernel = self._next_of(number)
            self._running[kernel.key] = f"{title}: {kernel.title}"
        try:
            self._tell()
            return _is_answered(ends, kernel)
        finally:
            with self._changed:
                self._running.pop(kernel.key, None)
                self._done += 1
                self._done_s += kernel.seconds
                self._changed.notify_all()

    def _next_of(self, number: int) -> tuple[str, ListedKernel]:
        """Take a kernel of the first group: of this process's families, of no other's, or any."""
        group = [each for each in self._queue if each[0] == self._queue[0][0]]
        owners = [self._owners.get(kernel.family) for _, kernel in group]
        wish = next((owner for owner in (number, None) if owner in owners), owners[0])
        taken = group[owners.index(wish)]
        self._queue.remove(taken)
        self._owners.setdefault(taken[1].family, number)
        return taken

    def _end(self) -> None:
        """Release all waiting threads, after the last process has ended."""
        with self._changed:
            self._serving -= 1
            if self._serving:
                return
            self._queue.clear()
            self._running.clear()
            self._done, self._done_s = len(self._known), self._total_s
            self._changed.notify_all()
            if self._lock is not None:
                self._lock.close()
        if not self._closed:
            self._tell()

    def _tell(self) -> None:
        with self._changed:
            running = list(self._running.values())
            took_s = max(time.perf_counter() - self._start_s, 1e-3)
            # At first, before any is done: each process at the pace of the list's machine.
            pace = self._done_s / took_s if self._done else float(self.processes)
            left_s = (self._total_s - self._done_s) / max(pace, 1e-3)
            told = Progress(running[0] if running else "", self._done, len(self._known), left_s)
        self._follow(told)


def is_first_use() -> bool:
    """Whether no pool has compiled for this user yet."""
    return not _lock_file().exists()


def _lock_file() -> Path:
    return platformdirs.user_cache_path("vrut_lite") / "compiling.lock"


def _is_answered(ends: WorkerLines, kernel: ListedKernel) -> bool:
    """Let a process compile a kernel; False where the process has ended."""
    try:
        print(json.dumps(kernel.key), file=ends.orders, flush=True)
        return bool(ends.answers.readline())
    except OSError:
        return False
