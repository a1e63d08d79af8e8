"""Asks which of some draws pass the depth test anywhere."""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from vrut_lite.render.gl_environment import import_pyrender

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)

T = TypeVar("T")


class OcclusionQueries:
    """Query objects, as many as were needed at once; on the GL thread only."""

    def __init__(self) -> None:
        self._names: list[int] = []

    def unseen(self, things: Sequence[T], draw: Callable[[T], None]) -> frozenset[T]:
        """Draw each thing; returns those of which no sample passed."""
        if len(things) > len(self._names):
            more = GL.glGenQueries(len(things) - len(self._names))
            self._names += [int(name) for name in np.atleast_1d(more)]
        for name, thing in zip(self._names, things, strict=False):
            GL.glBeginQuery(GL.GL_ANY_SAMPLES_PASSED, name)
            draw(thing)
            GL.glEndQuery(GL.GL_ANY_SAMPLES_PASSED)
        return frozenset(
            thing
            for name, thing in zip(self._names, things, strict=False)
            if not GL.glGetQueryObjectuiv(name, GL.GL_QUERY_RESULT)
        )

    def release(self) -> None:
        """Free the queries."""
        if self._names:
            GL.glDeleteQueries(len(self._names), self._names)
        self._names = []
