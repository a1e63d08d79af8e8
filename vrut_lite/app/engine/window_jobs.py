"""Background jobs of a window: pictures that a hand is waiting for go before them."""

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from vrut_lite.kernel.job import Job
from vrut_lite.kernel.jobs import Finish, ThreadRunner

# Steps of niceness: a third of an equal share. With ten a window's pictures would gain little more,
# and the light of a playing hour come late.
_NICER = 5


class WindowJobs(ThreadRunner):
    """Runs jobs, and the threads that they start, at a lower priority than the process has.

    Elsewhere than on Linux threads have no priority of their own. All but `start`'s work is for the
    kernel's thread.
    """

    def __init__(self) -> None:
        super().__init__()
        # How many were started, and the numbers of those that run.
        self.started = 0
        self._numbers: dict[Job, int] = {}
        # What waits for the end of `held`; None outside it.
        self._held: list[tuple[Job, Finish]] | None = None

    @contextmanager
    def held(self) -> Iterator[None]:
        """Let jobs that are started within begin at its end: what is done in it goes first."""
        self._held = []
        try:
            yield
        finally:
            self._let_go()
            self._held = None

    def is_busy_since(self, started: int) -> bool:
        """Whether a job runs that was none of the first so many that were `started`."""
        return any(
            number > started and not job.control.cancelled()
            for job, number in tuple(self._numbers.items())
        )

    def start(self, job: Job, finish: Finish) -> None:
        """Run the job some time; within `held` after its end."""
        self.started += 1
        self._numbers[job] = self.started
        if self._held is None:
            super().start(job, finish)
        else:
            self._held.append((job, finish))

    def wait(self) -> None:
        """Return when no job runs or waits; what is held up is begun for it."""
        self._let_go()
        super().wait()

    def _let_go(self) -> None:
        if self._held:
            held, self._held = self._held, []
            for job, finish in held:
                super().start(job, finish)

    def _run(self, job: Job, finish: Finish) -> None:
        if sys.platform == "linux":
            niceness = os.getpriority(os.PRIO_PROCESS, os.getpid()) + _NICER
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), min(niceness, 19))
        super()._run(job, finish)
        self._numbers.pop(job, None)
