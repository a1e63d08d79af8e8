"""Pictures in false colours: plans of work planes with iso-lines, and heat maps of a year."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from daylight_numbers.matrix.sensors import Sensors
from vrut_lite.geometry.false_colours import (
    UNUSED,
    Scale,
    coloured,
    iso_lines,
    round_levels,
    scale_of,
    scale_pixels,
)
from vrut_lite.numeric_types import FloatArray
from vrut_lite.quantities import figure

_EDGE_PX, _MARGIN_PX, _BAR_PX, _FONT_PX = 420, 16, 12, 13
_MOST_CELL_PX = 64
LEGEND_PX = 52
_INK, _LINE = (235, 235, 235), (250, 250, 250)
_MOST_PLANS, _TICKS = 4, 5
# A line shorter than this has no label.
_LABELLED_PX = 60
_DAY_PX, _HOUR_PX = 2, 9
_LEFT_PX, _TOP_PX, _LEGEND_PX = 46, 24, 72
_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
_FIRST_DAYS = (0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334)


class PictureQuantity(NamedTuple):
    """Title and unit of the values in a picture; `from_zero`: see `Scale`."""

    title: str
    unit: str
    from_zero: bool = False


def plan_picture(
    sensors: Sensors, values: FloatArray, quantity: PictureQuantity
) -> NDArray[np.uint8]:
    """A picture (h, w, 3) of the largest planes beside each other, north (-z) up, one scale.

    Args:
        sensors: where the values are; points that lie in no grid are left out.
        values: (P,), 0 and positive numbers are drawn.
        quantity: what they are.
    """
    scale = scale_of(values[sensors.cell[:, 0] >= 0], quantity.from_zero)
    counts = np.bincount(sensors.plane, sensors.cell[:, 0] >= 0, len(sensors.names))
    planes = [int(n) for n in np.argsort(-counts, kind="stable")[:_MOST_PLANS] if counts[n] > 0]
    plans = [_plan(sensors, values, plane, scale) for plane in sorted(planes)]
    width = max(sum(plan.width + _MARGIN_PX for plan in plans) + _MARGIN_PX, _EDGE_PX)
    height = max((plan.height for plan in plans), default=0) + 2 * _MARGIN_PX + LEGEND_PX
    sheet = Image.new("RGB", (width, height), UNUSED)
    left = _MARGIN_PX
    for plan in plans:
        sheet.paste(plan, (left, _MARGIN_PX))
        left += plan.width + _MARGIN_PX
    draw_legend(sheet, scale, quantity)
    return np.asarray(sheet, np.uint8).copy()


def grid_of_plane(sensors: Sensors, plane: int) -> NDArray[np.int64]:
    """Numbers (rows, columns) of a plane's sensors as seen from above, north up; -1 for none."""
    here = np.flatnonzero((sensors.plane == plane) & (sensors.cell[:, 0] >= 0))
    row, column = (sensors.cell[here] - sensors.cell[here].min(axis=0)).T
    found = np.full((row.max() + 1, column.max() + 1), -1)
    found[row, column] = here
    return found


def drawn_grid(grid: FloatArray, scale: Scale) -> NDArray[np.uint8]:
    """Pixels (h, w, 3) of a grid of values, nan where there is none: smooth, with iso-lines.

    Each cell has as many pixels as each other.
    """
    size = int(np.clip(_EDGE_PX // max(grid.shape), 3, _MOST_CELL_PX))
    fine, inside = _smooth(grid, size)
    # Cells without light are as dark as the darkest; only cells outside rooms stay empty.
    pixels = coloured(np.where(inside, np.maximum(fine, scale.low), np.nan), scale)
    used = grid[np.isfinite(grid) & (grid > 0.0)]
    range_here = np.quantile(used, (0.02, 0.98)) if len(used) else (0.0, 0.0)
    levels = round_levels(Scale(*range_here))
    line = iso_lines(np.where(inside, fine, np.nan), levels)
    pixels[line >= 0] = _LINE
    drawn = Image.fromarray(pixels)
    pen, font = ImageDraw.Draw(drawn, "RGBA"), ImageFont.load_default(_FONT_PX)
    for number, value in enumerate(levels):
        at = np.argwhere(line == number)
        if len(at) < _LABELLED_PX // 3:
            continue
        y, x = at[len(at) * (number + 1) // (len(levels) + 1)]
        said = f"{value:g}"
        place = (min(x, drawn.width - pen.textlength(said, font=font)), y - _FONT_PX // 2)
        pen.rectangle(pen.textbbox(place, said, font=font), fill=(0, 0, 0, 140))
        pen.text(place, said, _INK, font=font)
    return np.asarray(drawn, np.uint8)


def _plan(sensors: Sensors, values: FloatArray, plane: int, scale: Scale) -> Image.Image:
    number = grid_of_plane(sensors, plane)
    drawn = Image.fromarray(drawn_grid(np.where(number >= 0, values[number], np.nan), scale))
    title = Image.new("RGB", (max(drawn.width, 150), drawn.height + 20), UNUSED)
    title.paste(drawn, (0, 20))
    font = ImageFont.load_default(_FONT_PX)
    ImageDraw.Draw(title).text((0, 2), sensors.names[plane], _INK, font=font)
    return title


def _smooth(grid: FloatArray, size: int) -> tuple[FloatArray, NDArray[np.bool_]]:
    """A grid drawn with `size` pixels a cell, bilinear between middles; and where it has values."""
    known = np.isfinite(grid)
    at = [(np.arange(n * size) + 0.5) / size - 0.5 for n in grid.shape]
    low = [np.clip(np.floor(a).astype(int), 0, n - 1) for a, n in zip(at, grid.shape, strict=True)]
    high = [np.minimum(lo + 1, n - 1) for lo, n in zip(low, grid.shape, strict=True)]
    part = [np.clip(a - lo, 0.0, 1.0) for a, lo in zip(at, low, strict=True)]
    total, weight = np.zeros((2, len(at[0]), len(at[1])))
    values = np.where(known, grid, 0.0)
    for rows, r in ((low[0], 1.0 - part[0]), (high[0], part[0])):
        for columns, c in ((low[1], 1.0 - part[1]), (high[1], part[1])):
            share = r[:, None] * c[None] * known[np.ix_(rows, columns)]
            total += share * values[np.ix_(rows, columns)]
            weight += share
    with np.errstate(invalid="ignore"):
        fine = total / weight
    # Sums of equal values differ by rounding: lines would speckle where a whole room has a level's.
    fine = np.nan_to_num(fine).astype(np.float32).astype(float)
    return fine, np.kron(known, np.ones((size, size), bool)) & (weight > 0.0)


def draw_legend(sheet: Image.Image, scale: Scale, quantity: PictureQuantity) -> None:
    """Draw the scale of colours along the lower edge of a picture."""
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(_FONT_PX)
    width, top = sheet.width - 2 * _MARGIN_PX, sheet.height - LEGEND_PX
    pen.text((_MARGIN_PX, top), f"{quantity.title}, {quantity.unit}", _INK, font=font)
    bar = Image.fromarray(scale_pixels(width)).resize((width, _BAR_PX))
    sheet.paste(bar, (_MARGIN_PX, top + _FONT_PX + 4))
    if scale.high <= 0.0:
        return
    for tick in range(_TICKS):
        share = tick / (_TICKS - 1)
        said = figure(scale.at(share))
        room = width - pen.textlength(said, font=font)
        pen.text((_MARGIN_PX + share * room, top + _FONT_PX + 4 + _BAR_PX), said, _INK, font=font)


def heat_map(values: FloatArray, title: str, quantity: PictureQuantity) -> NDArray[np.uint8]:
    """A picture (h, w, 3) of values (HOURS, DAYS); midnight is at the bottom, 0 is dark."""
    hours, days = values.shape
    scale = scale_of(values)
    pixels = coloured(values[::-1], scale)
    field = Image.fromarray(pixels).resize(
        (days * _DAY_PX, hours * _HOUR_PX), Image.Resampling.NEAREST
    )
    width, height = field.width + _LEFT_PX + 16, field.height + _TOP_PX + 24 + _LEGEND_PX
    sheet = Image.new("RGB", (width, height), UNUSED)
    sheet.paste(field, (_LEFT_PX, _TOP_PX))
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(_FONT_PX)
    pen.text((_LEFT_PX, 4), title, _INK, font=font)
    for hour in range(0, hours + 1, 6):
        at = _TOP_PX + field.height - hour * _HOUR_PX
        pen.text((4, at - 8), f"{hour:02d}:00", _INK, font=font)
        pen.line((_LEFT_PX - 4, at, _LEFT_PX, at), fill=_INK)
    for name, day in zip(_MONTHS, _FIRST_DAYS, strict=True):
        at = _LEFT_PX + day * _DAY_PX
        pen.line((at, _TOP_PX + field.height, at, _TOP_PX + field.height + 4), fill=_INK)
        pen.text((at + 4, _TOP_PX + field.height + 4), name, _INK, font=font)
    draw_legend(sheet, scale, quantity)
    return np.asarray(sheet, np.uint8).copy()
