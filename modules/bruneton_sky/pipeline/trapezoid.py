"""Integrals along rays, by the trapezoid rule with even steps."""

from collections.abc import Iterator

from vrut_lite.numeric_types import FloatArray


def trapezoid(length_m: FloatArray, intervals: int) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Distance and weight, both in m, of each node of the trapezoid rule over a length."""
    step = length_m / intervals
    for i in range(intervals + 1):
        yield i * step, 0.5 * step if i in (0, intervals) else step
