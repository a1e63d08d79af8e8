"""The GL calls that every mesh of every picture makes, without PyOpenGL's wrappers.

A wrapper takes 5 to 20 microseconds, and a picture has a thousand such calls. An error that one of
them leaves is raised by the next call of PyOpenGL. They keep Python's lock, as they take no time;
`draw_elements` and `draw_arrays` let other threads run.
"""

import ctypes
from collections.abc import Callable
from typing import Any

from vrut_lite.render.gl_environment import import_pyrender

import_pyrender()
from OpenGL.platform import PLATFORM  # noqa: E402  (pyrender's repairs must come first)

_INT, _ENUM, _FLOAT, _TRUTH = ctypes.c_int, ctypes.c_uint, ctypes.c_float, ctypes.c_ubyte
# Packed bytes, which are not copied.
_DATA, _OFFSET = ctypes.c_char_p, ctypes.c_void_p


def _quick(name: str, *kinds: type) -> Callable[..., Any]:
    return ctypes.PYFUNCTYPE(None, *kinds)(_address(name))


def _slow(name: str, *kinds: type) -> Callable[..., Any]:
    return ctypes.CFUNCTYPE(None, *kinds)(_address(name))


def _address(name: str) -> int:
    address = PLATFORM.getExtensionProcedure(name.encode())
    assert address
    return int(address)


use_program = _quick("glUseProgram", _ENUM)
bind_vertices = _quick("glBindVertexArray", _ENUM)
active_texture = _quick("glActiveTexture", _ENUM)
bind_texture = _quick("glBindTexture", _ENUM, _ENUM)
enable = _quick("glEnable", _ENUM)
disable = _quick("glDisable", _ENUM)
cull_face = _quick("glCullFace", _ENUM)
blend_function = _quick("glBlendFunc", _ENUM, _ENUM)
set_int = _quick("glUniform1i", _INT, _INT)
set_float = _quick("glUniform1f", _INT, _FLOAT)
set_vectors = {length: _quick(f"glUniform{length}fv", _INT, _INT, _DATA) for length in (2, 3, 4)}
set_matrix = {
    length: _quick(f"glUniformMatrix{length}fv", _INT, _INT, _TRUTH, _DATA) for length in (3, 4)
}
draw_elements = _slow("glDrawElements", _ENUM, _INT, _ENUM, _OFFSET)
draw_arrays = _slow("glDrawArrays", _ENUM, _INT, _INT)
