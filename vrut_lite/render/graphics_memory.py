"""Allocation of textures and buffers that a graphics card may have no memory for.

moderngl does not ask for errors: without this a texture without memory stays black, and the error
belongs to whatever asks next.
"""

from collections.abc import Callable
from typing import Any

_FULL = "GL_OUT_OF_MEMORY"


class GraphicsMemoryFullError(Exception):
    """The graphics card has no memory for this."""


def allocated(context: Any, what: str, *makes: Callable[[], Any]) -> list[Any]:
    """The objects that these calls make; none is kept if one gets no memory.

    Raises:
        GraphicsMemoryFullError: with `what` was to be made.
    """
    made: list[Any] = []
    for make in makes:
        made.append(make())
        if context.error == _FULL:
            for thing in made:
                thing.release()
            raise GraphicsMemoryFullError(f"no graphics memory for {what}")
    return made
