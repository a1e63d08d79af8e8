"""Where inputs from any thread wait for their transaction."""

import threading
from collections import OrderedDict
from typing import Any

from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.messages import Input, JobResult

# An input and the number of its group: inputs that were put together.
Entry = tuple[Input, int]


class Inbox:
    """First in, first out; an input of equal type and key merges with the one that waits.

    The merged input goes to the end, so that it overtakes no input that came between. Of
    inputs of one timeline (the clock's) only neighbours merge: time that went by at one speed
    must not be counted at another.
    """

    def __init__(self) -> None:
        self._entries: OrderedDict[Any, Entry] = OrderedDict()
        self._serial = 0
        self._group = 0
        self._last_of_timeline: dict[str, Any] = {}
        self._lock = threading.Lock()

    def put(self, *messages: Input) -> None:
        """Append a group, each input in place of one of equal type and key that still waits."""
        # Keys are a module's code: they are asked for outside the lock.
        keyed = [(message, _key_of(message)) for message in messages]
        with self._lock:
            self._group += 1
            for message, key in keyed:
                if key is None:
                    self._serial += 1
                    self._entries[self._serial] = (message, self._group)
                    continue
                place: Any = (type(message), key)
                if message.timeline is not None:
                    place = self._place_in_timeline(message.timeline, place)
                older = self._entries.pop(place, None)
                merged = message if older is None else message.merged(older[0])
                self._entries[place] = (merged, self._group)

    def _place_in_timeline(self, timeline: str, place: Any) -> Any:
        """The place of the timeline's last input, if that is of this kind, or a new one."""
        last = self._last_of_timeline.get(timeline)
        if last is None or last[0] != place:
            self._serial += 1
            last = (place, self._serial)
            self._last_of_timeline[timeline] = last
        return last

    def take(self) -> Entry | None:
        """The first input, or None when none waits."""
        with self._lock:
            return self._entries.popitem(last=False)[1] if self._entries else None

    def take_within(self, group: int) -> Entry | None:
        """The first input that begins no revision, but for inputs of a group; or None.

        A job's result overtakes all inputs, and the others all but a barrier.
        """
        with self._lock:
            place = self._first_within(group)
            return None if place is None else self._entries.pop(place)

    def has_within(self, group: int) -> bool:
        """Whether `take_within` would find an input."""
        with self._lock:
            return self._first_within(group) is not None

    def _first_within(self, group: int) -> Any:
        barred = False
        for place, (message, its_group) in self._entries.items():
            if isinstance(message, JobResult):
                return place
            if not barred and (its_group == group or not message.revises):
                return place
            barred = barred or message.is_barrier
        return None

    def __len__(self) -> int:
        return len(self._entries)


def _key_of(message: Input) -> Any:
    """A checked input's key; None for one that will be refused, which merges with none."""
    try:
        message.check()
        key = message.key()
        hash(key)
    except BaseException as error:
        pass_interrupt(error)
        return None
    return key
