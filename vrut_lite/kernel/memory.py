"""The last message of each type, sender and key: for late joiners, and for `last`."""

from collections.abc import Iterable

from vrut_lite.kernel.messages import Message

Place = tuple[type[Message], str, str]


class Memory:
    """The messages delivered last; those without a key are not remembered."""

    def __init__(self) -> None:
        self._kept: dict[Place, tuple[int, Message]] = {}
        self.latest: dict[type[Message], Message] = {}

    def keep(self, place: Place, sequence: int, message: Message) -> None:
        """Remember a message by its place; later ones have higher sequence numbers."""
        self._kept[place] = (sequence, message)
        self.latest[place[0]] = message

    def recall(self, types: Iterable[type[Message]]) -> list[tuple[Message, str]]:
        """The remembered messages of these types with their senders, oldest first."""
        wanted = set(types)
        found = [(*entry, place[1]) for place, entry in self._kept.items() if place[0] in wanted]
        return [(message, sender) for _, message, sender in sorted(found, key=lambda e: e[0])]

    def kinds_of(self, sender: str) -> set[type[Message]]:
        """Types of which a message of this sender is remembered."""
        return {place[0] for place in self._kept if place[1] == sender}

    def keep_only(self, slot: str, holder: str) -> None:
        """Forget messages of a slot that others than the holder posted."""
        self._forget(
            place
            for place in self._kept
            if getattr(place[0], "slot", None) == slot and place[1] != holder
        )

    def forget_types_of(self, package: str) -> None:
        """Forget all messages whose types a top-level package defines."""
        self._forget(
            place for place in self._kept if place[0].__module__.partition(".")[0] == package
        )

    def _forget(self, places: Iterable[Place]) -> None:
        places = tuple(places)
        for place in places:
            del self._kept[place]
        types = {place[0] for place in places}
        for kind in types:
            del self.latest[kind]
        for message, _ in self.recall(types):
            self.latest[type(message)] = message
