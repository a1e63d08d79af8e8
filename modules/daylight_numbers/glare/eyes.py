"""Glare at eyes: columns, a table and pictures for the command's folder."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from light_transport.public import Illumination, surfaces_of
from numpy.typing import NDArray
from PIL import Image

from daylight_numbers.glare.eye_view import EDGE_PX, Eye, EyeView, eye_view
from daylight_numbers.glare.glare import EN_GLARE, THRESHOLD, Glare, en_level, glare_of
from daylight_numbers.glare.mirrored_sun import Flats, flats_of
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.now import hour_at_sensors
from daylight_numbers.pictures import LEGEND_PX, PictureQuantity, draw_legend
from daylight_numbers.report import Table
from daylight_numbers.work import RAYS_SHARE, DaylightWork
from daylight_numbers.year.year_light import YearLight
from vrut_lite.geometry.false_colours import UNUSED, coloured, scale_of
from vrut_lite.headless import write_png
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import FloatArray
from vrut_lite.quantities import CD_M2, percent_text

_MOST_PICTURES = 4


class Eyes(NamedTuple):
    """Eyes as the sensors of a `DaylightWork`, and what mirrors the sun to them."""

    work: DaylightWork
    flats: Flats


def eyes_of(scene: SceneOpened, work: DaylightWork, eyes: Sensors, tolerance: float) -> Eyes:
    """Eyes in a scene that is baked.

    Raises:
        UserError: an eye lies inside a body.
    """
    transport = work.transport
    operator = operator_of(
        transport,
        work.glass,
        eyes,
        RAYS_SHARE * tolerance,
        transport.threads,
        bounces=work.operator.bounces,
    )
    return Eyes(
        DaylightWork(transport, work.glass, eyes, operator), flats_of(scene, surfaces_of(scene))
    )


def glare_now(eyes: Eyes, hour: Illumination) -> list[tuple[Glare, EyeView]]:
    """Glare of an hour at each eye, and what the eye sees."""
    work = eyes.work
    lit = hour_at_sensors(work.transport, work.glass, work.operator, work.sensors, hour)
    found = []
    for place, towards, lux in zip(
        work.sensors.places_m, work.sensors.normals, lit.total, strict=True
    ):
        eye, bounces = Eye(place, towards), work.operator.bounces
        view = eye_view(work.transport, work.glass, eyes.flats, eye, hour, bounces)
        found.append((glare_of(view, float(lux)), view))
    return found


def hour_table(found: list[tuple[Glare, EyeView]]) -> Table:
    """The hour's numbers, an eye a row."""
    rows = [
        [
            f"eye {n + 1}",
            f"{glare.dgp:.2f}",
            f"{glare.vertical_lx:,.0f}",
            f"{view.luminance.max():,.0f}",
            f"{len(view.sun_directions)}",
        ]
        for n, (glare, view) in enumerate(found)
    ]
    columns = ["eye", "DGP", "vertical lx", f"brightest surface or sky {CD_M2}", "suns in view"]
    return Table("Glare in the hour", columns, rows)


def glare_table(of_eyes: FloatArray, light: YearLight) -> Table:
    """Shares of hours with glare by DGP (P, H), and EN 17037's level, an eye a row."""
    rows = []
    for n, dgp in enumerate(of_eyes):
        level, shares = en_level(dgp, light)
        rows.append([f"eye {n + 1}", level, *(percent_text(share, 1) for share in shares)])
    columns = [
        "eye",
        "EN 17037 protection from glare",
        *(f"DGP above {limit:.2f}" for _, limit in EN_GLARE),
    ]
    return Table("Glare, share of 8:00 to 18:00", columns, rows)


def write_views(folder: Path, found: list[tuple[Glare, EyeView]]) -> dict[Path, str]:
    """Writes the views of the first eyes in false colours; returns captions by file."""
    pictures = {}
    for n, (glare, view) in enumerate(found[:_MOST_PICTURES]):
        path = folder / f"eye_{n + 1}.png"
        write_png(path, view_picture(view))
        pictures[path] = f"Luminance seen by eye {n + 1}, DGP {glare.dgp:.2f}"
    return pictures


def view_picture(view: EyeView) -> NDArray[np.uint8]:
    """An angular fisheye (h, w, 3) of luminances in false colours, with a legend."""
    field: FloatArray = np.full((EDGE_PX, EDGE_PX), np.nan)
    row, column = view.pixel.T
    field[row, column] = view.luminance
    scale = scale_of(view.luminance)
    sheet = Image.new("RGB", (EDGE_PX + 32, EDGE_PX + 32 + LEGEND_PX), UNUSED)
    sheet.paste(Image.fromarray(coloured(field, scale)), (16, 16))
    draw_legend(sheet, scale, PictureQuantity("luminance", CD_M2))
    return np.asarray(sheet, np.uint8).copy()


METHOD = (
    "Daylight glare probability after Wienold and Christoffersen: sources are what is brighter "
    f"than {THRESHOLD:,.0f} {CD_M2}, the sun's disc and its images in flat smooth surfaces. EN "
    "17037: DGP above 0.45, 0.40 or 0.35 in at most 5 % of 8:00 to 18:00 is minimum, medium or "
    "high."
)
