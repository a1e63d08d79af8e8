"""Which background job runs and which waits.

Both change only in transactions, so that a replay finds them the same: a result frees its
place when it is admitted, not when the work happens to end.
"""

from collections.abc import Callable
from typing import Any

from vrut_lite.kernel.job import Job, Key, Work
from vrut_lite.kernel.jobs import JobRunner
from vrut_lite.kernel.messages import Input, JobResult
from vrut_lite.kernel.trace import Trace

# Sender of the results of the kernel's own jobs; the host sends all other results.
JOBS = "jobs"


class JobDesk:
    """One running and one pending job for each module and name; the latest pending wins."""

    def __init__(self, runner: JobRunner, inject: Callable[[Input], None], trace: Trace):
        self._runner = runner
        self._inject = inject
        self._trace = trace
        self._running: dict[Key, Job] = {}
        self._pending: dict[Key, Job] = {}
        self._sent: dict[int, Job] = {}
        self._own: int | None = None

    @property
    def busy(self) -> bool:
        """Whether a module waits for a result."""
        return bool(self._running)

    def runs(self, module: str) -> bool:
        """Whether this module waits for a result."""
        return any(key[0] == module for key in self._running)

    def start(self, key: Key, work: Work, arguments: tuple[Any, ...]) -> None:
        """Run the work now, or when the job of this key that runs is done."""
        job = Job(key, work, arguments, self._trace)
        if key in self._running:
            self._pending[key] = job
        else:
            self._run(job)

    def cancel(self, key: Key) -> None:
        """Drop what waits, and the result of what runs."""
        self._pending.pop(key, None)
        running = self._running.pop(key, None)
        if running is not None:
            running.control.cancel()

    def cancel_all(self, module: str | None = None) -> None:
        """Cancel every job, of one module or of all."""
        for key in [key for key in self._running if module in (None, key[0])]:
            self.cancel(key)

    def admit(self, result: JobResult) -> bool:
        """Whether a result is still wanted; if so, start the pending job.

        A result that comes from elsewhere (the owner of the GPU, a test) is always let in, and
        replaces the result of the running job of its name, which is dropped.
        """
        key = (result.module, result.job)
        running = self._running.get(key)
        sent = self._sent.pop(id(result), None)
        if sent is not None and sent is not running:
            return False
        self._own = None if sent is None else id(result)
        if running is not None:
            del self._running[key]
            running.control.cancel()
        if key in self._pending:
            self._run(self._pending.pop(key))
        return True

    def is_own(self, message: Input) -> bool:
        """Whether the last admitted input is the result of a job of this kernel."""
        return isinstance(message, JobResult) and id(message) == self._own

    def _run(self, job: Job) -> None:
        self._runner.start(job, self._finish)
        self._running[job.key] = job

    def _finish(self, job: Job, result: JobResult) -> None:
        """Inject a result, from any thread; the inbox keeps it until it is admitted."""
        self._sent[id(result)] = job
        self._inject(result)
