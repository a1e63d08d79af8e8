"""A queue in which of equal entries only the latest waits."""

from typing import Any, Generic, TypeVar

T = TypeVar("T")


class Outbox(Generic[T]):
    """First in, first out; an entry of equal type, sender and key replaces the one that waits.

    The replacement goes to the end: nothing that came between is overtaken by newer news.
    A key of None never coalesces.
    """

    def __init__(self) -> None:
        self._entries: dict[Any, T] = {}
        self._serial = 0
        self.coalesced = 0

    def put(self, entry: T, kind: type, sender: str, key: str | None) -> None:
        """Append, dropping an entry of equal kind, sender and key that still waits."""
        self._serial += 1
        place = (kind, sender, self._serial if key is None else key)
        if self._entries.pop(place, None) is not None:
            self.coalesced += 1
        self._entries[place] = entry

    def take(self) -> T | None:
        """The first entry, or None when none waits."""
        if not self._entries:
            return None
        return self._entries.pop(next(iter(self._entries)))

    def __len__(self) -> int:
        return len(self._entries)
