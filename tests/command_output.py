"""Commands run in this process."""

from click.testing import CliRunner


def output_of(command, *arguments):
    """Output of a command that succeeds; its exceptions are raised here."""
    words = [str(argument) for argument in arguments]
    result = CliRunner().invoke(command, words, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output
