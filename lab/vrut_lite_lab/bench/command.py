"""`vrut-lite bench`: run time against error of every path of every computation."""

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console
from rich.progress import Progress

from vrut_lite.errors import ModuleFailed, UserError
from vrut_lite.lazy import lazy
from vrut_lite.write_atomic import atomic_output, check_writable

if TYPE_CHECKING:
    from vrut_lite_lab.bench.results import Results

# They need libraries that `--help` need not wait for.
_compare = lazy("vrut_lite_lab.bench.compare")
_gl = lazy("vrut_lite_lab.bench.gl")
_page = lazy("vrut_lite_lab.bench.page")
_registry = lazy("vrut_lite_lab.bench.registry")
_results = lazy("vrut_lite_lab.bench.results")
_session = lazy("vrut_lite_lab.bench.session")
# Paths that look slower are timed again this many times.
_TRIES = 2


@click.command(name="bench")
@click.option(
    "-o", "--output", default="bench", show_default=True, metavar="FOLDER", help="Made if missing."
)
@click.option(
    "--quick", is_flag=True, help="Fewer paths, conditions and rounds, in under two minutes."
)
@click.option(
    "--only",
    metavar="NAMES",
    help="Some of the computations, as sun,tables: sun, hosek-wilkie, single-scattering, solver, "
    "sky-view, tables, air, light-map, first-light, dispatch, night, frame, frame-peers, window.",
)
@click.option(
    "--compare",
    metavar="OLD.json",
    help="The bench.json of an older run: name what has become slower or less accurate by more "
    "than the noise, and end with 1 if anything has.",
)
def bench(output: str, quick: bool, only: str | None, compare: str | None) -> None:
    """Measure run time against error of every way to compute each thing.

    The page, FOLDER/index.html, plots for each computation what its ways take against how far they
    are from their float64 or converged twin, and marks those that none beats in both. Beside it lie
    the plots, the tables as CSV and Markdown, and bench.json, which --compare takes.

    Slower is what was slower in each round than in any round of the older run, by more than a
    tenth, and is so again when timed anew; less accurate, whose error has grown by a twentieth.

    Example: vrut-lite bench --quick -o bench

    Example: vrut-lite bench --only solver,sky-view --compare older/bench.json
    """
    if find_spec("matplotlib") is None:
        raise UserError("the benchmark needs the extra `bench`: pip install 'vrut-lite-lab[bench]'")
    kinds = _registry.chosen_kinds(only)
    old = None if compare is None else _results.read_results(compare)
    if old is not None:
        _compare.check_comparable(old, quick, kinds)
    folder = _made(Path(output))
    results, refused = _measured(kinds, quick, old)
    _write(results, folder)
    click.echo(f"the page is {folder / 'index.html'}")
    for name, reason in refused.items():
        click.echo(f"{name} is left out: {reason}")
    if old is not None:
        _tell(old, results)
    if refused:
        raise ModuleFailed(f"{len(refused)} of the paths did not do their work")


def _made(folder: Path) -> Path:
    """The folder, made and checked to be writable before the long work."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot write {folder}: {error.strerror or error}") from error
    check_writable(folder / "index.html")
    return folder


def _measured(
    kinds: list[str], quick: bool, old: "Results | None"
) -> tuple["Results", dict[str, str]]:
    """The results and the refused paths, with reasons; apparently slower paths are timed again."""
    console = Console(stderr=True)
    with Progress(console=console, refresh_per_second=4, disable=not console.is_terminal) as bars:
        bar = bars.add_task("", total=None)
        session = _session.BenchSession(
            kinds, quick, lambda what: bars.update(bar, description=what)
        )
        try:
            session.measure()
            for _ in range(_TRIES if old is not None else 0):
                slower = _compare.slower_paths(old, session.results()) if old is not None else []
                if not slower:
                    break
                session.measure_again(set(slower))
            return session.results(), session.refused
        finally:
            _gl.close_gl()


def _write(results: "Results", folder: Path) -> None:
    for name, content in _page.files_of(results).items():
        with atomic_output(folder / name) as beside:
            beside.write_bytes(content)


def _tell(old: "Results", new: "Results") -> None:
    """Print the worse paths.

    Raises:
        ModuleFailed: something is.
    """
    found = _compare.compare(old, new)
    for sentence in (*found.remarks, *found.worse):
        click.echo(sentence)
    if found.worse:
        raise ModuleFailed(f"{len(found.worse)} worse than in the run of {old.machine.date}")
    click.echo(f"nothing is worse than in the run of {old.machine.date}")
