"""Storage buffers of GPU jobs and backgrounds; those of the last one of a name are reused."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from vrut_lite.array import Array

# A program's: pairs of a binding and the content.
Buffers = tuple[tuple[int, Array], ...]
# By the program's number in the job and the binding. Shared buffers have their
# number of float32 as content, and the program's number _ALL.
_Sent = dict[tuple[int, int], tuple[Array | int, Any]]
_ALL, _FLOAT_BYTES = -1, 4


class JobBuffers:
    """Keeps the buffers of the last programs of each name; on the GL thread only."""

    def __init__(self) -> None:
        self._sent: dict[str, _Sent] = {}

    def send(
        self,
        context: Any,
        name: str,
        programs: Sequence[Buffers],
        shared: Sequence[tuple[int, int]] = (),
    ) -> int:
        """Upload the buffers of programs, and make those that they share.

        Returns how many were there already.
        """
        before, now = self._sent.pop(name, {}), _Sent()
        # All buffers stay listed, also where making the next one fails.
        self._sent[name] = now
        try:
            return _send_all(context, programs, shared, before, now)
        finally:
            _free(before)

    def bind(self, name: str, number: int) -> None:
        """Bind the buffers of the program of that number."""
        # Shared ones first: a program may have another buffer at their binding.
        for (program, binding), (_, buffer) in sorted(self._sent[name].items(), key=_place):
            if program in (number, _ALL):
                buffer.bind_to_storage_buffer(binding)

    def release(self) -> None:
        """Free all buffers."""
        for sent in self._sent.values():
            _free(sent)
        self._sent.clear()


def _send_all(
    context: Any,
    programs: Sequence[Buffers],
    shared: Sequence[tuple[int, int]],
    before: _Sent,
    now: _Sent,
) -> int:
    kept = 0
    for number, buffers in enumerate(programs):
        for binding, content in buffers:
            place = number, binding
            # Compared by identity: comparing contents might take longer than the upload.
            if place in before and before[place][0] is content:
                now[place] = before.pop(place)
                kept += 1
            else:
                now[place] = content, _buffer(context, content)
    for binding, count in shared:
        place = _ALL, binding
        if place in before and before[place][0] == count:
            now[place] = before.pop(place)
        else:
            now[place] = count, context.buffer(reserve=_FLOAT_BYTES * count)
    return kept


def _free(sent: _Sent) -> None:
    for _, buffer in sent.values():
        buffer.release()


def _place(sent: tuple[tuple[int, int], Any]) -> tuple[int, int]:
    return sent[0]


def _buffer(context: Any, content: Array) -> Any:
    return context.buffer(np.ascontiguousarray(content.values, dtype=np.float32).tobytes())
