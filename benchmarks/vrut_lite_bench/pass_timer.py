"""The time of each pass of a frame."""

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any


class PassTimer:
    """Keeps the seconds of each pass in the last frame; used on the GL thread."""

    def __init__(self, context: Any, by_query: bool):
        self._context = context
        self._by_query = by_query
        self.spent: dict[str, float] = {}

    def __call__(self, name: str) -> AbstractContextManager[None]:
        """Time what is done inside."""
        return self._by_gpu(name) if self._by_query else self._by_cpu(name)

    @contextmanager
    def _by_gpu(self, name: str) -> Iterator[None]:
        query = self._context.query(time=True)
        with query:
            yield
        self.spent[name] = query.elapsed * 1e-9

    @contextmanager
    def _by_cpu(self, name: str) -> Iterator[None]:
        self._context.finish()
        start = time.process_time()
        yield
        self._context.finish()
        self.spent[name] = time.process_time() - start
