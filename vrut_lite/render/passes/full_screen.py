"""Programs that draw one triangle over the whole picture."""

from pathlib import Path
from typing import Any

from vrut_lite.render.shader_files import Defines, defined, shader_source
from vrut_lite.render.unlocked import draw_triangle


class FullScreen:
    """A fragment shader for every pixel; made and used on the GL thread only."""

    def __init__(self, context: Any, fragment_shader: str | Path, defines: Defines = ()):
        self.program = context.program(
            vertex_shader=shader_source("full_screen.vert"),
            fragment_shader=defined(shader_source(fragment_shader), dict.fromkeys(defines, 1)),
        )
        self._triangle = context.vertex_array(self.program, [])

    def set(self, name: str, value: Any) -> None:
        """Set a uniform, a number or numbers, unless the compiler found it unused."""
        if name in self.program:
            number = isinstance(value, int | float)
            self.program[name].value = value if number else tuple(map(float, value))

    def draw(self) -> None:
        """Draw into the bound framebuffer."""
        draw_triangle(self.program, self._triangle)

    def release(self) -> None:
        """Free program and vertex array."""
        self._triangle.release()
        self.program.release()
