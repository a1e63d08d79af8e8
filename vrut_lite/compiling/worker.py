"""A process that compiles kernels: reads one a line from standard input, answers each by a line.

Its argument is its niceness.
"""

import gc
import json
import os
import signal
import sys
import threading
from typing import TextIO

from vrut_lite.compiling.kernel_list import compile_kernel

# Module by which numba colours its error messages; it took 2 % of the time, for messages about
# typings that numba tries and drops.
_COLOURS = "colorama"
# Garbage collector's threshold: numba makes many objects and few cycles.
_NEW_OBJECTS = 100_000


def main() -> None:
    """Compile the kernels that standard input names, until it ends."""
    # Ctrl-C in the terminal reaches this process too; its parent ends it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(int(sys.argv[1]))
    gc.set_threshold(_NEW_OBJECTS)
    sys.modules[_COLOURS] = None  # type: ignore[assignment]
    # On a thread: the C library returns a first thread's memory after each compilation, and the
    # system took 2.4 s to clear it again, where a thread's arena takes 1.0.
    compiling = threading.Thread(target=_compile_what_comes, args=(sys.stdout,))
    # Prints of imported modules go to stderr: they are no answers.
    sys.stdout = sys.stderr
    compiling.start()
    compiling.join()


def _compile_what_comes(answers: TextIO) -> None:
    for line in sys.stdin:
        try:
            compile_kernel(*json.loads(line))
            answer = "compiled"
        except Exception:
            # The caller of the kernel compiles it then, and reports the error.
            answer = "failed"
        print(answer, file=answers, flush=True)
