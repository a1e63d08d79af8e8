"""The commands of `python -m vrut_lite_lab.card_check`."""

from pathlib import Path

import click

from vrut_lite_lab.card_check.page import write_page
from vrut_lite_lab.card_check.parts import PARTS, run_part, run_parts
from vrut_lite_lab.card_check.prepare import fill_folder


@click.group()
def main() -> None:
    """The check of a graphics card."""


@main.command()
@click.option("--python", default="3.12", show_default=True, help="Of the machine with the card.")
@click.option("--folder", default=".card", show_default=True)
def prepare(python: str, folder: str) -> None:
    """Fill a folder with what the machine with the card lacks."""
    fill_folder(Path(folder), python)


@main.command()
@click.argument("folder")
@click.option("--only", help=f"Some of the parts, comma-separated: {', '.join(PARTS)}.")
@click.option("--patience", default=1.0, show_default=True, help="Factor of the limits of time.")
def run(folder: str, only: str | None, patience: float) -> None:
    """Do all parts, one after another; then write the page."""
    names = list(PARTS) if only is None else only.split(",")
    run_parts(Path(folder), names, patience)
    write_page(Path(folder))


@main.command()
@click.argument("name", type=click.Choice(list(PARTS)))
@click.argument("folder")
def part(name: str, folder: str) -> None:
    """Do one part in this process."""
    run_part(name, Path(folder))


@main.command()
@click.argument("folder")
def page(folder: str) -> None:
    """Write FOLDER/card.md from the parts' results."""
    write_page(Path(folder))


if __name__ == "__main__":
    main()
