"""`vrut-lite study`: integration rules and sky models against truth and measurements."""

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console
from rich.progress import Progress

from vrut_lite.errors import UserError
from vrut_lite.lazy import lazy

if TYPE_CHECKING:
    from vrut_lite_lab.study.report.folder import Folder
    from vrut_lite_lab.study.report.study import StudyPlan

# They need libraries that `--help` need not wait for.
_choices = lazy("vrut_lite_lab.study.report.choices")
_day = lazy("vrut_lite_lab.study.framework.day")
_folder = lazy("vrut_lite_lab.study.report.folder")
_measurements = lazy("vrut_lite_lab.study.framework.measurements")
_moments = lazy("vrut_lite_lab.study.report.moments")
_panels = lazy("vrut_lite_lab.study.report.panels")
_peers = lazy("vrut_lite_lab.study.peers.page")
_study = lazy("vrut_lite_lab.study.report.study")
_truth = lazy("vrut_lite_lab.study.rules.against_truth")
_TIMES, _QUICK_TIMES = "06:00,06:35,07:00,08:00,09:30,11:45", "06:00,06:35,08:00,11:45"


@click.command(name="study")
@click.option(
    "-o", "--output", default="study", show_default=True, metavar="FOLDER", help="Made if missing."
)
@click.option(
    "--quick", is_flag=True, help="Smaller pictures of fewer times and models: about a minute."
)
@click.option(
    "--measurements",
    metavar="PATH",
    help="Measured skies of Kider et al. 2014 to compare with: a scan's folder, a folder of "
    "those, a .7z or an .npz; of another day beside a file day.toml. Without them everything is "
    "held against a computed reference.",
)
@click.option(
    "--models",
    metavar="NAMES",
    help="Instead of all: as bruneton,preetham,simpson-16x8,gauss-legendre-8.",
)
@click.option(
    "--times",
    metavar="HH:MM,...",
    help="Rows of the figures, hours of the measured day, or of 27 May 2013 in Ithaca. "
    f"[default: {_TIMES}]",
)
@click.option(
    "--peers",
    is_flag=True,
    help="Instead: skies of Blender, Radiance, mitsuba and ours against one truth; half an hour.",
)
def study(
    output: str,
    quick: bool,
    measurements: str | None,
    models: str | None,
    times: str | None,
    peers: bool,
) -> None:
    """Compare integration rules and sky models; write a page with figures and tables.

    The page, FOLDER/index.html, has the figures 2 to 6 of Gałaj and Wojciechowski 2019 for any
    models and times, RMSE and relative errors, and the rules held against the integral itself,
    with run times. Figures lie beside it as PNG, tables as CSV.

    Example: vrut-lite study --quick -o study

    Example: vrut-lite study --measurements scans/ --models oneil,simpson-16x8 --times 06:35,11:45

    Example: vrut-lite study --peers -o peers
    """
    if find_spec("matplotlib") is None:
        raise UserError("the study needs the extra `studies`: pip install 'vrut-lite-lab[studies]'")
    if peers and (measurements or models or times):
        raise UserError("--peers goes with --quick and --output alone")
    if peers:
        _write(output, _peers.steps(), lambda folder, tell: _peers.write_peers(folder, quick, tell))
    else:
        plan = _plan(quick, measurements, models, times)
        _write(output, plan.steps(), lambda folder, tell: _study.write_study(plan, folder, tell))
    click.echo(f"the page is {Path(output) / _folder.PAGE}")


def _write(
    output: str, steps: int, write: Callable[["Folder", Callable[[str], None]], None]
) -> None:
    """Run one of the studies, its files in a folder, its progress on a bar."""
    console = Console(stderr=True)
    with (
        _folder.study_folder(Path(output)) as folder,
        Progress(console=console, refresh_per_second=4, disable=not console.is_terminal) as bars,
    ):
        bar = bars.add_task("", total=steps)

        def tell(what: str) -> None:
            bars.update(bar, description=what, advance=1)

        write(folder, tell)


def _plan(
    quick: bool, measurements: str | None, models: str | None, times: str | None
) -> "StudyPlan":
    sets = [_choices.chosen_set(models.split(","))] if models else _choices.usual_sets(quick)
    measured = _measurements.read_measurements(Path(measurements)) if measurements else []
    day = measured[0].day if measured else _day.KIDER
    # On another day nothing was published: all its times are shown, or some of them.
    usual = _QUICK_TIMES if quick else _TIMES
    if day != _day.KIDER:
        labels = [moment.label for moment in _moments.measured_moments(measured)]
        usual = ",".join(labels[:: -(-len(labels) // (4 if quick else 6))])
    shown = _moments.moments((times or usual).split(","), measured)
    published = bool(measured) and not models and day == _day.KIDER
    table_two = _truth.SAMPLES[: 2 if quick else 3] if published else ()
    return _study.StudyPlan(
        day=day,
        sets=_choices.sets_on_day(sets, day),
        moments=shown,
        scored=_moments.measured_moments(measured) or shown,
        physics=_choices.on_day(_choices.physics(), day),
        size=_panels.TILE // 2 if quick else _panels.TILE,
        table_two=table_two,
        timed_suns_deg=_study.TIMED_SUNS_DEG[: 1 if quick else 2],
        changes=_choices.changed_air() if published and not quick else (),
    )
