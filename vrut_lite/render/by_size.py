"""What is made for one size of picture, kept for the next picture of that size."""

from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar

from vrut_lite.render.gl_owner import rest

Size = tuple[int, int]


class Released(Protocol):
    """What has GL objects to free."""

    def release(self) -> None:
        """Free them; another framebuffer must be bound."""


T = TypeVar("T", bound=Released)
# One for pictures while something moves, one for the finished picture.
_KEPT = 2


class BySize(Generic[T]):
    """The two that were used last; on the GL thread only.

    To make a large picture's framebuffers anew took 30 ms, in which Python stood still.
    """

    def __init__(self, context: Any, make: Callable[[Size], T]):
        self._context = context
        self._make = make
        self._kept: dict[Size, T] = {}

    def of(self, size: Size) -> T:
        """The one of this size."""
        thing = self._kept.pop(size, None)
        if thing is None:
            while len(self._kept) >= _KEPT:
                self._release_oldest()
            thing = self._make(size)
        self._kept[size] = thing
        return thing

    def release(self) -> None:
        """Free all."""
        while self._kept:
            self._release_oldest()

    def _release_oldest(self) -> None:
        rest(self._context)
        self._kept.pop(next(iter(self._kept))).release()
