"""Sees what a kernel does, in the order it does it, and writes it down as entries."""

from collections.abc import Callable

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.dispatch import HOST
from vrut_lite.kernel.messages import Input, Message
from vrut_lite.kernel.recording.codec import digest_of, to_plain
from vrut_lite.kernel.recording.entry import Entry, Kind

See = Callable[[Kind, Message, str], None]


class Observer:
    """Calls `see(kind, message, sender)` for each admitted input and each of its consequences."""

    def __init__(self, kernel: Kernel, see: See):
        self._see: See | None = see
        kernel.watch_admission(self._admitted)
        kernel.tap(self._delivered)

    def close(self) -> None:
        """See nothing more."""
        self._see = None

    def _admitted(self, message: Input) -> None:
        if self._see is not None:
            self._see("input", message, HOST)

    def _delivered(self, message: Message, sender: str) -> None:
        if self._see is not None and not isinstance(message, Input):
            self._see("derived", message, sender)


def entry_of(kind: Kind, message: Message, sender: str) -> Entry:
    """The entry of a message; UserError if it has no plain form."""
    name = type(message).__name__
    try:
        plain = to_plain(message)
        digest = digest_of(name, plain)
    except (UserError, RecursionError, ValueError) as error:
        raise UserError(f"a {name} of {sender} cannot be written down: {error}") from None
    return Entry(kind=kind, type_name=name, sender=sender, digest=digest, message=plain)
