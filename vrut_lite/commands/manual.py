"""`vrut-lite manual`: the manual's start page on this machine."""

import webbrowser

import click

from vrut_lite.bundled.manual import manual_start


@click.command(name="manual")
@click.option("--open", "opens", is_flag=True, help="Open it in the browser too.")
def manual(opens: bool) -> None:
    """Print the path of the manual, HTML pages that need no network.

    Example: vrut-lite manual --open
    """
    start = manual_start()
    click.echo(start)
    if opens and not webbrowser.open(start.as_uri()):
        click.echo("no browser was found: open this file in one", err=True)
