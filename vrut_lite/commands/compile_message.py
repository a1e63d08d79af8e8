"""Reports that numba compiles kernels, which takes seconds once on a machine."""

import click

from vrut_lite import compiled_code


def tell_of_compilation() -> None:
    """Print one line on standard error when numba begins to compile."""
    message = "vrut-lite: compiling the numerical kernels, once ..."
    compiled_code.on_compilation = lambda: click.echo(message, err=True)
