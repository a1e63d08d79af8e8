"""Slow GL calls that release Python's lock, so that other threads run meanwhile.

A software renderer computes inside the call that needs a result, sometimes for seconds. moderngl
holds Python's lock meanwhile, which stops a window; PyOpenGL, by ctypes, releases it. All of
this on the GL thread.
"""

import ctypes
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", bound=np.generic)


def draw_triangle(program: Any, vertex_array: Any) -> None:
    """Draw three vertices of a moderngl vertex array."""
    from OpenGL import GL

    GL.glUseProgram(program.glo)
    GL.glBindVertexArray(vertex_array.glo)
    GL.glDrawArrays(GL.GL_TRIANGLES, 0, 3)


def run_compute(program: Any, x: int, y: int, z: int) -> None:
    """Run a moderngl compute shader in a number of groups."""
    from OpenGL import GL

    GL.glUseProgram(program.glo)
    GL.glDispatchCompute(x, y, z)


def build_mipmaps(target: int, texture: Any) -> None:
    """Generate the mipmaps of a moderngl texture of this GL target; the caller sets its filter."""
    from OpenGL import GL

    GL.glBindTexture(target, texture.glo)
    GL.glGenerateMipmap(target)
    GL.glBindTexture(target, 0)


def average_down_for_compute(cube: Any) -> None:
    """Generate the mipmaps of a moderngl cube map, and wait for them.

    Mesa's llvmpipe lets a compute shader read levels that its own threads still draw.
    """
    from OpenGL import GL

    build_mipmaps(GL.GL_TEXTURE_CUBE_MAP, cube)
    GL.glFinish()


def read_rgba(texture: Any) -> NDArray[np.float32]:
    """The numbers (h, w, 4) of a flat moderngl texture, row 0 at the bottom."""
    from OpenGL import GL

    return _read(texture, GL.GL_RGBA, GL.GL_FLOAT, np.empty(_shape(texture, 4), np.float32))


def read_bytes(texture: Any) -> NDArray[np.uint8]:
    """The bytes (h, w, 4) of a flat moderngl texture, row 0 at the bottom."""
    from OpenGL import GL

    return _read(texture, GL.GL_RGBA, GL.GL_UNSIGNED_BYTE, np.empty(_shape(texture, 4), np.uint8))


def read_colours(texture: Any) -> NDArray[np.uint8]:
    """The bytes (h, w, 3) of a flat moderngl texture without its alpha, row 0 at the bottom."""
    from OpenGL import GL

    GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 1)
    found = _read(texture, GL.GL_RGB, GL.GL_UNSIGNED_BYTE, np.empty(_shape(texture, 3), np.uint8))
    GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 4)
    return found


def _shape(texture: Any, channels: int) -> tuple[int, int, int]:
    width, height = texture.size
    return height, width, channels


def _read(texture: Any, channels: int, kind: int, out: NDArray[Number]) -> NDArray[Number]:
    from OpenGL import GL

    GL.glBindTexture(GL.GL_TEXTURE_2D, texture.glo)
    GL.glGetTexImage(GL.GL_TEXTURE_2D, 0, channels, kind, out)
    GL.glBindTexture(GL.GL_TEXTURE_2D, 0)
    return out


def copy_bytes(source: Any, texture: int) -> None:
    """Copy the bytes of a flat moderngl texture into another of its size, by its name.

    Both have four bytes a pixel; sRGB ones are not converted.
    """
    from OpenGL import GL

    of_source, of_other = (source.glo, GL.GL_TEXTURE_2D), (texture, GL.GL_TEXTURE_2D)
    corner = (0, 0, 0, 0)
    GL.glCopyImageSubData(*of_source, *corner, *of_other, *corner, *source.size, 1)


def clear_buffer(buffer: Any) -> None:
    """Fill a moderngl buffer with zeros, on the card."""
    from OpenGL import GL

    GL.glBindBuffer(GL.GL_SHADER_STORAGE_BUFFER, buffer.glo)
    GL.glClearBufferData(
        GL.GL_SHADER_STORAGE_BUFFER, GL.GL_R32UI, GL.GL_RED_INTEGER, GL.GL_UNSIGNED_INT, None
    )


def read_buffer(buffer: Any, out: NDArray[Number]) -> NDArray[Number]:
    """Fill an array with the content of a moderngl buffer."""
    from OpenGL import GL

    GL.glBindBuffer(GL.GL_SHADER_STORAGE_BUFFER, buffer.glo)
    # PyOpenGL 3.1.0 passes an array's address wrongly here.
    address = ctypes.c_void_p(out.ctypes.data)
    GL.glGetBufferSubData(GL.GL_SHADER_STORAGE_BUFFER, 0, out.nbytes, address)
    return out
