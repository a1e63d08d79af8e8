"""Storage buffers of GPU jobs; those of the last job of the same name are reused."""

from typing import Any

import numpy as np

from vrut_lite.array import Array
from vrut_lite.messages.gpu_job import GpuJob

_Sent = dict[int, tuple[Array, Any]]


class JobBuffers:
    """Keeps the buffers of the last job of each name; on the GL thread only."""

    def __init__(self) -> None:
        self._sent: dict[str, _Sent] = {}

    def bind(self, context: Any, job: GpuJob) -> int:
        """Bind a job's buffers; returns how many of them were reused."""
        before, now = self._sent.pop(job.key(), {}), _Sent()
        # All buffers stay listed, also where making the next one fails.
        self._sent[job.key()] = now
        try:
            return self._bind_all(context, job, before, now)
        finally:
            for _, buffer in before.values():
                buffer.release()

    def _bind_all(self, context: Any, job: GpuJob, before: _Sent, now: _Sent) -> int:
        kept = 0
        for binding, content in job.buffers:
            # Compared by identity: comparing contents might take longer than the upload.
            if binding in before and before[binding][0] is content:
                now[binding] = before.pop(binding)
                kept += 1
            else:
                now[binding] = content, _buffer(context, content)
            now[binding][1].bind_to_storage_buffer(binding)
        return kept


def _buffer(context: Any, content: Array) -> Any:
    return context.buffer(np.ascontiguousarray(content.values, dtype=np.float32).tobytes())
