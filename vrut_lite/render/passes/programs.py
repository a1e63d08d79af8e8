"""Programs of our shaders, compiled with what a mesh has and no more."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.shader_files import Defines, defined, shader_source

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)
from pyrender.shader_program import ShaderProgram, ShaderProgramCache  # noqa: E402


class Program(ShaderProgram):
    """A program of our shaders, with pyrender's names defined as GLSL has it."""

    def __init__(self, *shaders: str, defines: Mapping[str, int]):
        super().__init__(*shaders, defines=defines)
        self._places: dict[str, int] = {}
        self._values: dict[str, object] = {}

    def _load(self, shader_filename: str) -> str:
        return defined(shader_source(Path(shader_filename).name), self.defines)

    def place(self, name: str) -> int:
        """Where a uniform is, -1 where the compiler found it unused."""
        if name not in self._places:
            self._places[name] = int(GL.glGetUniformLocation(self._program_id, name))
        return self._places[name]

    def set_uniform(self, name: str, value: Any, unsigned: bool = False) -> None:
        """Set a uniform unless it is unused or has the value: each call takes 10 microseconds.

        An array (n, 3) of other than three rows is n vectors.
        """
        place = self.place(name)
        if place < 0:
            return
        is_array = isinstance(value, np.ndarray)
        known = (value.dtype, value.tobytes()) if is_array else (type(value), value)
        if self._values.get(name) == known:
            return
        self._values[name] = known
        if is_array and value.shape == (3, 3):
            # pyrender 0.1.45 calls the wrong function.
            GL.glUniformMatrix3fv(place, 1, GL.GL_TRUE, value)
        elif is_array and value.shape[1:] == (3,):
            vectors = np.ascontiguousarray(value, dtype=np.float32)
            GL.glUniform3fv(place, len(vectors), vectors)
        else:
            super().set_uniform(name, value, unsigned)


class Programs(ShaderProgramCache):
    """Programs by their shaders and defines, pyrender's and `also` ours."""

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
            known[key] = Program(vertex_shader, fragment_shader, defines=all_defines)
        return known[key]
