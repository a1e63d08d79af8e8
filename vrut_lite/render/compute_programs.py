"""Compute programs that modules bring as text."""

from typing import Any

from vrut_lite.messages.gpu_job import GpuPass
from vrut_lite.render.unlocked import run_compute


class ComputePrograms:
    """Compiles each source once; on the GL thread only."""

    def __init__(self) -> None:
        self._programs: dict[str, Any] = {}

    def run(self, context: Any, step: GpuPass) -> None:
        """Run a program, whose images and buffers are bound; the next ones see what it wrote."""
        if step.compute_shader not in self._programs:
            self._programs[step.compute_shader] = context.compute_shader(step.compute_shader)
        program = self._programs[step.compute_shader]
        for name, value in step.uniforms.items():
            # A uniform that the compiler found unused is not an error.
            if name in program:
                program[name].value = value
        run_compute(program, *step.groups)
        context.memory_barrier()

    def release(self) -> None:
        """Free the programs."""
        for program in self._programs.values():
            program.release()
        self._programs.clear()
