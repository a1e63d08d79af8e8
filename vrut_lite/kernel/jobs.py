"""Where background jobs run: on threads when live; in a replay where the journal says so."""

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
        """Return when every job that was started has finished or was cancelled."""

    def close(self) -> None:
        """Start nothing more."""


class ThreadRunner:
    """Runs jobs on a few threads, one at a time of each key.

    A cancelled job cannot be torn from its thread: its successor waits until it returns.
    """

    def __init__(self) -> None:
        self._executor = ThreadPoolExecutor(_WORKERS, "vrut-lite job")
        self._busy: dict[Key, Job] = {}
        self._waiting: dict[Key, tuple[Job, Finish]] = {}
        self._changed = threading.Condition()

    def start(self, job: Job, finish: Finish) -> None:
        """Hand the job to a thread, or let it wait for a cancelled one of its key."""
        with self._changed:
            if job.key in self._busy:
                self._waiting[job.key] = (job, finish)
                return
            self._busy[job.key] = job
        self._executor.submit(self._run, job, finish)

    def wait(self) -> None:
        """Return when no job runs or waits, but for those that were cancelled."""
        with self._changed:
            self._changed.wait_for(self._is_idle)

    def close(self) -> None:
        """End the threads when their jobs return."""
        self._executor.shutdown(wait=False, cancel_futures=True)

    def _is_idle(self) -> bool:
        jobs = [*self._busy.values(), *(job for job, _ in self._waiting.values())]
        return all(job.control.cancelled() for job in jobs)

    def _run(self, job: Job, finish: Finish) -> None:
        result = None if job.control.cancelled() else job.run()
        with self._changed:
            del self._busy[job.key]
            successor = self._waiting.pop(job.key, None)
            if successor is not None:
                self._busy[job.key] = successor[0]
            # Before anyone who waits may go on, and before the result lets a successor start.
            if result is not None:
                finish(job, result)
            self._changed.notify_all()
        if successor is not None:
            self._executor.submit(self._run, *successor)


class HeldRunner:
    """Keeps each job until it is told to do the work and bring the result.

    So a replay admits every result at the place where the journal has it. Work whose result the
    journal does not have is never done: it may have run until it was cancelled.
    """

    def __init__(self) -> None:
        self._held: dict[Key, tuple[Job, Finish]] = {}

    @property
    def held(self) -> list[Key]:
        """Module and name of every job that is kept, oldest first."""
        return [key for key, (job, _) in self._held.items() if not job.control.cancelled()]

    def start(self, job: Job, finish: Finish) -> None:
        """Keep the job; those that were cancelled are forgotten, and their arguments with them."""
        self._held = {key: self._held[key] for key in self.held if key != job.key}
        self._held[job.key] = (job, finish)

    def release(self, module: str, job: str) -> bool:
        """Do the work of a job that is kept and inject its result; False if there is none."""
        if (module, job) not in self.held:
            return False
        held, finish = self._held.pop((module, job))
        finish(held, held.run())
        return True

    def wait(self) -> None:
        """Release every job, oldest first."""
        for module, job in self.held:
            self.release(module, job)

    def close(self) -> None:
        """Drop every job."""
        self._held.clear()
