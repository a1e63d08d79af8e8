"""The operating system, and substitutes for what only some systems have.

Its name is read from here and nowhere else, so that a test can change it.
"""

import os
import signal
import sys
from contextlib import suppress

# As in `sys.platform`: "linux", "darwin" (macOS), "win32".
NAME = sys.platform


def usable_cores() -> int:
    """Number of cores that this process may use, as far as the system says; else of all."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def lower_priority(steps: int) -> None:
    """Lower the priority of this process by steps of niceness, where the system has such."""
    if hasattr(os, "nice"):
        os.nice(steps)


def end_group(process: int) -> None:
    """End the process of a number, which leads a group, with all that it has started.

    Where the system has no groups it ends alone.
    """
    with suppress(ProcessLookupError):
        if hasattr(os, "killpg"):
            os.killpg(process, signal.SIGKILL)
        else:
            os.kill(process, signal.SIGTERM)


def can_fork() -> bool:
    """Whether a process with loaded libraries may be forked: those of macOS end a forked one."""
    return hasattr(os, "fork") and NAME != "darwin"


def has_egl() -> bool:
    """Whether OpenGL is opened through EGL; Windows has WGL and macOS CGL instead."""
    return NAME not in ("win32", "darwin")
