"""`vrut-lite dump`: a journal as JSON lines."""

import click

from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.lines import dump_lines


@click.command(name="dump")
@click.argument("journal")
def dump(journal: str) -> None:
    """Print JOURNAL as JSON lines: what it was recorded with, then every message.

    An input's line can be given to `vrut-lite record --inputs`.

    Example: vrut-lite dump day.mcap
    """
    for line in dump_lines(Journal(journal)):
        click.echo(line)
