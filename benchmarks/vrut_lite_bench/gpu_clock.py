"""Time and bandwidth of whatever OpenGL there is, by a clock that can be trusted there."""

import time
from collections.abc import Callable
from typing import Any, NamedTuple

# A card at rest runs slowly at first: so long at least, and so many rounds.
WARM_S = 0.3
ROUNDS = 7
_FILL = """#version 430
layout(local_size_x = 256) in;
layout(std430, binding = 0) writeonly buffer Words { uvec4 words[]; };
void main() {
    // No two alike, lest the memory compress them.
    uint step = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint i = gl_GlobalInvocationID.x; i < uint(words.length()); i += step) {
        words[i] = uvec4(i, i * 3u, i * 7u, ~i);
    }
}
"""
_FILL_GROUPS = 16384


class Bandwidth(NamedTuple):
    """Bytes per second to memory: written by a compute shader; read and written by a copy."""

    fill: float
    copy: float


def has_timer(renderer: str) -> bool:
    """Whether timer queries see compute shaders; llvmpipe's do not."""
    return not renderer.startswith("llvmpipe")


def clock_name(renderer: str) -> str:
    """What `least_s` measures by."""
    return "timer query" if has_timer(renderer) else "CPU time of all threads"


def least_s(context: Any, work: Callable[[], Any]) -> float:
    """The shortest of many rounds of GPU work, in seconds.

    By timer query, or where that sees nothing, CPU time of all threads until everything is
    finished.
    """
    by_query = has_timer(context.info["GL_RENDERER"])
    end = time.perf_counter() + WARM_S
    spent: list[float] = []
    while len(spent) < ROUNDS or time.perf_counter() < end:
        query = context.query(time=True)
        start = time.process_time()
        with query:
            work()
        context.finish()
        spent.append(query.elapsed * 1e-9 if by_query else time.process_time() - start)
    return min(spent)


def bandwidth(context: Any, size_bytes: int) -> Bandwidth:
    """What the memory gives for a buffer of this size; larger than caches, it should be."""
    program = context.compute_shader(_FILL)
    filled, copied = (context.buffer(reserve=size_bytes) for _ in range(2))
    filled.bind_to_storage_buffer(0)
    fill = least_s(context, lambda: program.run(_FILL_GROUPS))
    copy = least_s(context, lambda: context.copy_buffer(copied, filled))
    filled.release()
    copied.release()
    return Bandwidth(size_bytes / fill, 2 * size_bytes / copy)
