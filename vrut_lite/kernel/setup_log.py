"""The set-up of a kernel as a list of steps, so that a replay can repeat it.

Fault counts, post limits, remembered messages and a module's state depend on every step and on the
order of the steps; they cannot be derived from a list of final values.
"""

from typing import NamedTuple

from vrut_lite.kernel.job_scheduler import JobScheduler
from vrut_lite.kernel.messages import (
    ChooseSlot,
    Demand,
    EnableModule,
    Input,
    JobResult,
    ReloadModule,
    RestartModule,
    SetSetting,
)

SETTING_UP = (SetSetting, EnableModule, RestartModule, ReloadModule, ChooseSlot, Demand)
MOST_STEPS = 10_000


def sets_up(kind: type[Input]) -> bool:
    """Whether inputs of this type belong to a kernel's set-up."""
    return kind in SETTING_UP or kind.sets_up


class Step(NamedTuple):
    """An added module or an input; without both, a delivery of all queued messages."""

    module: str = ""
    input: Input | None = None


class SetupLog:
    """The steps so far, until an input ends it: `ended_by` is the sentence that says which."""

    def __init__(self, jobs: JobScheduler) -> None:
        self.steps: list[Step] = []
        self.ended_by = ""
        self._jobs = jobs

    def note(self, step: Step) -> None:
        """Store a step; of a job's result only the module and job names."""
        if self.ended_by:
            return
        message = step.input
        if isinstance(message, JobResult) and self._jobs.is_own(message):
            step = Step(input=JobResult(module=message.module, job=message.job))
        elif message is not None and not sets_up(type(message)):
            self._end(f"a {type(message).__name__} has been admitted")
            return
        if len(self.steps) >= MOST_STEPS:
            self._end(f"more than {MOST_STEPS} settings and choices have been admitted")
            return
        self.steps.append(step)

    def _end(self, reason: str) -> None:
        self.steps, self.ended_by = [], reason
