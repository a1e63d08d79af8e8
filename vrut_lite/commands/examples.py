"""`vrut-lite examples`: lists and copies the examples that come with the program."""

from pathlib import Path

import click

from vrut_lite.bundled.examples import all_examples, copy_examples, example_named
from vrut_lite.errors import UserError


@click.group(name="examples", invoke_without_command=True)
@click.pass_context
def examples(context: click.Context) -> None:
    """List the scenes and other examples that come with the program; copy them.

    Example: vrut-lite examples copy street my_scenes
    """
    if context.invoked_subcommand is None:
        for example in all_examples().values():
            click.echo(f"{example.name}: {example.title} ({example.files[0]})")


@examples.command()
@click.argument("names_and_folder", nargs=-1, required=True, metavar="[NAME...] FOLDER")
def copy(names_and_folder: tuple[str, ...]) -> None:
    """Copy examples, all if none is named, into FOLDER; a file there is never overwritten.

    Example: vrut-lite examples copy street sundial my_scenes
    """
    *names, folder = names_and_folder
    if not names and folder in all_examples() and not Path(folder).exists():
        raise UserError(
            f"name a folder too: vrut-lite examples copy {folder} FOLDER, or ./{folder} for all"
        )
    chosen = [example_named(name) for name in names] or list(all_examples().values())
    copies = copy_examples(chosen, Path(folder))
    size_mb = sum(file.stat().st_size for file in copies) / 1e6
    click.echo(f"{folder}: {len(copies)} files, {size_mb:.1f} MB; first: {copies[0]}")
