"""Output of the command: tables, plans, a page, and lines for the terminal."""

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import msgspec
import numpy as np
from light_transport.public import Illumination

from daylight_numbers.glare.eyes import (
    METHOD,
    Eyes,
    eyes_of,
    glare_now,
    hour_table,
    write_views,
)
from daylight_numbers.lamps.lamp_pages import lamp_pages
from daylight_numbers.lamps.lighting import lighting_of
from daylight_numbers.matrix.sensors import SensorGrid, Sensors
from daylight_numbers.now import (
    TITLES,
    CieSky,
    cie_hour,
    daylight_factor,
    numbers_now,
    patch_error,
)
from daylight_numbers.opened_scene import OpenedScene
from daylight_numbers.pictures import PictureQuantity, plan_picture
from daylight_numbers.report import ReportPage, Table, write_report
from daylight_numbers.rooms import room_of
from daylight_numbers.spectra.spectra_file import NO_SPECTRA, MaterialSpectra
from daylight_numbers.spectra.spectral_pages import spectral_pages, spectral_year_pages
from daylight_numbers.spectra.spectral_sky import spectral_sky
from daylight_numbers.standards.site_change import SiteScene, scene_of
from daylight_numbers.standards.standards import clauses, facts_of, weather_of
from daylight_numbers.standards.standards import method as standards_method
from daylight_numbers.standards.sun_hours import STEP_MINUTES, sun_hours, suns_of_day
from daylight_numbers.standards.sun_range import SunRange, sun_range_pages
from daylight_numbers.work import DaylightWork, work_of
from daylight_numbers.year.totals import Period
from daylight_numbers.year_pages import Numbers, YearRequest, year_pages
from vrut_lite.headless import Project, busy_with, tracked, write_png
from vrut_lite.messages.glazing import GlazingFile
from vrut_lite.messages.lighting import LampPlacement
from vrut_lite.numeric_types import FloatArray
from vrut_lite.quantities import percent_text
from vrut_lite.write_atomic import atomic_output

_PICTURES = {
    "illuminance_lx": PictureQuantity("illuminance", "lx"),
    "daylight_factor_percent": PictureQuantity("daylight factor", "%"),
    "sun_h": PictureQuantity("hours of sun", "h", from_zero=True),
}


@dataclass(frozen=True, eq=False)
class DaylightRequest:
    """A request: project, sensors, tolerance, CIE sky; `blinds` is the transmittance of closed
    blinds; `spectra` of materials are used where light is `spectral`."""

    project: Project
    sensors: Sensors | SensorGrid
    tolerance: float
    cie_sky: CieSky
    ground_albedo: float
    year: bool
    standards: bool
    blinds: float
    eyes: Sensors | None
    sun_day: date
    lamps: Mapping[str, LampPlacement]
    spectral: bool = False
    spectra: MaterialSpectra = NO_SPECTRA
    before: Project | None = None
    sun_range: SunRange | None = None
    periods: Sequence[Period] = ()


class Measured(NamedTuple):
    """Report of the written files: a line for each plane, lines on what the scene lacks, and the
    files by name where a worker wrote them."""

    lines: list[str]
    notices: Sequence[str]
    files: dict[str, bytes]


class ReadyScene(NamedTuple):
    """A scene made ready, and how far patches twice as wide move daylight factors."""

    work: DaylightWork
    moved: float


def ready_scene(opened: OpenedScene, asked: DaylightRequest) -> ReadyScene:
    """Bake a request's scene and trace its sensors' rays.

    Raises:
        UserError: there are no work planes, sensors lie in walls, or measured glazing cannot be
            used.
    """
    project = asked.project
    work = work_of(
        opened.scene, asked.sensors, asked.tolerance, glazing=project.glazing, bsdf=project.bsdf
    )
    overcast = cie_hour(asked.cie_sky, asked.ground_albedo)
    factor, _ = daylight_factor(work.transport, work.glass, work.operator, work.sensors, overcast)
    return ReadyScene(
        work,
        patch_error(opened.scene, work, project.glazing, asked.tolerance, overcast, factor),
    )


def measured(
    folder: Path, asked: DaylightRequest, known: dict[bytes, ReadyScene] | None = None
) -> Measured:
    """Open a project's scene, compute and write into a folder.

    `known` has scenes made ready by their glazing; the request's is added.

    Raises:
        UserError: the scene cannot be read, or by `write_daylight`.
    """
    with busy_with(f"opening {asked.project.scene}"):
        opened = OpenedScene(asked.project)
    try:
        key = msgspec.json.encode((asked.project.glazing, asked.project.bsdf))
        known = {} if known is None else known
        if key not in known:
            known[key] = ready_scene(opened, asked)
        lines, warnings = write_daylight(folder, opened, asked, known[key])
        return Measured(lines, [*opened.scene.notices, *warnings], {})
    finally:
        opened.close()


def measured_variants(
    folders: Iterable[Path], wanted: Iterable[DaylightRequest]
) -> Iterator[Measured]:
    """Requests of one scene that differ by orientation and glazing: rays and exchange of one
    glazing serve all its orientations.

    Raises:
        UserError: by `measured`.
    """
    known: dict[bytes, ReadyScene] = {}
    for folder, asked in zip(folders, wanted, strict=True):
        yield measured(folder, asked, known)


def measured_elsewhere(asked: DaylightRequest) -> Measured:
    """The same by a worker, which hands over the files: it need not see their folder."""
    with TemporaryDirectory() as name:
        found = measured(Path(name), asked)
        files = {path.name: path.read_bytes() for path in sorted(Path(name).iterdir())}
        return found._replace(files=files)


def write_files(folder: Path, found: Measured) -> None:
    """Write a worker's files.

    Raises:
        UserError: one cannot be written.
    """
    for name, content in found.files.items():
        with atomic_output(folder / name) as beside:
            beside.write_bytes(content)


def write_daylight(
    folder: Path, opened: OpenedScene, asked: DaylightRequest, ready: ReadyScene
) -> tuple[list[str], list[str]]:
    """Compute and write; returns a line for each plane, and warnings of measured glazing.

    Raises:
        UserError: a file cannot be written.
    """
    work = ready.work
    # Hours of sun move the clock.
    hour = opened.hour()
    sky = spectral_sky(opened, hour) if asked.spectral else None
    numbers = _now(work, opened, hour, asked)
    tables = [_rooms_now(work.sensors, numbers)]
    pictures: dict[Path, str] = {}
    for name, quantity in _PICTURES.items():
        if np.any(work.sensors.cell >= 0) and np.any(numbers[name] > 0.0):
            path = folder / f"{name}.png"
            write_png(path, plan_picture(work.sensors, numbers[name], quantity))
            pictures[path] = f"{quantity.title.capitalize()} ({quantity.unit}), north (-z) up"
    factor = numbers["daylight_factor_percent"]
    method = _method(work, asked, ready.moved)
    lighting = None
    if asked.lamps:
        with busy_with("lamps"):
            lighting = lighting_of(
                work, opened.scene, asked.lamps, asked.project.lighting, hour.ground_albedo_rgb
            )
        of_lamps = lamp_pages(folder, work.sensors, lighting)
        numbers |= of_lamps.columns
        tables += of_lamps.tables
        pictures |= of_lamps.pictures
        method += of_lamps.method
    eyes = None
    if asked.eyes is not None:
        eyes = eyes_of(opened.scene, work, asked.eyes, asked.tolerance)
        glare = glare_now(eyes, hour)
        tables.append(hour_table(glare))
        pictures |= write_views(folder, glare)
        method.append(METHOD)
    arrays: dict[str, FloatArray] = {}
    if sky is not None:
        found_spectra, surfaces = spectral_pages(
            folder, opened, work, sky, asked.spectra, asked.tolerance
        )
        numbers |= found_spectra.columns
        arrays = found_spectra.arrays
        tables += found_spectra.tables
        pictures |= found_spectra.pictures
        method += found_spectra.method
    is_used = asked.year or asked.standards or asked.sun_range is not None
    planes = range(len(work.sensors.names)) if is_used else ()
    rooms = {plane: room for plane in planes if (room := room_of(work, plane)) is not None}
    if asked.sun_range is not None:
        columns, table = sun_range_pages(work, opened, rooms, asked.sun_range)
        numbers |= columns
        tables.append(table)
    of_year = None
    if asked.year:

        def steps(hours: Iterable[int], count: int) -> Iterable[int]:
            return tracked(hours, "year", count)

        def in_states(states: Mapping[str, int]) -> tuple[DaylightWork, Eyes | None]:
            bsdf, glazing = asked.project.bsdf, asked.project.glazing
            files = {name: one.in_state(states.get(name, 0)) for name, one in bsdf.items()}
            other = work_of(
                opened.scene, work.sensors, asked.tolerance, glazing=glazing, bsdf=files
            )
            if asked.eyes is None:
                return other, None
            return other, eyes_of(opened.scene, other, asked.eyes, asked.tolerance)

        wanted = YearRequest(
            rooms,
            asked.blinds,
            eyes,
            asked.sun_day,
            asked.project.bsdf,
            in_states,
            asked.periods,
            lighting,
        )
        found = year_pages(folder, work, opened, wanted, steps)
        of_year = found.found
        numbers |= found.columns
        tables += found.tables
        pictures |= found.pictures
        method += found.method
        if sky is not None:
            of_spectra = spectral_year_pages(folder, opened, work, surfaces, found, asked.tolerance)
            numbers |= of_spectra.columns
            tables += of_spectra.tables
            pictures |= of_spectra.pictures
            method += of_spectra.method
    write_tables(folder, work.sensors, numbers, arrays)
    where = asked.project
    weather = f", {Path(where.weather).name}" if where.weather else ""
    subtitle = (
        f"{where.at} at {where.place}; sky by {opened.source}{weather}; {len(work.sensors)} sensors"
    )
    title = f"Daylight of {Path(where.scene).stem}"
    write_report(folder / "report.html", ReportPage(title, subtitle, tables, pictures, method))
    held: list[Table] = []
    if asked.standards:
        former = None if asked.before is None else _former(asked.before, asked.project.bsdf)
        facts = facts_of(work, opened, rooms, of_year, asked.sun_day, factor, asked.cie_sky, former)
        held = clauses(facts)
        said = standards_method(weather_of(opened))
        page = ReportPage(f"{title}: compliance", subtitle, held, {}, said)
        write_report(folder / "compliance.html", page)
    lines = [
        f"{table.heading}: "
        + "; ".join(
            f"{row[0]}: "
            + ", ".join(
                f"{name} {cell}" for name, cell in zip(table.columns[1:], row[1:], strict=True)
            )
            for row in table.rows
        )
        for table in tables
    ] + [
        f"{table.heading}: {clause}, {subject}: {verdict}"
        for table in held
        for clause, subject, *_, verdict in table.rows
    ]
    hints = [*asked.spectra.notices(), *(() if lighting is None else lighting.warnings())]
    return lines, [*_warnings(work), *hints]


def _former(project: Project, bsdf: Mapping[str, GlazingFile]) -> SiteScene:
    """The scene before a change, whose measured panes are those of the scene after it too."""
    with busy_with(f"opening {project.scene}"):
        opened = OpenedScene(project)
    try:
        return scene_of(opened.scene, project.glazing, {*bsdf, *project.bsdf})
    finally:
        opened.close()


def _warnings(work: DaylightWork) -> list[str]:
    panes = work.operator.panes
    glazings = () if panes is None else panes.materials.glazings
    return [warning for glazing in glazings for warning in glazing.warnings()]


def _now(
    work: DaylightWork, opened: OpenedScene, hour: Illumination, asked: DaylightRequest
) -> Numbers:
    """Columns (P,) of the present hour, named with their units; errors are standard errors."""
    now = numbers_now(work, hour, asked.cie_sky, asked.ground_albedo)
    lux = now.light
    midnight = asked.project.instant().replace(hour=0, minute=0, second=0, microsecond=0)
    return {
        "illuminance_lx": lux.total,
        "illuminance_error_lx": lux.noise,
        "of_sun_lx": lux.sun,
        "of_sky_lx": lux.sky,
        "of_surfaces_lx": lux.surfaces,
        "daylight_factor_percent": now.daylight_factor_percent,
        "daylight_factor_error_percent": now.daylight_factor_error_percent,
        "sky_view": now.sky_view,
        "sun_h": sun_hours(work, work.sensors, suns_of_day(opened.place, midnight)),
    }


def _rooms_now(sensors: Sensors, numbers: Numbers) -> Table:
    rows = []
    for plane, name in enumerate(sensors.names):
        here = sensors.plane == plane
        lux, factor = numbers["illuminance_lx"][here], numbers["daylight_factor_percent"][here]
        noise = numbers["illuminance_error_lx"][here]
        factor_noise = numbers["daylight_factor_error_percent"][here]
        rows.append(
            [
                name,
                f"{here.sum()}",
                f"{lux.mean():,.0f} ± {_rms(noise):,.0f}",
                f"{lux.min():,.0f}",
                f"{lux.max():,.0f}",
                f"{factor.mean():.2f} ± {_rms(factor_noise):.2f}",
                f"{np.median(factor):.2f}",
                percent_text(numbers["sky_view"][here].mean(), 1),
                f"{numbers['sun_h'][here].mean():.1f}",
            ]
        )
    columns = [
        "plane", "sensors", "mean lx", "least lx", "most lx", "mean daylight factor %",
        "median daylight factor %", "sky view", "hours of sun",
    ]  # fmt: skip
    return Table("The hour, and an overcast sky", columns, rows)


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _method(work: DaylightWork, asked: DaylightRequest, moved: float) -> list[str]:
    transport = work.transport
    assert transport.patches is not None
    step = max(work.sensors.step_m)
    planes = (
        f"Sensors stand in cells of {step:.2f} m, facing up."
        if step > 0.0
        else "Sensors are those of a file."
    )
    return [
        planes,
        f"Daylight factor under {TITLES[asked.cie_sky]}, ground albedo {asked.ground_albedo:g}.",
        f"{work.operator.rays:,.0f} rays from each sensor in two halves; after ± stands a sensor's "
        "standard error (rms) by the difference of the halves.",
        f"Bounces between {len(transport.patches.area):,} patches of Lambert's surfaces, "
        f"{transport.rays} rays from each of {len(transport.texels.pixel):,} texels "
        "(docs/light.md). "
        f"Patches twice as wide move daylight factors by {percent_text(moved, 1)} of their mean, "
        "rms.",
        "Glass passes light by the angle at which a sensor sees through it; bounces by its mean.",
        *_of_panes(work),
        f"Hours of sun of the day in steps of {STEP_MINUTES} minutes.",
        f"{'Lamps count apart' if asked.lamps else 'Lamps are off'}. Mirrors throw no sun.",
    ]


def _of_panes(work: DaylightWork) -> list[str]:
    """Sentences on measured glazing."""
    panes = work.operator.panes
    if panes is None:
        return []
    sentences = []
    for name, glazing in zip(panes.materials.names, panes.materials.glazings, strict=True):
        normal = glazing.hemispherical[0], glazing.straight[0]
        sentences.append(
            f"{name} is {glazing.name} ({glazing.incident.name}): it passes "
            f"{percent_text(normal[0], 1)} of visible light at right angles, of all light "
            f"{percent_text(normal[1], 1)} straight on; the rest is scattered, sunlight too, which "
            "counts as light of surfaces."
        )
    return sentences


def write_tables(
    folder: Path,
    sensors: Sensors,
    numbers: Mapping[str, FloatArray],
    more: Mapping[str, FloatArray],
) -> None:
    """Write `sensors.csv` and `sensors.npz`; columns (P,) are named with their units, and `more`
    are in the second alone.

    Raises:
        UserError: a file cannot be written.
    """
    names = ["plane", "x_m", "y_m", "z_m", "direction_x", "direction_y", "direction_z", *numbers]
    columns = [
        [sensors.names[plane] for plane in sensors.plane],
        *(sensors.places_m.T),
        *(sensors.normals.T),
        *numbers.values(),
    ]
    with (
        atomic_output(folder / "sensors.csv") as beside,
        beside.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.writer(file)
        writer.writerow(names)
        for row in zip(*columns, strict=True):
            writer.writerow([v if isinstance(v, str) else f"{float(v):.6g}" for v in row])
    with atomic_output(folder / "sensors.npz") as beside, beside.open("wb") as stream:
        arrays: dict[str, Any] = {
            "plane": sensors.plane,
            "plane_names": np.array(sensors.names),
            "places_m": sensors.places_m,
            "directions": sensors.normals,
            **numbers,
            **more,
        }
        np.savez_compressed(stream, **arrays)
