"""Reports that numba compiles kernels, which takes its time once on a machine."""

import click

from vrut_lite.compiling.ahead import compile_ahead
from vrut_lite.compiling.pool import Progress
from vrut_lite.studio.progress import compiling_text, note_compiling

_ONCE = "vrut-lite: compiling the numerical kernels, once ..."
# Elsewhere than on a terminal a line is printed after each such share of the kernels.
_SHARE = 0.25


def tell_of_compilation(scene: bool = False) -> None:
    """Compile ahead where numba begins to compile, and tell of it on standard error.

    Args:
        scene: a picture of a scene is drawn.
    """
    compile_ahead(CompileLines(), scene)


class CompileLines:
    """The progress of a compilation: a bar on a terminal, else a line now and then."""

    def __init__(self) -> None:
        self._told_at = 0.0
        self._began = False

    def begin(self) -> None:
        """numba compiles a kernel."""
        if not self._began:
            self._began = True
            click.echo(_ONCE, err=True)

    def __call__(self, progress: Progress) -> None:
        """Show the progress."""
        is_shown = note_compiling(progress)
        share = progress.done / max(progress.total, 1)
        is_due = share >= self._told_at + _SHARE or progress.done == progress.total
        if is_due and self._told_at < 1.0:
            self._told_at = share
            if not is_shown:
                click.echo(f"vrut-lite: {compiling_text(progress)}", err=True)
