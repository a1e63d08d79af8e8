"""Where inputs from any thread wait for their transaction."""

import threading
from collections import OrderedDict
from typing import Any

from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.messages import Input


class Inbox:
    """First in, first out; an input of equal type and key merges with the one that waits.

    The merged input goes to the end, so that it overtakes no input that came between. Of
    inputs of one timeline (the clock's) only neighbours merge: time that went by at one speed
    must not be counted at another.
    """

    def __init__(self) -> None:
        self._entries: OrderedDict[Any, Input] = OrderedDict()
        self._serial = 0
        self._last_of_timeline: dict[str, Any] = {}
        self._lock = threading.Lock()

    def put(self, message: Input) -> None:
        """Append, in place of an input of equal type and key that still waits."""
        try:
            message.check()
            key = message.key()
            hash(key)
        # It will be refused, so that it must not merge with a waiting input.
        except BaseException as error:
            pass_interrupt(error)
            key = None
        with self._lock:
            if key is None:
                self._serial += 1
                self._entries[self._serial] = message
                return
            place: Any = (type(message), key)
            if message.timeline is not None:
                place = self._place_in_timeline(message.timeline, place)
            older = self._entries.pop(place, None)
            self._entries[place] = message if older is None else message.merged(older)

    def _place_in_timeline(self, timeline: str, place: Any) -> Any:
        """The place of the timeline's last input, if that is of this kind, or a new one."""
        last = self._last_of_timeline.get(timeline)
        if last is None or last[0] != place:
            self._serial += 1
            last = (place, self._serial)
            self._last_of_timeline[timeline] = last
        return last

    def take(self) -> Input | None:
        """The first input, or None when none waits."""
        with self._lock:
            return self._entries.popitem(last=False)[1] if self._entries else None

    def __len__(self) -> int:
        return len(self._entries)
