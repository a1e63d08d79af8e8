"""`vrut-lite demo`: every bundled scene at four hours of a day, and a contact sheet of them."""

import os
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING

import click
import msgspec
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from vrut_lite.bundled.examples import example_named
from vrut_lite.commands.options import at_weather
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import SetClock
from vrut_lite.pictures.image_files import check_writable, write_png
from vrut_lite.place_time import local_text, time_zone_at
from vrut_lite.project import (
    PROJECT_ENDING,
    PROJECT_SUFFIX,
    Project,
    daylight_inputs,
    load_project,
    setting_inputs,
    view_inputs,
)
from vrut_lite.studio.open_kernel import open_host, require_sky, require_sun
from vrut_lite.studio.picture_metadata import picture_metadata
from vrut_lite.studio.progress import advancing_bar
from vrut_lite.studio.time_span import at_instant
from vrut_lite.write_atomic import make_folder

if TYPE_CHECKING:
    from vrut_lite.host import Host

SCENE_SUFFIXES = (".glb", ".gltf", ".obj")
# An example beside the other three, and the end of a project's name before its suffix.
_FIRST, _MARK = "street", PROJECT_ENDING.removesuffix(PROJECT_SUFFIX)
PLACE = "50.0875,14.4213,190"
DAY = "2026-05-21"
_THUMBNAIL = (480, 270)
_CAPTION_PX = 24
_STEP = timedelta(minutes=2)
_SUNRISE_DEG, _LATE_DEG, _DUSK_DEG = 2.0, 14.0, -4.0


@click.command(name="demo")
@click.option("--out", default="out", show_default=True, metavar="FOLDER", help="Made if missing.")
@click.option("--scenes", metavar="FOLDER", help="Instead of four scenes of the program.")
@click.option(
    "--weather",
    metavar="FILE.epw",
    help="A year of weather: its place instead of Prague, and the sky of its hours.",
)
def demo(out: str, scenes: str | None, weather: str | None) -> None:
    """Render all scenes of a folder at sunrise, noon, late afternoon and dusk in Prague.

    Example: vrut-lite demo --out out
    """
    projects = scene_projects(Path(scenes) if scenes else example_named(_FIRST).opens.parent)
    prague = Project(place=PLACE, at=DAY + "T00:00")
    where = prague if weather is None else at_weather(prague, weather)
    folder = Path(out)
    make_folder(folder)
    check_writable(folder / "contact_sheet.png")
    hours = _hours(where)
    with advancing_bar("pictures", len(hours) * len(projects)) as advance:
        rows = []
        for name, scene in projects.items():
            project = msgspec.structs.replace(scene, place=where.place, weather=where.weather)
            # A host for each scene, so that no setting reaches the next.
            with open_host() as host:
                host.inject(*setting_inputs(project, host.kernel), *view_inputs(project))
                row = []
                for hour, instant in hours.items():
                    row.append(_draw_hour(host, folder, name, hour, at_instant(project, instant)))
                    advance(1)
            rows.append(row)
    write_png(folder / "contact_sheet.png", contact_sheet(rows))
    click.echo(f"{sum(map(len, rows))} pictures and contact_sheet.png are in {folder}")


def scene_projects(folder: Path) -> dict[str, Project]:
    """By name: the project files of a folder, and its scenes that have no project file.

    Raises:
        UserError: there is neither, or a project file cannot be read.
    """
    files = sorted(folder.glob("*")) if os.path.isdir(folder) else []
    projects = {
        f.name[: -len(PROJECT_SUFFIX)].removesuffix(_MARK): load_project(f)
        for f in files
        if f.suffix.lower() == PROJECT_SUFFIX
    }
    scenes = [f for f in files if f.suffix.lower() in SCENE_SUFFIXES and f.stem not in projects]
    stems = [scene.stem for scene in scenes]
    for scene in scenes:
        name = scene.stem if stems.count(scene.stem) == 1 else scene.name
        projects[name] = Project(scene=str(scene))
    if not projects:
        raise UserError(f"no scene in {folder}: name a folder of scenes by --scenes")
    return dict(sorted(projects.items()))


def _draw_hour(
    host: "Host", folder: Path, name: str, hour: str, project: Project
) -> tuple[str, Image.Image]:
    """Write one picture; its caption and a thumbnail for the contact sheet."""
    host.inject(*daylight_inputs(project))
    host.settle()
    require_sky(host.kernel)
    picture = host.draw()
    path = folder / f"{name}_{hour.replace(' ', '_')}.png"
    write_png(path, picture.display, picture_metadata(project, host.kernel))
    caption = f"{name}, {hour}: {local_text(project.instant(), project.where())}"
    thumbnail = Image.fromarray(picture.display).resize(_THUMBNAIL, Image.Resampling.LANCZOS)
    return caption, thumbnail


def contact_sheet(rows: list[list[tuple[str, Image.Image]]]) -> np.ndarray:
    """One picture (h, w, 3) uint8 of captioned thumbnails, a row each."""
    width, height = _THUMBNAIL
    pitch = height + _CAPTION_PX
    sheet = Image.new("RGB", (width * max(map(len, rows)), pitch * len(rows)), (24, 24, 24))
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(15)
    for i, row in enumerate(rows):
        for j, (caption, thumbnail) in enumerate(row):
            sheet.paste(thumbnail, (j * width, i * pitch + _CAPTION_PX))
            pen.text((j * width + 6, i * pitch + 3), caption, (230, 230, 230), font=font)
    return np.asarray(sheet)


def _hours(project: Project) -> dict[str, datetime]:
    """The four hours at a project's place, found on a kernel without a demand for skies."""
    kernel, _ = daylight_kernel()
    kernel.inject(daylight_inputs(project)[0])
    midnight = datetime.fromisoformat(DAY).replace(tzinfo=time_zone_at(project.where()))
    return hours_of_day(kernel, midnight)


def hours_of_day(kernel: Kernel, midnight: datetime) -> dict[str, datetime]:
    """Instants of sunrise, noon, late afternoon and dusk in the 24 hours after `midnight`.

    Found from the holder of the sun in steps of two minutes: at sunrise and dusk the geometric
    elevation is nearest to 2 and -4 degrees, in late afternoon to 14. Under a midnight sun the
    nearest elevations are taken.
    """
    instants = [midnight + i * _STEP for i in range(int(timedelta(days=1) / _STEP))]
    elevation_deg = np.array([_elevation_deg(kernel, instant) for instant in instants])
    noon = int(np.argmax(elevation_deg))
    before, after = elevation_deg[: noon + 1], elevation_deg[noon:]
    return {
        "sunrise": instants[_nearest(before, _SUNRISE_DEG)],
        "noon": instants[noon],
        "late afternoon": instants[noon + _nearest(after, _LATE_DEG)],
        "dusk": instants[noon + _nearest(after, _DUSK_DEG)],
    }


def _nearest(elevation_deg: np.ndarray, wanted_deg: float) -> int:
    return int(np.argmin(np.abs(elevation_deg - wanted_deg)))


def _elevation_deg(kernel: Kernel, instant: datetime) -> float:
    kernel.inject(SetClock(instant=instant))
    kernel.pump()
    return float(np.degrees(require_sun(kernel).elevation_rad))
