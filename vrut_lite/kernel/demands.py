"""The demands of consumers: message type, size and encoding."""

from collections.abc import Callable, Sequence
from typing import get_args

from vrut_lite.kernel.messages import Demand, Encoding

_PRECEDENCE = get_args(Encoding)


class Demands:
    """The demands of all consumers, merged by type of message."""

    def __init__(self, is_stopped: Callable[[str], bool]):
        self._is_stopped = is_stopped
        self._of: dict[str, dict[str, Demand]] = {}
        self.merged: dict[str, Demand] = {}

    def note(self, demand: Demand) -> None:
        """Store a valid demand, or remove it at size 0."""
        consumers = self._of.setdefault(demand.message, {})
        before = consumers.pop(demand.consumer, None)
        if demand.size != 0:
            consumers[demand.consumer] = demand
        merged = self.merged.get(demand.message)
        if before is None and merged is not None:
            # The demands of the other consumers are merged already.
            if demand.size != 0 and not self._is_stopped(demand.consumer):
                self.merged[demand.message] = _of_all([merged, demand])
        else:
            self._merge(demand.message)

    def of_consumer(self, consumer: str) -> list[Demand]:
        """The demands of one consumer."""
        return [wishes[consumer] for wishes in self._of.values() if consumer in wishes]

    def every(self) -> list[Demand]:
        """All demands, in an order in which a fresh kernel accepts them."""
        return [wish for wishes in self._of.values() for wish in wishes.values()]

    def refresh(self) -> None:
        """Merge all demands again, after a consumer has started or stopped."""
        for message in self._of:
            self._merge(message)

    def _merge(self, message: str) -> None:
        wishes = [w for w in self._of[message].values() if not self._is_stopped(w.consumer)]
        if not wishes:
            self.merged.pop(message, None)
            return
        self.merged[message] = _of_all(wishes)


def _of_all(wishes: Sequence[Demand]) -> Demand:
    """One demand that serves all of these demands for one message type."""
    return Demand(
        consumer=", ".join(wish.consumer for wish in wishes),
        message=wishes[0].message,
        size=max((wish.size for wish in wishes if wish.size is not None), default=None),
        encoding=max((wish.encoding for wish in wishes), key=_PRECEDENCE.index),
    )
