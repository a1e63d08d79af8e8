"""Causes and durations of deliveries: the only place that keeps wall time."""

import time
from collections import deque
from typing import NamedTuple

SLOW_NS = 16_000_000
_ENTRIES = 16_384
_REMARKS = 1_024


class TraceEntry(NamedTuple):
    """One message delivered to one receiver.

    `sequence` numbers the messages of a kernel; `cause` is the number of the message in whose
    handler this one was posted, 0 for an input. The receiver is "host" where the kernel itself
    acts and empty without a listener. Times are those of `time.perf_counter_ns`.
    """

    sequence: int
    cause: int
    sender: str
    type: str
    receiver: str
    start_ns: int
    end_ns: int


class Remark(NamedTuple):
    """A slow handler, a job's run, or a job's progress."""

    kind: str
    module: str
    text: str
    start_ns: int
    end_ns: int


class Trace:
    """Two rings: deliveries, and remarks, which deliveries must not push out.

    Deliveries are kept as bare tuples, in the order of `TraceEntry`: they are on the fast path.
    """

    def __init__(self) -> None:
        self.deliveries: deque[tuple[int, int, str, str, str, int, int]] = deque(maxlen=_ENTRIES)
        self._remarks: deque[Remark] = deque(maxlen=_REMARKS)

    def remark(self, kind: str, module: str, text: str, start_ns: int | None = None) -> None:
        """Note something that ends now and began at `start_ns` or now; from any thread."""
        end_ns = time.perf_counter_ns()
        self._remarks.append(
            Remark(kind, module, text, end_ns if start_ns is None else start_ns, end_ns)
        )

    def slow(self, module: str, handler: str, start_ns: int, end_ns: int) -> None:
        """Name a handler that held all others up."""
        text = f"{handler} took {(end_ns - start_ns) / 1e6:.1f} ms"
        self._remarks.append(Remark("slow handler", module, text, start_ns, end_ns))

    def entries(self) -> list[TraceEntry]:
        """The latest deliveries, oldest first."""
        return [TraceEntry(*delivery) for delivery in self.deliveries.copy()]

    def remarks(self) -> list[Remark]:
        """The latest remarks, oldest first."""
        return list(self._remarks.copy())
