"""A process that compiles kernels: reads one a line from standard input, answers each by a line.

Its argument is its niceness.
"""

import gc
import json
import os
import signal
import sys

from vrut_lite.compiling.kernel_list import compile_kernel

# numba makes many objects and few cycles.
_NEW_OBJECTS = 100_000


def main() -> None:
    """Compile what comes until the input ends."""
    # Ctrl-C in the terminal reaches this process too; who started it ends it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(int(sys.argv[1]))
    gc.set_threshold(_NEW_OBJECTS)
    answers = sys.stdout
    # What a module prints is no answer.
    sys.stdout = sys.stderr
    for line in sys.stdin:
        try:
            compile_kernel(*json.loads(line))
            answer = "compiled"
        except Exception:
            # Who needs the kernel compiles it, and says what is wrong with it.
            answer = "failed"
        print(answer, file=answers, flush=True)
