"""`vrut-lite daylight`: illuminance, daylight factors and a year at sensors of a scene."""

from collections.abc import Iterable
from datetime import datetime
from pathlib import Path
from typing import Any

import click
import msgspec

from daylight_numbers.glazing.window_xml import read_window_xml
from daylight_numbers.lamps.lamp_places import read_lamps
from daylight_numbers.matrix.sensors import SensorGrid, read_sensors
from vrut_lite.errors import UserError
from vrut_lite.headless import (
    FiniteRange,
    Project,
    daylight_options,
    project_of_path,
    read_luminaire_file,
    scene_options,
    tell_notices,
    tracked,
    with_options,
    with_scene_options,
    worker_options,
    workers_of,
)
from vrut_lite.lazy import lazy
from vrut_lite.messages.glazing import GlazingFile
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE
from vrut_lite.plain_numbers import plain_float
from vrut_lite.write_atomic import make_folder

# scipy takes a third of a second to import, which --help need not wait for.
_folder = lazy("daylight_numbers.folder")
_spectra_file = lazy("daylight_numbers.spectra.spectra_file")
_state_schedule = lazy("daylight_numbers.state_schedule")
_sun_range = lazy("daylight_numbers.standards.sun_range")
_totals = lazy("daylight_numbers.year.totals")
_variants = lazy("daylight_numbers.variants")
_year_light = lazy("daylight_numbers.year.year_light")


@click.command(name="daylight")
@daylight_options
@scene_options
@click.argument("scenes", nargs=-1, required=True, metavar="SCENE...")
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="FOLDER",
    help="Made if missing; of several scenes each gets a folder in it, by its name.",
)
@click.option(
    "--sensors",
    metavar="FILE",
    help="A .csv of points x,y,z[,dx,dy,dz] in metres, in the scene's axes, y up. Default: level "
    "grids in its rooms, or on open ground where it has none.",
)
@click.option(
    "--grid",
    "step_m",
    type=FiniteRange(0.01, 100.0),
    default=0.5,
    show_default=True,
    help="Edge of a grid's cells, in metres; wider where there would be more than 1,000 points.",
)
@click.option(
    "--height",
    "height_m",
    type=FiniteRange(0.0, 10.0),
    default=0.85,
    show_default=True,
    help="Of grids above floors, in metres.",
)
@click.option(
    "--cie-sky",
    type=click.Choice(["16", "1", "5"]),
    default="16",
    show_default=True,
    help="Of the daylight factor: CIE's traditional overcast sky (16), its type 1, or even (5).",
)
@click.option(
    "--ground-albedo",
    type=FiniteRange(0.0, 1.0),
    default=0.2,
    show_default=True,
    help="Of the ground under a CIE sky.",
)
@click.option(
    "--eyes",
    metavar="FILE",
    help="A .csv of eyes x,y,z,dx,dy,dz: where they are and look. Adds glare.",
)
@click.option(
    "--blinds",
    type=FiniteRange(0.0, 1.0),
    default=0.05,
    show_default=True,
    help="What closed blinds let through, evenly, in a year's sDA.",
)
@click.option(
    "--sun-day",
    type=click.DateTime(["%m-%d"]),
    default="03-21",
    show_default=True,
    metavar="MM-DD",
    help="Of EN 17037's hours of sun in a year: 02-01 to 03-21.",
)
@click.option(
    "--sun-range",
    metavar="DATE..DATE",
    help="Hours of sun a day from the first to the last day, as 2026-02-08..2026-10-20: mean, "
    "least and most, of sensors and windows.",
)
@click.option(
    "--bsdf",
    "bsdf",
    multiple=True,
    metavar="MATERIAL=FILE",
    help="Measured glazing of a material: a Window XML of LBNL, in which front is outdoors. Repeat "
    "it for several materials, and for states of a blind that moves, the open one first.",
)
@click.option(
    "--bsdf-rule",
    "bsdf_rule",
    multiple=True,
    metavar="MATERIAL=RULE",
    help="By what a blind moves in a year: sun:LUX[,LUX...][@DEGREES], closed by so much direct "
    "sun on its panes, within an angle to their normal; schedule:FILE, a .csv of states by 12 "
    "months and 24 hours or by 8,760 hours; or glare, closed while the DGP of one of --eyes is "
    "above 0.40.",
)
@click.option(
    "--bsdf-up",
    metavar="X,Y,Z",
    help="What is up in the files of --bsdf, in the scene's axes. Default: 0,1,0, or a project's.",
)
@click.option(
    "--lamps",
    metavar="FILE",
    help="A .csv of luminaires file,x,y,z[,dx,dy,dz,rotation_deg,group], in place of a project's "
    "[lamp] tables; files are IES or EULUMDAT. Adds their light, and their energy in a year.",
)
@click.option(
    "--spectral",
    is_flag=True,
    help="Light by wavelength too: melanopic and the other EDI of CIE S 026, CCT and Duv.",
)
@click.option(
    "--spectra",
    metavar="FILE",
    help="A .csv of spectra of materials: wavelength_nm and a column a name, shares from 0 to 1. "
    "For --spectral.",
)
@click.option(
    "--variants",
    metavar="FILE",
    help="A .toml of variants of one scene by name: north_offset_deg, glazing, bsdf. Each gets a "
    "folder; orientations share rays.",
)
@click.option("--year", is_flag=True, help="A year too, hour by hour, under the same sky.")
@click.option(
    "--totals",
    metavar="month|DAY..DAY",
    help="Doses of a year, and radiation by --weather, for each month or for a range such as "
    "04-01..09-30: totals.csv, a row for each sensor and period.",
)
@click.option(
    "--standards",
    is_flag=True,
    help="A page of EN 17037, BRE 209, LEED v4.1 and WELL too, clause by clause; with --year and "
    "--weather all of them.",
)
@click.option(
    "--before",
    metavar="FILE",
    help="The scene or project before a new building, in the same axes: --standards then has "
    "BRE 209's losses of skylight and sunlight.",
)
@worker_options
def daylight(
    scenes: tuple[str, ...],
    output: str,
    sensors: str | None,
    step_m: float,
    height_m: float,
    cie_sky: Any,
    ground_albedo: float,
    blinds: float,
    eyes: str | None,
    sun_day: datetime,
    sun_range: str | None,
    bsdf: tuple[str, ...],
    bsdf_up: str | None,
    lamps: str | None,
    spectral: bool,
    spectra: str | None,
    bsdf_rule: tuple[str, ...],
    variants: str | None,
    year: bool,
    totals: str | None,
    standards: bool,
    before: str | None,
    jobs: int,
    dask: str | None,
    **options: Any,
) -> None:
    """Measure the daylight of scenes: lux of an hour, daylight factors, hours of sun, a year.

    FOLDER gets report.html, sensors.csv and sensors.npz with a row for each sensor and an error
    beside what has one, plans in false colours, and heat maps of the year.

    Example: vrut-lite daylight scenes/work/indoor.glb -o room --at 2026-03-21T12:00

    Example: vrut-lite daylight room.glb -o room --sensors desks.csv --cie-sky 1

    Example: vrut-lite daylight room.glb -o room --year --weather prague.epw

    Example: vrut-lite daylight room.glb -o room --year --weather prague.epw --standards

    Example: vrut-lite daylight new.glb -o loss --standards --before old.glb --weather prague.epw

    Example: vrut-lite daylight room.glb -o room --bsdf glass=blind.xml

    Example: vrut-lite daylight room.glb -o room --year --lamps lamps.csv

    Example: vrut-lite daylight room.glb -o room --spectral --sensors eyes.csv

    Example: vrut-lite daylight room.glb -o room --year --bsdf glass=open.xml --bsdf glass=shut.xml
    --bsdf-rule glass=sun:5000

    Example: vrut-lite daylight room.glb -o turned --year --variants sides.toml

    Example: vrut-lite daylight variants/*.glb -o variants --year --jobs 4
    """
    projects = [
        with_options(with_scene_options(project_of_path(scene), dict(options)), dict(options))
        for scene in scenes
    ]
    if before and not standards:
        raise UserError("--before needs --standards, whose page says what was lost")
    if totals is not None and not year:
        raise UserError("--totals are those of a year: add --year")
    periods = () if totals is None else _totals.parse_totals(totals)
    if bsdf_rule and not year:
        raise UserError("--bsdf-rule moves blinds in a year: add --year")
    former = None if before is None else project_of_path(before)
    if former is not None:
        former = with_scene_options(former, dict(options))
    days = None if sun_range is None else _sun_range.parse_sun_range(sun_range)
    projects = [with_bsdf(project, bsdf, bsdf_up, bsdf_rule) for project in projects]
    names = tuple(Path(scene).stem for scene in scenes)
    if variants is not None:
        if len(scenes) > 1 or jobs > 1 or dask:
            raise UserError("--variants are of one scene in one process: name one, without --jobs")
        of_names = _variants.read_variants(variants)
        names = tuple(of_names)
        projects = [variant.applied(projects[0]) for variant in of_names.values()]
    panes = [glazing for project in projects for glazing in project.bsdf.values()]
    for file in {file for glazing in panes for file in glazing.states}:
        read_window_xml(file)
    for glazing in panes:
        if glazing.by == "schedule":
            _state_schedule.read_schedule(glazing.schedule, len(glazing.states))
    placed = None if lamps is None else read_lamps(lamps)
    told_lamps = [project.lamp if placed is None else placed for project in projects]
    for project, of_lamps in zip(projects, told_lamps, strict=True):
        if project.lighting and not of_lamps:
            raise UserError(
                "the project has [lighting] but no lamps: add [lamp] tables, or --lamps FILE"
            )
    for file in {one.file for told in told_lamps for one in told.values() if one.file}:
        read_luminaire_file(file)
    looking = read_sensors(eyes) if eyes else None
    if looking is None and any(glazing.by == "glare" for glazing in panes):
        raise UserError("bsdf: a blind that moves by glare needs eyes: give a file by --eyes")
    if spectra and not spectral:
        raise UserError("--spectra is of light by wavelength: add --spectral")
    if spectral and panes:
        raise UserError(
            "a bsdf has no spectrum: leave out --spectral, or give the glass's by --spectra"
        )
    of_materials = _spectra_file.read_spectra(spectra) if spectra else _spectra_file.NO_SPECTRA
    day = sun_day.date().replace(year=_year_light.YEAR)
    if not (2, 1) <= (day.month, day.day) <= (3, 21):
        raise UserError(f"--sun-day {day:%m-%d} is not from 02-01 to 03-21, as EN 17037 asks")
    wanted = []
    for project, of_lamps in zip(projects, told_lamps, strict=True):
        told = project.sensors if sensors is None else sensors
        chosen = read_sensors(told) if told else SensorGrid(height_m, step_m)
        tolerance = DEFAULT_TOLERANCE if project.tolerance is None else project.tolerance
        wanted.append(
            _folder.DaylightRequest(
                project,
                chosen,
                tolerance,
                cie_sky,
                ground_albedo,
                year,
                standards,
                blinds,
                looking,
                day,
                of_lamps,
                spectral,
                of_materials,
                former,
                days,
                periods,
            )
        )
    # Last, so that a refusal leaves no folder.
    folders = _folders(Path(output), names, is_each=variants is not None or len(scenes) > 1)
    with workers_of(jobs, dask, len(wanted)) as workers:
        found: Iterable[Any]
        if variants is not None:
            found = _folder.measured_variants(folders, wanted)
        elif workers is None:
            found = map(_folder.measured, folders, wanted)
        else:
            made = workers.map(_folder.measured_elsewhere, wanted)
            found = tracked(made, "scenes", len(wanted))
        for folder, done in zip(folders, found, strict=True):
            tell_notices(done.notices)
            _folder.write_files(folder, done)
            click.echo("\n".join([*done.lines, f"the page is {folder / 'report.html'}"]))


def with_bsdf(
    project: Project, told: tuple[str, ...], up: str | None = None, rules: tuple[str, ...] = ()
) -> Project:
    """A project with measured glazing as options tell: MATERIAL=FILE, a file for each state; what
    is up in them; and MATERIAL=RULE of blinds that move.

    Raises:
        UserError: one is not of this form, or files and rules do not fit each other.
    """
    if up is not None and not told:
        raise UserError("--bsdf-up needs files of measured glazing: name some by --bsdf")
    files: dict[str, list[str]] = {}
    for text in told:
        name, _, file = text.partition("=")
        if not name or not file:
            raise UserError(f"--bsdf {text} is not MATERIAL=FILE, such as glass=blind.xml")
        files.setdefault(name, []).append(file)
    fields: dict[str, dict[str, Any]] = {
        name: {"file": first, "closed": tuple(closed)} for name, (first, *closed) in files.items()
    }
    for text in rules:
        name, rule = _rule(text)
        if name not in fields:
            if name not in project.bsdf:
                raise UserError(f"--bsdf-rule {text}: name the files of {name} by --bsdf")
            known = project.bsdf[name]
            fields[name] = {"file": known.file, "closed": known.closed}
        fields[name] |= rule
    found = dict(project.bsdf)
    for name, values in fields.items():
        values["up"] = found[name].up if name in found else (0.0, 1.0, 0.0)
        if up is not None:
            values["up"] = _vector(up)
        try:
            found[name] = GlazingFile(**values)
        except ValueError as error:
            raise UserError(f"--bsdf of {name}: {error}") from None
    return msgspec.structs.replace(project, bsdf=found)


def _rule(text: str) -> tuple[str, dict[str, Any]]:
    """A material and the fields of its rule."""
    name, _, rule = text.partition("=")
    kind, _, rest = rule.partition(":")
    try:
        if name and kind == "schedule" and rest:
            return name, {"by": "schedule", "schedule": rest}
        if name and rule == "glare":
            return name, {"by": "glare"}
        if name and kind == "sun":
            limits, at, angle = rest.partition("@")
            fields: dict[str, Any] = {"by": "sun"}
            fields["sun_lx"] = tuple(map(plain_float, limits.split(",")))
            return name, fields | ({"within_deg": plain_float(angle)} if at else {})
    except ValueError:
        pass
    raise UserError(
        f"--bsdf-rule {text} is not MATERIAL=RULE, such as glass=sun:5000 or "
        "glass=schedule:blinds.csv"
    )


def _vector(text: str) -> tuple[float, float, float]:
    try:
        x, y, z = map(plain_float, text.split(","))
        GlazingFile("", (x, y, z))
    except ValueError:
        raise UserError(
            f"--bsdf-up {text} is not X,Y,Z, three numbers that are not all 0, such as 0,1,0"
        ) from None
    return x, y, z


def _folders(output: Path, names: tuple[str, ...], is_each: bool) -> list[Path]:
    """The output, or a folder in it for each scene or variant, made.

    Raises:
        UserError: one cannot be made, or two have one name.
    """
    folders = [output / name for name in names] if is_each else [output]
    if len(set(folders)) < len(folders):
        raise UserError("two scenes have one name: measure them into folders of their own")
    for folder in folders:
        make_folder(folder)
    return folders
