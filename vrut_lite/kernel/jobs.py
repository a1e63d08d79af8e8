"""Where background jobs run: on threads when live; on the spot, and held, in a replay."""

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol

from vrut_lite.kernel.job import Job, Key
from vrut_lite.kernel.messages import JobResult

Finish = Callable[[Job, JobResult], None]
_WORKERS = 4


class JobRunner(Protocol):
    """Runs jobs; a key's next is started after its result was admitted or it was cancelled."""

    def start(self, job: Job, finish: Finish) -> None:
        """Run the job some time and pass its result to `finish`, from any thread."""

    def wait(self) -> None:
        """Return when every job that was started has finished."""

    def close(self) -> None:
        """Start nothing more."""


class ThreadRunner:
    """Runs jobs on a few threads, one at a time of each key.

    A cancelled job cannot be torn from its thread: its successor waits until it returns.
    """

    def __init__(self) -> None:
        self._executor = ThreadPoolExecutor(_WORKERS, "vrut-lite job")
        self._busy: dict[Key, tuple[Job, Finish] | None] = {}
        self._changed = threading.Condition()

    def start(self, job: Job, finish: Finish) -> None:
        """Hand the job to a thread, or let it wait for a cancelled one of its key."""
        with self._changed:
            if job.key in self._busy:
                self._busy[job.key] = (job, finish)
                return
            self._busy[job.key] = None
        self._executor.submit(self._run, job, finish)

    def wait(self) -> None:
        """Return when no job runs or waits."""
        with self._changed:
            self._changed.wait_for(lambda: not self._busy)

    def close(self) -> None:
        """End the threads when their jobs return."""
        self._executor.shutdown(wait=False, cancel_futures=True)

    def _run(self, job: Job, finish: Finish) -> None:
        result = None if job.control.cancelled() else job.run()
        with self._changed:
            successor = self._busy.pop(job.key)
            if successor is not None:
                self._busy[job.key] = None
            # Before anyone who waits may go on, and before the result lets a successor start.
            if result is not None:
                finish(job, result)
            self._changed.notify_all()
        if successor is not None:
            self._executor.submit(self._run, *successor)


class HeldRunner:
    """Runs each job where it is started, and keeps its result until it is told to let it go.

    So a replay admits every result at the place where the journal has it.
    """

    def __init__(self) -> None:
        self._held: dict[Key, tuple[Job, JobResult, Finish]] = {}

    @property
    def held(self) -> list[Key]:
        """Module and job of every result that is kept, oldest first."""
        return list(self._held)

    def start(self, job: Job, finish: Finish) -> None:
        """Do the work and keep the result; that of a cancelled predecessor is dropped."""
        self._held.pop(job.key, None)
        self._held[job.key] = (job, job.run(), finish)

    def release(self, module: str, job: str) -> bool:
        """Inject a result that is kept; False if there is none."""
        if (module, job) not in self._held:
            return False
        held, result, finish = self._held.pop((module, job))
        finish(held, result)
        return True

    def wait(self) -> None:
        """Release every result, oldest first."""
        for module, job in self.held:
            self.release(module, job)

    def close(self) -> None:
        """Drop every result."""
        self._held.clear()
