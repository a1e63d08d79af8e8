"""Background jobs of a window: pictures that a hand is waiting for go before them."""

import os
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

from vrut_lite import operating_system
from vrut_lite.kernel.job import Job
from vrut_lite.kernel.jobs import WORKERS, Finish, ThreadRunner

# Steps of niceness: a third of an equal share. With ten a window's pictures would gain little more,
# and the light of a playing hour come late.
_NICER = 5


class WindowJobs(ThreadRunner):
    """Runs jobs, and the threads that they start, at a lower priority than the process has.

    Jobs that a revision awaits keep the process's priority. Only Linux has priorities of threads.
    All methods but the work itself run on the kernel's thread.
    """

    def __init__(self) -> None:
        super().__init__()
        # A thread that was made nicer stays so.
        self._awaited = ThreadPoolExecutor(WORKERS, "vrut-lite awaited job")
        # Jobs that wait for the end of `held`; None outside it.
        self._held: list[tuple[Job, Finish]] | None = None

    @contextmanager
    def held(self) -> Iterator[None]:
        """Delay jobs started inside the context until its end, so that its own work goes first.

        Jobs that a revision awaits begin at once: its picture needs them.
        """
        self._held = []
        try:
            yield
        finally:
            self._let_go()
            self._held = None

    def start(self, job: Job, finish: Finish) -> None:
        """Run the job some time; within `held` after its end."""
        if self._held is None or job.role == "awaited":
            super().start(job, finish)
        else:
            self._held.append((job, finish))

    def wait(self) -> None:
        """Start delayed jobs, and return when no job runs or waits."""
        self._let_go()
        super().wait()

    def _let_go(self) -> None:
        if self._held:
            held, self._held = self._held, []
            for job, finish in held:
                super().start(job, finish)

    def close(self) -> None:
        """End the threads when their jobs return."""
        super().close()
        self._awaited.shutdown(wait=False, cancel_futures=True)

    def _submit(self, job: Job, finish: Finish) -> None:
        if job.role == "awaited":
            self._awaited.submit(self._run, job, finish)
        else:
            self._executor.submit(self._run_nicely, job, finish)

    def _run_nicely(self, job: Job, finish: Finish) -> None:
        if operating_system.NAME == "linux":
            niceness = os.getpriority(os.PRIO_PROCESS, os.getpid()) + _NICER
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), min(niceness, 19))
        self._run(job, finish)
