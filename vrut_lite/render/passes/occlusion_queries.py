"""Asks which of some draws pass the depth test anywhere."""

from collections.abc import Callable

from vrut_lite.render.gl_environment import import_pyrender

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)

_AT_ONCE = 64


class OcclusionQueries:
    """Query objects, as many as were needed at once; on the GL thread only."""

    def __init__(self) -> None:
        self._names: list[int] = []
        self._asked = 0

    def begin(self) -> None:
        """Forget all answers."""
        self._asked = 0

    def ask(self, draw: Callable[[], None]) -> int:
        """Draw something; returns the number of the question whether a sample of it passed."""
        if self._asked == len(self._names):
            self._names += [int(name) for name in GL.glGenQueries(_AT_ONCE)]
        name = self._names[self._asked]
        GL.glBeginQuery(GL.GL_ANY_SAMPLES_PASSED, name)
        draw()
        GL.glEndQuery(GL.GL_ANY_SAMPLES_PASSED)
        self._asked += 1
        return self._asked - 1

    def passed(self, question: int) -> bool:
        """The answer, waited for."""
        return bool(GL.glGetQueryObjectuiv(self._names[question], GL.GL_QUERY_RESULT))

    def release(self) -> None:
        """Free the queries."""
        if self._names:
            GL.glDeleteQueries(len(self._names), self._names)
        self._names = []
