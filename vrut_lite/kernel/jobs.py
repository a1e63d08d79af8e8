"""Runners of background jobs, on a few threads."""

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol

from vrut_lite.kernel.job import Job, Key
from vrut_lite.kernel.messages import JobResult

Finish = Callable[[Job, JobResult], None]
WORKERS = 4


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
        self._executor = ThreadPoolExecutor(WORKERS, "vrut-lite job")
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
        self._submit(job, finish)

    def _submit(self, job: Job, finish: Finish) -> None:
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
            # Before waiting threads go on, and before the result lets a successor start.
            if result is not None:
                finish(job, result)
            self._changed.notify_all()
        if successor is not None:
            self._submit(*successor)
