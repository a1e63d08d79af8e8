"""Reports that numba compiles kernels, which takes seconds once on a machine."""

import click


def tell_of_compilation() -> None:
    """Print one line on standard error when numba begins to compile."""
    from numba.core import event

    class Teller(event.Listener):
        def on_start(self, _event: event.Event) -> None:
            if not self.told:
                click.echo("vrut-lite: compiling the numerical kernels, once ...", err=True)
                self.told = True

        def on_end(self, _event: event.Event) -> None:
            """Nothing to say."""

        told = False

    event.register("numba:compile", Teller())
