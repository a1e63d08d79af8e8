"""`vrut-lite desktop`: an entry for the window in the desktop's menu."""

import click

from vrut_lite.desktop_entry import install_entry, remove_entry
from vrut_lite.errors import UserError


@click.command(name="desktop")
@click.option("--install", "action", flag_value="install", help="Write or renew the entry.")
@click.option("--remove", "action", flag_value="remove", help="Remove what --install wrote.")
def desktop(action: str | None) -> None:
    """Put the window into the desktop's menu, with its icon and project files; or remove it.

    Project files that end with .vrut.toml open by a double click then.

    Example: vrut-lite desktop --install
    """
    if action is None:
        raise UserError("choose --install or --remove")
    files = install_entry() if action == "install" else remove_entry()
    for file in files:
        click.echo(file)
    if not files:
        click.echo("there was nothing to remove")
