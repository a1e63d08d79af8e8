"""One revision after the other: the next begins when the present one is whole, or a draft is.

A revision holds the consequences of one gesture: the new hour, its sky, clouds and light. It is
shown when all of them are there. A draft stands in for work that takes longer than the deadline, so
that pictures never starve; the result is shown when it comes.
"""

from collections import deque
from collections.abc import Callable
from time import perf_counter

import numpy as np

from vrut_lite.kernel.bus import Kernel

# Time from the kernel's handlers of a gesture to a draft in place of awaited results.
DEADLINE_S = 0.25
# Revisions in the profiler's figures.
_REMEMBERED = 200
_MEMORY = 0.5


class RevisionGate:
    """Pumps a kernel, revision by revision; used on one thread.

    Attributes:
        due_s: when a draft completes the present revision; None while nothing is awaited.
        usual_s: how long a revision took lately to become whole, its handlers included.
    """

    def __init__(self, deadline_s: float = DEADLINE_S, now_s: Callable[[], float] = perf_counter):
        self.due_s: float | None = None
        self.usual_s = 0.0
        self._deadline_s = deadline_s
        self._now_s = now_s
        self._began_s = 0.0
        self._revision = 0
        self._seconds: deque[float] = deque(maxlen=_REMEMBERED)

    def pump(self, kernel: Kernel, may_begin: bool = True) -> None:
        """Admit what waits now, up to where a revision awaits results.

        The next one begins only if it `may`, and in a call that finds the present one whole: that
        must be drawn first.
        """
        self._begin(kernel)
        most = kernel.waiting
        may_begin = may_begin and kernel.is_whole
        while most and (may_begin or kernel.goes_on):
            most -= 1
            kernel.pump(most=1, within=not may_begin)
            may_begin = may_begin and kernel.is_whole
        self._end(kernel)

    def pump_all(self, kernel: Kernel) -> None:
        """Admit everything that waits now, into one revision."""
        self._begin(kernel)
        kernel.pump(most=kernel.waiting)
        self._end(kernel)

    def percentile_s(self, percent: float) -> float:
        """A percentile of the times from the admission of a gesture to its whole state or draft."""
        return float(np.percentile(self._seconds, percent)) if self._seconds else 0.0

    def _begin(self, kernel: Kernel) -> None:
        """Remember when the next revision began."""
        if self._revision == kernel.revision:
            self._began_s = self._now_s()

    def _end(self, kernel: Kernel) -> None:
        """Let drafts serve where the revision is overdue; note how long one took that is whole."""
        now_s = self._now_s()
        if not kernel.is_whole:
            if self.due_s is None:
                self.due_s = now_s + self._deadline_s
            if now_s < self.due_s:
                return
            kernel.jobs.await_no_longer()
        self.due_s = None
        if self._revision != kernel.revision:
            self._revision = kernel.revision
            self._seconds.append(now_s - self._began_s)
            self.usual_s += _MEMORY * (self._seconds[-1] - self.usual_s)
