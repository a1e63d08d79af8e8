"""A background job: a plain function of its arguments, run once, somewhere else."""

import inspect
import threading
import time
from collections.abc import Callable
from typing import Any

from vrut_lite.foreign_errors import described
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.contract import refuse_unrun
from vrut_lite.kernel.messages import JobResult
from vrut_lite.kernel.module import Role
from vrut_lite.kernel.trace import Trace

Key = tuple[str, str]
Work = Callable[..., Any]
# Longest progress text (characters); the trace keeps a thousand of them.
_LONGEST_PROGRESS = 200


class JobControl:
    """Progress and cancellation of work, passed to its parameter `control` if it has one."""

    def __init__(self, tell: Callable[[str], None]):
        self._tell = tell
        self._cancelled = threading.Event()

    def progress(self, fraction: float, text: str = "") -> None:
        """Say how far the work is, from 0 to 1; shown in the trace, heard by no module."""
        self._tell(f"{fraction:.0%} {text}"[:_LONGEST_PROGRESS].rstrip())

    def cancelled(self) -> bool:
        """Whether the result is no longer wanted."""
        return self._cancelled.is_set()

    def cancel(self) -> None:
        """Let `cancelled` answer yes."""
        self._cancelled.set()


class Job:
    """One start of a module's work, under the module's name and the job's.

    Attributes:
        role: role of the result in its revision.
        revision: the revision that started it; 0 without one.
    """

    def __init__(
        self,
        key: Key,
        work: Work,
        arguments: tuple[Any, ...],
        trace: Trace,
        role: Role = "aside",
        revision: int = 0,
    ):
        self.key = key
        self.role: Role = role
        self.revision = revision
        module, name = key
        self.control = JobControl(lambda text: trace.remark("progress", module, f"{name}: {text}"))
        self._work = work
        self._arguments = arguments
        self._trace = trace

    def run(self) -> JobResult:
        """Do the work; an exception becomes a result with an error."""
        module, name = self.key
        start_ns = time.perf_counter_ns()
        try:
            options = {"control": self.control} if _takes_control(self._work) else {}
            value = self._work(*self._arguments, **options)
            refuse_unrun(value)
            outcome = {"value": value}
        except BaseException as error:
            pass_interrupt(error)
            outcome = described(error)
        self._trace.remark("job", module, name, start_ns)
        return JobResult(module=module, job=name, **outcome)


def _takes_control(work: Work) -> bool:
    try:
        return "control" in inspect.signature(work).parameters
    except ValueError:  # A builtin without a signature.
        return False
