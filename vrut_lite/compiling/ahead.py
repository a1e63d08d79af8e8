"""Compilation of all kernels that a user will need, started by the first one."""

from functools import cached_property
from typing import Any, Protocol

from vrut_lite import compiled_code
from vrut_lite.compiling.kernel_list import (
    Announced,
    KernelGroup,
    ListedKernel,
    announced_kernels,
    is_on_disk,
    kernel_of,
)
from vrut_lite.compiling.pool import KernelPool, Progress, is_first_use

# Least work (CPU s) for which processes are started; less is compiled before they are ready.
LEAST_SECONDS = 4.0
# Niceness of the processes behind a window, which draws meanwhile.
_BEHIND_A_WINDOW = 5


class Follower(Protocol):
    """Shows the progress of compilation; called on any thread."""

    def begin(self) -> None:
        """The first kernel is compiled."""

    def __call__(self, progress: Progress) -> None:
        """Kernels are compiled ahead."""


class CompileAhead:
    """Starts a `KernelPool` when numba compiles; where all kernels are on disk it does nothing.

    On a first start the pool works from the beginning, before a kernel is called.

    Args:
        follow: receives the progress.
        scene: a scene is drawn: kernels for its picture by the default settings are compiled too.
        window: a window is used: its kernels are compiled too.
    """

    def __init__(self, follow: Follower, scene: bool, window: bool = False):
        self.pool = KernelPool(follow, niceness=_BEHIND_A_WINDOW if window else 0)
        self._follow, self._scene, self._window = follow, scene, window
        self._began = False

    def begin(self) -> None:
        """Start at once where nothing was ever compiled: libraries are imported meanwhile."""
        groups = self.groups("")
        first = [group.kernels[0] for group in groups]
        if first and is_first_use() and not any(map(is_on_disk, first)):
            self._start(groups)

    def note(self, dispatcher: Any, arguments: Any) -> None:
        """Called when numba compiles a kernel, on any thread: compile the others ahead."""
        kernel = kernel_of(dispatcher, arguments)
        package = dispatcher.py_func.__module__.partition(".")[0]
        groups = self.groups(package)
        self._start(groups, but=kernel)

    def _start(self, groups: list[KernelGroup], but: ListedKernel | None = None) -> None:
        if not self._began:
            self._began = True
            self._follow.begin()
        if sum(group.seconds for group in groups) >= LEAST_SECONDS:
            self.pool.add(groups, but)

    def wait_for(self, dispatcher: Any, arguments: Any) -> None:
        """Return when no process of the pool compiles a kernel."""
        self.pool.wait_for(dispatcher, arguments)

    @cached_property
    def _announced(self) -> Announced:
        return announced_kernels()

    def groups(self, package: str) -> list[KernelGroup]:
        """Groups to compile when a kernel of a package is compiled; the shortest comes first.

        So the picture under the open sky comes before the light between surfaces.
        """
        groups = [
            group
            for name, each in self._announced.groups.items()
            for group in each
            if (name == package or (self._scene and group.on_default_way))
            and (self._window or not group.window_alone)
        ]
        return sorted(groups, key=lambda group: group.seconds)


def compile_ahead(follow: Follower, scene: bool, window: bool = False) -> CompileAhead:
    """From now on, compile ahead where numba compiles anything; see `CompileAhead`."""
    ahead = CompileAhead(follow, scene, window)
    compiled_code.ahead = ahead
    ahead.begin()
    return ahead
