"""The command `vrut-lite`: finds its subcommands by entry point, prints errors as one line."""

import ast
import atexit
import gc
import importlib.util
import io
import os
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import click

from vrut_lite import __version__
from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.interrupts import (
    Terminated,
    interrupted_during,
    interrupts_held,
    pass_interrupt,
    terminations_raised,
)
from vrut_lite.package_facts import (
    SAFE_MODE_OPTION,
    SAFE_MODE_VARIABLE,
    load_fitting,
    usable_points,
)

GROUP = "vrut_lite.commands"
# Commands that the distribution vrut-lite-lab brings.
LABORATORY = ("bench", "study")
_IN_LABORATORY = "needs the package vrut-lite-lab: in a checkout, run pip install ./lab"
# New objects after which garbage in cycles is sought. With Python's 700 it is sought 375 times
# while a picture is made, in a tenth of its time: nearly all objects are of libraries, and stay.
_NEW_OBJECTS = 20_000
NO_HELP = "PYTHONOPTIMIZE=2 leaves out what would be said here: unset it."


class EntryPointGroup(click.Group):
    """Subcommands that installed packages contribute; each is imported only when used."""

    def _points(self) -> dict[str, EntryPoint]:
        return {point.name: point for point in usable_points(GROUP)}

    def list_commands(self, context: click.Context) -> list[str]:
        """Names of all contributed commands."""
        return sorted(self._points())

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        """Import a command."""
        point = self._points().get(name)
        if point is None and name in LABORATORY:
            return _broken(name, UserError(f"{name} {_IN_LABORATORY}"))
        if point is None:
            return None
        try:
            with interrupts_held():
                return _with_help(_command(load_fitting(point)))
        except UserError as error:
            return _broken(name, error)
        except BaseException as error:
            pass_interrupt(error)
            return _broken(name, ModuleFailed(f"the command {name} failed to load: {error}"))

    def format_commands(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands by their docstrings, which are read without importing them."""
        described = [_described(point) for _, point in sorted(self._points().items())]
        click.Group(commands=described).format_commands(context, formatter)


def _described(point: EntryPoint) -> click.Command:
    """A command's name and help, from its source: importing all of them takes a second."""
    said = None
    try:
        found = importlib.util.find_spec(point.module)
        if found is not None and found.origin is not None:
            for statement in ast.parse(Path(found.origin).read_bytes()).body:
                if isinstance(statement, ast.FunctionDef) and statement.name == point.attr:
                    said = ast.get_docstring(statement)
    except BaseException as error:  # Its package may raise anything; a call reports it.
        pass_interrupt(error)
        return click.Command(point.name)
    return click.Command(point.name, help=said if sys.flags.optimize < 2 else NO_HELP)


def _command(loaded: object) -> click.Command:
    if not isinstance(loaded, click.Command):
        raise UserError("it names no click.Command")
    return loaded


def _with_help(command: click.Command) -> click.Command:
    """The command; without docstrings (python -OO) its help says so."""
    if sys.flags.optimize >= 2 and not command.help:
        command.help = NO_HELP
    return command


def _broken(name: str, reason: UserError | ModuleFailed) -> click.Command:
    """Stands in for a command that cannot be imported, so that the others still work."""

    def tell(arguments: tuple[str, ...]) -> None:
        raise reason

    anything = click.Argument(["arguments"], nargs=-1, type=click.UNPROCESSED)
    settings = {"ignore_unknown_options": True}
    return click.Command(
        name, callback=tell, params=[anything], help=str(reason), context_settings=settings
    )


@click.group(cls=EntryPointGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="vrut-lite")
def root() -> None:
    """Daylight for scenes: the sky and the sun of a place and an hour.

    Example: vrut-lite render scenes/sundial.glb -o noon.png --at 2026-06-21T13:00
    """


def main() -> None:
    """Run the command line; exit code 0, 2 for bad input, 1 for a failure of the program."""
    _tell_any_name()
    gc.set_threshold(_NEW_OBJECTS)
    # The process ends: freezing the remaining objects saves 0.3 s of searching them.
    atexit.register(gc.freeze)
    # Matrices are small: threads of numpy's BLAS would only wait for each other, for seconds on a
    # busy machine. BLAS reads the variable when numpy is imported, after this line.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Before the options are made, of which modules bring some.
    if SAFE_MODE_OPTION in sys.argv[1:]:
        os.environ[SAFE_MODE_VARIABLE] = "1"
    if any("\0" in argument for argument in sys.argv):
        _end("an argument holds a null character, which no text or name can: leave it out", 2)
    try:
        with terminations_raised():
            _with_help(root)(standalone_mode=False)
        # stdout is None if it was closed before the start.
        if sys.stdout is not None:
            sys.stdout.flush()
    except click.exceptions.NoArgsIsHelpError as error:
        print(error.format_message())
    except BrokenPipeError:
        # The reader of the output has closed it, as `head` does: not an error.
        _drop_output()
    except EXPECTED as error:
        if isinstance(error, OSError):
            _drop_output()
        _end(*sentence_and_code(error))
    except (click.Abort, KeyboardInterrupt) as error:
        _end(f"interrupted {interrupted_during(error)}", 130)
    except Terminated as error:
        _end(f"terminated {interrupted_during(error)}", 143)


# Exceptions of a command that are no fault of the program.
EXPECTED = (click.ClickException, UserError, ModuleFailed, MemoryError, OSError)


def sentence_and_code(error: BaseException) -> tuple[str, int]:
    """The sentence of one of the `EXPECTED` exceptions, and the exit code: 2 for bad input."""
    if isinstance(error, click.ClickException):
        return error.format_message(), 2
    if isinstance(error, MemoryError):
        return "there is not enough memory for this: ask for a smaller size", 1
    if isinstance(error, OSError):
        return error.strerror or str(error), 1
    return str(error), 2 if isinstance(error, UserError) else 1


def _drop_output() -> None:
    """Discard unwritable output: Python would try again at its end, and exit with 120."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _tell_any_name() -> None:
    """Escape characters that the terminal cannot show: file names may hold any bytes."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _end(sentence: str, code: int) -> None:
    """Print one line to standard error and leave."""
    print("vrut-lite: " + " ".join(sentence.split()), file=sys.stderr)
    sys.exit(code)
