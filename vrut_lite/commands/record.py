"""`vrut-lite record`: play inputs to the modules, headless, and write a journal."""

from contextlib import closing
from datetime import datetime, timedelta
from itertools import count, takewhile
from typing import Any

import click

from vrut_lite.commands.headless_scene import add_headless_scene
from vrut_lite.commands.options import daylight_options, with_options
from vrut_lite.commands.scene_options import scene_options, with_scene_options
from vrut_lite.daylight_kernel import demand_light
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Fault, Input, Message, SetClock
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.place_time import parse_instant
from vrut_lite.project import (
    Project,
    daylight_inputs,
    project_of_path,
    setting_inputs,
    view_inputs,
)
from vrut_lite.recording.lines import read_inputs
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.registry import Registry
from vrut_lite.studio.number_types import FiniteRange, WholeRange
from vrut_lite.studio.open_kernel import open_kernel
from vrut_lite.studio.pictures import tell_notices
from vrut_lite.studio.progress import tracked
from vrut_lite.write_atomic import atomic_output, check_writable

MOST_STEPS = 100_000


@click.command(name="record")
@daylight_options
@scene_options
@click.argument("scene", required=False)
@click.option("-o", "--output", required=True, metavar="JOURNAL", help="An MCAP file.")
@click.option("--full", is_flag=True, help="Keep the content of arrays, not only their digests.")
@click.option("--inputs", metavar="FILE", help="JSON lines of inputs, as `vrut-lite dump` prints.")
@click.option("--from", "start", metavar="TIME", help="A day passes from here; as --at.")
@click.option("--to", "end", metavar="TIME", help="... to here.")
@click.option(
    "--step",
    "step_minutes",
    type=FiniteRange(0.01, 1440),
    default=60.0,
    show_default=True,
    metavar="MINUTES",
    help="... in steps of so long.",
)
@click.option(
    "--size",
    type=WholeRange(1, 4096),
    default=64,
    show_default=True,
    help="Edge of the sky's cube faces, in pixels.",
)
def record(
    scene: str | None,
    output: str,
    full: bool,
    inputs: str | None,
    start: str | None,
    end: str | None,
    step_minutes: float,
    size: int,
    **options: Any,
) -> None:
    """Record the modules' messages for a place, a time, settings, and a script of inputs.

    SCENE (glTF, GLB, OBJ, USD, or a project .toml) is opened and never drawn: no GPU is needed.
    Without SCENE only the modules run. After place, time and settings come the inputs of
    --inputs, then a day that passes.

    Example: vrut-lite record -o day.mcap --from 2026-06-21T04:00 --to 2026-06-21T22:00 --step 30
    """
    check_writable(output)
    plan = with_options(with_scene_options(project_of_path(scene), options), options)
    passing = _passing(plan, start, end, step_minutes)
    kernel = open_kernel()
    script: list[Input] = [*setting_inputs(plan, kernel), *daylight_inputs(plan)]
    if plan.scene:
        add_headless_scene(kernel)
        script += view_inputs(plan)
    if inputs is not None:
        modules = (seat.module_type for seat in kernel.seats.values())
        script += read_inputs(inputs, Registry(modules))
    faults = _collect_faults(kernel)
    with closing(kernel), atomic_output(output) as beside, beside.open("wb") as stream:
        recorder = Recorder(kernel, stream, full)
        demand_light(kernel, "record command", size)
        _play(kernel, [*script, *passing])
        recorder.close()
        opened = kernel.last(SceneOpened)
    tell_notices(opened.notices if opened else ())
    told = f", {len(faults)} of them faults, the first: {faults[0].error}" if faults else ""
    click.echo(f"{output}: {recorder.inputs} inputs and {recorder.messages} messages{told}")


def _passing(
    plan: Project, start: str | None, end: str | None, step_minutes: float
) -> list[SetClock]:
    """The clock's inputs from start to end, both included if the steps meet the end."""
    if start is None and end is None:
        return []
    if start is None or end is None:
        raise UserError("--from and --to go together: a day passes from one to the other")
    first, last = (parse_instant(text, plan.where()) for text in (start, end))
    step = timedelta(minutes=step_minutes)
    if not timedelta(0) <= last - first <= MOST_STEPS * step:
        raise UserError(
            f"from {start} to {end} by {step_minutes:g} minutes is no way forward of "
            f"{MOST_STEPS} steps at most: mend --from, --to or --step"
        )
    return [SetClock(instant=instant) for instant in _instants(first, last, step)]


def _instants(first: datetime, last: datetime, step: timedelta) -> list[datetime]:
    return list(takewhile(lambda instant: instant <= last, (first + i * step for i in count())))


def _play(kernel: Kernel, script: list[Input]) -> None:
    """One input after another, so that none replaces the one before it."""
    for message in tracked(script, "recording"):
        kernel.inject(message)
        kernel.pump_until_idle()


def _collect_faults(kernel: Kernel) -> list[Fault]:
    faults: list[Fault] = []

    def note(message: Message, sender: str) -> None:
        if isinstance(message, Fault):
            faults.append(message)

    kernel.tap(note)
    return faults
