"""GL calls that may take long, made so that Python's other threads run meanwhile.

A software renderer computes inside the call that needs a result, for seconds sometimes. moderngl
holds Python's lock all the while, and a window with it; PyOpenGL, by ctypes, lets it go. All of
this on the GL thread.
"""

from typing import Any


def draw_triangle(program: Any, vertex_array: Any) -> None:
    """Draw three vertices of a moderngl vertex array."""
    from OpenGL import GL

    GL.glUseProgram(program.glo)
    GL.glBindVertexArray(vertex_array.glo)
    GL.glDrawArrays(GL.GL_TRIANGLES, 0, 3)


def run_compute(program: Any, x: int, y: int, z: int) -> None:
    """Run a moderngl compute shader in so many groups."""
    from OpenGL import GL

    GL.glUseProgram(program.glo)
    GL.glDispatchCompute(x, y, z)
