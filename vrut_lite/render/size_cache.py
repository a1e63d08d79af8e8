"""A cache of GL objects by the size of the picture that they are made for."""

from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar

from vrut_lite.render.gl_owner import bind_permanent_framebuffer

Size = tuple[int, int]


class Released(Protocol):
    """Something that holds GL objects."""

    def release(self) -> None:
        """Free them; another framebuffer must be bound."""


T = TypeVar("T", bound=Released)
# One size for frames while something moves, one for the finished picture.
_KEPT = 2


class SizeCache(Generic[T]):
    """Keeps the objects of the two sizes that were used last; on the GL thread only.

    Making the framebuffers of a large picture takes 30 ms.
    """

    def __init__(self, context: Any, make: Callable[[Size], T]):
        self._context = context
        self._make = make
        self._kept: dict[Size, T] = {}

    def get(self, size: Size) -> T:
        """The objects for this size, created if they are not cached."""
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
        bind_permanent_framebuffer(self._context)
        self._kept.pop(next(iter(self._kept))).release()
