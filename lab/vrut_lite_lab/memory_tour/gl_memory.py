"""Objects of an OpenGL context, and the memory of its textures and buffers; on the GL thread."""

import ctypes
from functools import cache
from typing import Any, NamedTuple

from vrut_lite_lab.memory_tour.process_memory import MIB

# Drivers number objects from 1 and use the lowest free number again.
_NAMES = range(1, 6000)
_TEXTURE_TARGET, _MOST_LEVELS = 0x1006, 16
_CHANNELS = ("RED", "GREEN", "BLUE", "ALPHA", "DEPTH", "STENCIL")


class GlMemory(NamedTuple):
    """Numbers of objects, and MiB of textures and buffers."""

    textures: int
    buffers: int
    programs: int
    framebuffers: int
    vertex_arrays: int
    queries: int
    texture_mib: float
    buffer_mib: float


def gl_memory() -> GlMemory:
    """The objects of the current context."""
    from OpenGL import GL

    textures = [name for name in _NAMES if GL.glIsTexture(name)]
    buffers = [name for name in _NAMES if GL.glIsBuffer(name)]
    return GlMemory(
        textures=len(textures),
        buffers=len(buffers),
        programs=sum(bool(GL.glIsProgram(name)) for name in _NAMES),
        framebuffers=sum(bool(GL.glIsFramebuffer(name)) for name in _NAMES),
        vertex_arrays=sum(bool(GL.glIsVertexArray(name)) for name in _NAMES),
        queries=sum(bool(GL.glIsQuery(name)) for name in _NAMES),
        texture_mib=sum(map(_texture_bytes, textures)) / MIB,
        buffer_mib=sum(map(_buffer_bytes, buffers)) / MIB,
    )


def _texture_bytes(name: int) -> int:
    from OpenGL import GL

    target = _value("glGetTextureParameteriv", name, _TEXTURE_TARGET)
    faces = 6 if target == GL.GL_TEXTURE_CUBE_MAP else 1
    total = 0
    for level in range(_MOST_LEVELS):

        def of_level(kind: int, level: int = level) -> int:
            return _value("glGetTextureLevelParameteriv", name, level, kind)

        width, height = of_level(GL.GL_TEXTURE_WIDTH), of_level(GL.GL_TEXTURE_HEIGHT)
        if not width:
            break
        layers = max(of_level(GL.GL_TEXTURE_DEPTH), 1) * faces
        samples = max(of_level(GL.GL_TEXTURE_SAMPLES), 1)
        bits = sum(of_level(getattr(GL, f"GL_TEXTURE_{channel}_SIZE")) for channel in _CHANNELS)
        total += width * height * layers * samples * bits // 8
    return total


def _buffer_bytes(name: int) -> int:
    from OpenGL import GL

    return _value("glGetNamedBufferParameteriv", name, GL.GL_BUFFER_SIZE)


def _value(function: str, *arguments: int) -> int:
    """A number that a function of OpenGL 4.5 answers, which PyOpenGL 3.1.0 lacks."""
    value = ctypes.c_int()
    _function(function, len(arguments))(*arguments, ctypes.byref(value))
    return value.value


@cache
def _function(name: str, numbers: int) -> Any:
    find = ctypes.CDLL("libEGL.so.1").eglGetProcAddress
    find.restype = ctypes.c_void_p
    kinds = [ctypes.c_uint] * numbers
    return ctypes.CFUNCTYPE(None, *kinds, ctypes.POINTER(ctypes.c_int))(find(name.encode()))
