"""Where inputs from any thread wait for their transaction."""

import threading
from collections import OrderedDict
from typing import Any

from vrut_lite.kernel.messages import Input


class Inbox:
    """First in, first out; an input of equal type and key merges with the one that waits.

    What they make goes to the end: nothing that came between is overtaken by newer news.
    """

    def __init__(self) -> None:
        self._entries: OrderedDict[Any, Input] = OrderedDict()
        self._serial = 0
        self._lock = threading.Lock()

    def put(self, message: Input) -> None:
        """Append, in place of an input of equal type and key that still waits."""
        key = message.key()
        with self._lock:
            if key is None:
                self._serial += 1
                self._entries[self._serial] = message
                return
            place = (type(message), key)
            older = self._entries.pop(place, None)
            self._entries[place] = message if older is None else message.merged(older)

    def take(self) -> Input | None:
        """The first input, or None when none waits."""
        with self._lock:
            return self._entries.popitem(last=False)[1] if self._entries else None

    def __len__(self) -> int:
        return len(self._entries)
