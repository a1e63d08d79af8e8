"""Commands run in this process."""

import click
from click.testing import CliRunner

from vrut_lite.commands.options import daylight_options, with_options
from vrut_lite.project import Project


def output_of(command, *arguments):
    """Output of a command that succeeds; its exceptions are raised here."""
    words = [str(argument) for argument in arguments]
    result = CliRunner().invoke(command, words, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def shared_options(*arguments, project=None):
    """The project that the shared options make, and what they tell; errors are raised."""
    made = []

    @click.command()
    @daylight_options
    def command(**options):
        made.append(with_options(project or Project(), options))

    result = CliRunner().invoke(command, list(arguments), standalone_mode=False)
    if result.exception is not None:
        raise result.exception
    return made[0], result.stderr
