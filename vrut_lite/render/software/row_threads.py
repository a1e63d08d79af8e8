"""Kernels over a picture's rows: half of them on another thread, half on the caller's."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

_other = ThreadPoolExecutor(1, "half")


def run_in_halves(kernel: Callable[..., None], rows: int, *arguments: Any) -> None:
    """Call `kernel(*arguments, first, end)` for all rows; it must run without Python's lock."""
    half = rows // 2
    upper = _other.submit(kernel, *arguments, half, rows)
    kernel(*arguments, 0, half)
    upper.result()
