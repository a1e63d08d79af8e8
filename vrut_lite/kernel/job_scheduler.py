"""Which background job runs and which waits, and which of them a revision awaits.

Both change only in transactions, so that a replay finds them the same: a result frees its
place when it is admitted, not when the work happens to end.
"""

from collections.abc import Callable
from typing import Any

from vrut_lite.kernel.job import Job, Key, Work
from vrut_lite.kernel.jobs import JobRunner
from vrut_lite.kernel.messages import Input, JobResult
from vrut_lite.kernel.module import Role
from vrut_lite.kernel.trace import Trace

# Sender of the results of the kernel's own jobs; the host sends all other results.
JOBS = "jobs"


class JobScheduler:
    """One running and one pending job for each module and name; the latest pending wins.

    `revision` is that of the running transaction: of its input, of the job whose result it
    delivers, or 0. An awaited job that a transaction without a revision starts refines instead. A
    result that a draft replaced belongs to the `latest` revision, which awaits its consequences.
    """

    def __init__(self, runner: JobRunner, inject: Callable[[Input], None], trace: Trace):
        self.revision = self.latest = 0
        self._runner = runner
        self._inject = inject
        self._trace = trace
        self._running: dict[Key, Job] = {}
        self._pending: dict[Key, Job] = {}
        self._sent: dict[int, Job] = {}
        # Revisions of results that come from outside, as a GPU's do.
        self._outside: dict[Key, int] = {}
        self._own: int | None = None

    @property
    def busy(self) -> bool:
        """Whether a module waits for a result."""
        return bool(self._running)

    def runs(self, module: str) -> bool:
        """Whether this module waits for a result."""
        return any(key[0] == module for key in self._running)

    def modules(self, *roles: Role) -> tuple[str, ...]:
        """Names of the modules whose jobs have one of these roles, running or pending."""
        jobs = (*self._running.values(), *self._pending.values())
        found = [job.key[0] for job in jobs if job.role in roles]
        if "awaited" in roles:
            found += [module for module, _ in self._outside]
        return tuple(dict.fromkeys(found))

    @property
    def awaited(self) -> bool:
        """Whether a revision lacks a result."""
        return bool(self._outside) or any(
            job.role == "awaited"
            for jobs in (self._running, self._pending)
            for job in jobs.values()
        )

    def await_no_longer(self) -> None:
        """Let drafts serve in place of all results that are awaited."""
        self._outside.clear()
        for jobs in (self._running, self._pending):
            for job in jobs.values():
                if job.role == "awaited":
                    job.role, job.revision = "drafted", 0

    def await_from_outside(self, key: Key) -> None:
        """Let this revision await a result that no job of the kernel brings."""
        if self.revision:
            self._outside[key] = self.revision

    def start(self, key: Key, work: Work, arguments: tuple[Any, ...], role: Role = "aside") -> None:
        """Run the work now, or after the running job of this key."""
        if role == "awaited" and not self.revision:
            role = "refines"
        job = Job(key, work, arguments, self._trace, role, self.revision)
        if key in self._running:
            older = self._pending.get(key)
            if older is not None and older.role == "awaited":
                # The older job's revision now awaits this one.
                job.role, job.revision = "awaited", max(job.revision, older.revision)
            self._pending[key] = job
        else:
            self._run(job)

    def cancel(self, key: Key) -> None:
        """Drop the waiting job and the result of the running one."""
        self._outside.pop(key, None)
        self._pending.pop(key, None)
        running = self._running.pop(key, None)
        if running is not None:
            running.control.cancel()

    def cancel_all(self, module: str | None = None) -> None:
        """Cancel every job, of one module or of all."""
        for key in [key for key in (*self._running, *self._outside) if module in (None, key[0])]:
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
        if sent is None:
            self.revision = self._outside.pop(key, 0)
        else:
            self.revision = self.latest if sent.role == "drafted" else sent.revision
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
