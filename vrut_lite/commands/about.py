"""`vrut-lite about`: this installation in lines for a bug report."""

import click

from vrut_lite.about import about_text
from vrut_lite.errors import UserError
from vrut_lite.render.gl_owner import GlOwner


@click.command(name="about")
def about() -> None:
    """Print versions, machine, graphics and folders, for a bug report.

    Example: vrut-lite about
    """
    click.echo(about_text(_graphics()))


def _graphics() -> str:
    """The renderer and its driver's version, or the reason for their lack."""
    owner = GlOwner()
    try:
        device = owner.opened.device
        return f"{device.renderer}, OpenGL {device.version}"
    except UserError as error:
        return str(error)
    finally:
        owner.close()
