"""Programs of our shaders, compiled with a mesh's attributes and features only."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from vrut_lite.render import direct_gl
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.shader_files import Defines, defined, shader_source

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)
from pyrender.shader_program import ShaderProgram, ShaderProgramCache  # noqa: E402

# Programs that stay compiled: 3 MiB each where a processor renders. A picture needs 10 to 30.
MOST_PROGRAMS = 64


class Program(ShaderProgram):
    """A program of our shaders, with pyrender's names defined in GLSL's syntax."""

    def __init__(self, *shaders: str, defines: Mapping[str, int]):
        super().__init__(*shaders, defines=defines)
        # Whether it was bound since `Programs` looked last.
        self.was_bound = True
        self._places: dict[str, int] = {}
        self._values: dict[str, object] = {}
        self._last: dict[str, Mapping[str, Any]] = {}

    def _load(self, shader_filename: str) -> str:
        return defined(shader_source(Path(shader_filename).name), self.defines)

    def place(self, name: str) -> int:
        """Location of a uniform, -1 if the compiler found it unused."""
        if name not in self._places:
            self._places[name] = int(GL.glGetUniformLocation(self._program_id, name))
        return self._places[name]

    def _bind(self) -> None:
        self.was_bound = True
        direct_gl.use_program(self._program_id)

    def set_uniforms(self, kind: str, values: Mapping[str, Any]) -> None:
        """Set the uniforms of a kind, unless this mapping object was the last one set."""
        if self._last.get(kind) is not values:
            self._last[kind] = values
            for name, value in values.items():
                self.set_uniform(name, value)

    def set_uniform(self, name: str, value: Any) -> None:
        """Set a uniform of the bound program, unless it is unused or has the value.

        A number, a vector (2,) to (4,), vectors (n, 3) of other than three rows, or a matrix
        (3, 3) or (4, 4), as mathematics writes them.
        """
        place = self.place(name)
        if place < 0:
            return
        is_array = isinstance(value, np.ndarray)
        known = value.astype(np.float32).tobytes() if is_array else value
        if self._values.get(name) == known:
            return
        self._values[name] = known
        if not is_array:
            set_number = direct_gl.set_float if isinstance(value, float) else direct_gl.set_int
            set_number(place, value)
        elif value.ndim == 1:
            direct_gl.set_vectors[len(value)](place, 1, known)
        elif value.shape in ((3, 3), (4, 4)):
            direct_gl.set_matrix[len(value)](place, 1, True, known)
        else:
            direct_gl.set_vectors[3](place, len(value), known)


class Programs(ShaderProgramCache):
    """Programs by their shaders and defines, pyrender's and `also` ours.

    Beyond MOST_PROGRAMS the oldest that was not bound lately is freed (a clock, Corbato 1968).
    """

    also: Defines = ()

    def get_program(
        self,
        vertex_shader: str,
        fragment_shader: str,
        geometry_shader: None = None,
        defines: Mapping[str, int] | None = None,
    ) -> Program:
        """The program of these shaders, not yet in the context if it is new."""
        known = self._program_cache
        all_defines = {**(defines or {}), **dict.fromkeys(self.also, 1)}
        key = (vertex_shader, fragment_shader, *sorted(all_defines.items()))
        if key not in known:
            self._make_room()
            known[key] = Program(vertex_shader, fragment_shader, defines=all_defines)
        return known[key]

    def _make_room(self) -> None:
        known = self._program_cache
        while len(known) >= MOST_PROGRAMS:
            key = next(iter(known))
            oldest = known.pop(key)
            if oldest.was_bound:
                oldest.was_bound = False
                known[key] = oldest
            else:
                oldest.delete()


def compile_error(defines: Defines) -> str | None:
    """The compiler's first complaint about the surfaces' shader with these defines, or None."""
    shader = GL.glCreateShader(GL.GL_FRAGMENT_SHADER)
    try:
        GL.glShaderSource(shader, defined(shader_source("mesh.frag"), dict.fromkeys(defines, 1)))
        GL.glCompileShader(shader)
        if GL.glGetShaderiv(shader, GL.GL_COMPILE_STATUS):
            return None
        return GL.glGetShaderInfoLog(shader).decode("utf-8", "replace").strip().splitlines()[0]
    finally:
        GL.glDeleteShader(shader)
