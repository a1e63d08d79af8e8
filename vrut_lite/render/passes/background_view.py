"""A background that a module's own shader draws for every pixel."""

from typing import Any

from vrut_lite.errors import UserError
from vrut_lite.messages.sky import ViewShader
from vrut_lite.render.compute_programs import ComputePrograms
from vrut_lite.render.job_buffers import JobBuffers
from vrut_lite.render.passes.full_screen import FullScreen
from vrut_lite.render.shader_files import Defines, defined, shader_source

_PLACE = "//!background"
_VIEW = "background"


class ViewScreen(FullScreen):
    """The sky's shader with a module's own functions in it."""

    def __init__(self, context: Any, source: str, defines: Defines):
        names = dict.fromkeys((*defines, "BACKGROUND"), 1)
        text = defined(shader_source("sky.frag"), names).replace(_PLACE, source)
        self.program = context.program(
            vertex_shader=shader_source("full_screen.vert"), fragment_shader=text
        )
        self._triangle = context.vertex_array(self.program, [])


class BackgroundView:
    """The current background shader, compiled once per source, and its inputs.

    Made and used on the GL thread only.
    """

    def __init__(self, context: Any):
        self._context = context
        self._screens: dict[tuple[str, Defines], ViewScreen | None] = {}
        self._buffers, self._programs = JobBuffers(), ComputePrograms()
        self._shown: ViewShader | None = None

    def show(self, view: ViewShader | None) -> None:
        """Draw this from the next frame on, or the cube map with None or after an error.

        Raises:
            UserError: the shader does not compile; raised once per source.
        """
        self._shown = None
        if view is None:
            self._buffers.release()
            return
        is_new = (view.source, ()) not in self._screens
        if self._screen(view.source, ()) is not None and self._prepared(view):
            self._shown = view
        elif is_new:
            raise UserError(
                "the sky's own shader cannot be used here: its cube map is shown instead, "
                "coarser where it is looked at closely"
            )

    def screen(self, defines: Defines) -> FullScreen | None:
        """The shader with its uniforms set; None to draw the cube map."""
        view = self._shown
        screen = self._screen(view.source, defines) if view is not None else None
        if view is None or screen is None:
            return None
        for name, value in view.uniforms.items():
            # A uniform that the compiler found unused is not an error.
            if name in screen.program:
                screen.program[name].value = value
        self._buffers.bind(_VIEW, len(view.programs))
        return screen

    def release(self) -> None:
        """Free the GL objects."""
        self._buffers.release()
        self._programs.release()
        for screen in self._screens.values():
            if screen is not None:
                screen.release()

    def _screen(self, source: str, defines: Defines) -> ViewScreen | None:
        key = (source, defines)
        if key not in self._screens:
            try:
                self._screens[key] = ViewScreen(self._context, source, defines)
            except Exception:
                # moderngl has no specific exception for a shader that does not compile.
                self._screens[key] = None
        return self._screens[key]

    def _prepared(self, view: ViewShader) -> bool:
        """Upload its buffers and run its programs; whether these compile."""
        buffers = [*(step.buffers for step in view.programs), view.buffers]
        self._buffers.send(self._context, _VIEW, buffers, view.shared)
        for number, step in enumerate(view.programs):
            self._buffers.bind(_VIEW, number)
            try:
                self._programs.run(self._context, step)
            except Exception:
                # As in `_screen`.
                return False
        return True
