"""Storage buffers of GPU jobs; those of the last job of the same name are reused."""

from typing import Any

import numpy as np

from vrut_lite.array import Array
from vrut_lite.messages.gpu_job import GpuJob

# By the program's number in the job and the binding. Shared buffers have their
# number of float32 as content, and the program's number _ALL.
_Sent = dict[tuple[int, int], tuple[Array | int, Any]]
_ALL, _FLOAT_BYTES = -1, 4


class JobBuffers:
    """Keeps the buffers of the last job of each name; on the GL thread only."""

    def __init__(self) -> None:
        self._sent: dict[str, _Sent] = {}

    def send(self, context: Any, job: GpuJob) -> int:
        """Upload a job's buffers; returns how many of them were there already."""
        before, now = self._sent.pop(job.key(), {}), _Sent()
        # All buffers stay listed, also where making the next one fails.
        self._sent[job.key()] = now
        try:
            return self._send_all(context, job, before, now)
        finally:
            for _, buffer in before.values():
                buffer.release()

    def bind(self, job: GpuJob, number: int) -> None:
        """Bind the buffers of the job's program of that number."""
        # Shared ones first: a program may have another buffer at their binding.
        for (program, binding), (_, buffer) in sorted(self._sent[job.key()].items(), key=_place):
            if program in (number, _ALL):
                buffer.bind_to_storage_buffer(binding)

    def _send_all(self, context: Any, job: GpuJob, before: _Sent, now: _Sent) -> int:
        kept = 0
        for number, program in enumerate(job.programs):
            for binding, content in program.buffers:
                place = number, binding
                # Compared by identity: comparing contents might take longer than the upload.
                if place in before and before[place][0] is content:
                    now[place] = before.pop(place)
                    kept += 1
                else:
                    now[place] = content, _buffer(context, content)
        for binding, count in job.shared:
            place = _ALL, binding
            if place in before and before[place][0] == count:
                now[place] = before.pop(place)
            else:
                now[place] = count, context.buffer(reserve=_FLOAT_BYTES * count)
        return kept


def _place(sent: tuple[tuple[int, int], Any]) -> tuple[int, int]:
    return sent[0]


def _buffer(context: Any, content: Array) -> Any:
    return context.buffer(np.ascontiguousarray(content.values, dtype=np.float32).tobytes())
