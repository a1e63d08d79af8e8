"""Processes that compile kernels: each reads one a line, and answers each by a line.

Arguments are their niceness and the numbers of their sockets. The first process imports numba, and
forks one for each further socket: an import takes a second. Without sockets a process has its
standard input and output.
"""

import gc
import json
import os
import socket
import sys
import threading
from typing import TextIO

from vrut_lite.compiling.kernel_list import compile_kernel
from vrut_lite.lazy import lazy
from vrut_lite.operating_system import lower_priority

# Module by which numba colours its error messages; it took 2 % of the time, for messages about
# typings that numba tries and drops.
_COLOURS = "colorama"
_compiler = lazy("vrut_lite.numba_compiler")


def main() -> None:
    """Compile the kernels that the sockets name, until they end."""
    lower_priority(int(sys.argv[1]))
    # Collections took 12 % of the CPU time; without them a process takes 0.17 GB more.
    gc.disable()
    sys.modules[_COLOURS] = None  # type: ignore[assignment]
    _compiler.cpu_target.target_context.refresh()
    ends = [socket.socket(fileno=int(number)) for number in sys.argv[2:]]
    own, children = _forked(len(ends))
    for number, end in enumerate(ends):
        if number != own:
            end.close()
    lines = _lines(ends[own]) if ends else _standard_lines()
    # On a thread: the C library returns a first thread's memory after each compilation, and the
    # system took 2.4 s to clear it again, where a thread's arena takes 1.0.
    compiling = threading.Thread(target=_compile_what_comes, args=lines)
    compiling.start()
    compiling.join()
    for child in children:
        os.waitpid(child, 0)
    # An interpreter that ends collects once more, for 0.7 s.
    os._exit(0)


def _forked(count: int) -> tuple[int, list[int]]:
    """Number of this process among `count`, and the processes that it has forked."""
    children: list[int] = []
    for number in range(1, count):
        child = os.fork()
        if child == 0:
            return number, []
        children.append(child)
    return 0, children


def _lines(end: socket.socket) -> tuple[TextIO, TextIO]:
    lines = end.makefile("rw", encoding="utf-8")
    return lines, lines


def _standard_lines() -> tuple[TextIO, TextIO]:
    """Standard input, and the former standard output: libraries may write to the present one."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return sys.stdin, answers


def _compile_what_comes(orders: TextIO, answers: TextIO) -> None:
    with orders, answers:
        for line in orders:
            try:
                compile_kernel(*json.loads(line))
                answer = "compiled"
            except Exception:
                # The caller of the kernel compiles it then, and reports the error.
                answer = "failed"
            print(answer, file=answers, flush=True)
