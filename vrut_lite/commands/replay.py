"""`vrut-lite replay`: play a journal's inputs to the modules again, and compare their messages."""

import json

import click

from vrut_lite.commands.headless_scene import modules_for
from vrut_lite.errors import ModuleFailed, one_line
from vrut_lite.recording.chrome_trace import export_chrome
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.replay import Outcome, Replay
from vrut_lite.write_atomic import atomic_output, check_writable


@click.command(name="replay")
@click.argument("journal")
@click.option("--check", is_flag=True, help="Exit with 1 at the first message that differs.")
@click.option(
    "--trace",
    metavar="FILE",
    help="Write what caused what, and how long it took (Chrome trace JSON; Perfetto opens it).",
)
def replay(journal: str, check: bool, trace: str | None) -> None:
    """Replay JOURNAL with the installed modules and compare their messages.

    On the machine and the versions of the recording digests must be equal; elsewhere scalars are
    compared to 1e-5 and sampled values of arrays to 1e-3, and the output says so.

    Example: vrut-lite replay day.mcap --check
    """
    if trace is not None:
        check_writable(trace)
    recorded = Journal(journal)
    rerun = Replay(recorded, modules_for(recorded.setup))
    outcome = rerun.run(to_the_end=not check)
    if trace is not None:
        _write_trace(rerun, trace)
    if outcome.difference is None:
        _say(f"{journal}: {_counts(outcome)} are equal, {_comparison(outcome)}")
    elif check:
        raise ModuleFailed(f"{journal}: {outcome.difference} ({_comparison(outcome)})")
    else:
        _say(f"{journal}: {_counts(outcome)} replayed; the first that differs: "
             f"{outcome.difference} ({_comparison(outcome)})")  # fmt: skip


def _say(sentence: str) -> None:
    """Print a text that may quote a hostile journal, escaped."""
    click.echo(one_line(sentence, 2000))


def _write_trace(rerun: Replay, path: str) -> None:
    trace = rerun.kernel.trace
    content = json.dumps(export_chrome(trace.entries(), trace.remarks()))
    with atomic_output(path) as beside:
        beside.write_text(content, encoding="utf-8")


def _counts(outcome: Outcome) -> str:
    return f"{outcome.inputs} inputs and {outcome.messages} messages"


def _comparison(outcome: Outcome) -> str:
    if not outcome.by_value:
        return "compared by digest"
    return f"compared by value, as the recording had {'; '.join(outcome.signature_differences)}"
