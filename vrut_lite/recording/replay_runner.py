"""Runs the jobs of a replay, each where the journal admitted its result."""

from vrut_lite.kernel.job import Job, Key
from vrut_lite.kernel.jobs import Finish


class ReplayRunner:
    """Keeps each job until `release` runs it and injects its result.

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
        """Do the work of a held job and inject its result; False without such a job."""
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
