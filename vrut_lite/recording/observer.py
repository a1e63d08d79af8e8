"""Observes a kernel's messages in order and makes entries of them."""

from collections.abc import Callable

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.dispatch import HOST
from vrut_lite.kernel.job_scheduler import JOBS
from vrut_lite.kernel.messages import Input, JobResult, Message
from vrut_lite.message_codec import digest_of, to_plain
from vrut_lite.recording.entry import Entry, Kind

See = Callable[[Kind, Message, str], None]


class Observer:
    """Calls `see(kind, message, sender)` for each admitted input and each of its consequences.

    The sender of an input is `JOBS` if a job of the kernel's own brought it, else `HOST`.
    """

    def __init__(self, kernel: Kernel, see: See):
        self._see: See | None = see
        self._jobs = kernel.jobs
        self._seats = kernel.seats
        self._modules = len(kernel.seats)
        kernel.watch_admission(self._admitted)
        kernel.tap(self._delivered)

    def check_modules(self) -> None:
        """Raise UserError if a module was added since: a journal does not tell of it."""
        for name in list(self._seats)[self._modules :]:
            raise UserError(f"the module {name} was added after the recording began")

    def close(self) -> None:
        """Stop observing."""
        self._see = None

    def _admitted(self, message: Input) -> None:
        if self._see is not None:
            self._see("input", message, JOBS if self._jobs.is_own(message) else HOST)

    def _delivered(self, message: Message, sender: str) -> None:
        if self._see is not None and not isinstance(message, Input):
            self._see("derived", message, sender)


def entry_of(kind: Kind, message: Message, sender: str) -> Entry:
    """The entry of a message; UserError if it has no plain form.

    The trace of remote work is part of it, since it decides whether there is a Fault.
    """
    name = type(message).__name__
    try:
        plain = to_plain(message)
        if isinstance(message, JobResult) and sender == HOST and message.trace:
            plain["trace"] = message.trace
        digest = digest_of(name, plain)
    except (UserError, RecursionError, ValueError) as error:
        raise UserError(f"a {name} of {sender} cannot be written down: {error}") from None
    return Entry(kind=kind, type_name=name, sender=sender, digest=digest, message=plain)
