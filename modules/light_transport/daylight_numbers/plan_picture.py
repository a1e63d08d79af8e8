"""Values on work planes as plans in false colours, with iso-lines and a legend."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from light_transport.daylight_numbers.sensors import Sensors
from vrut_lite.geometry.false_colours import UNUSED, Scale, coloured, scale_of, scale_pixels
from vrut_lite.numeric_types import FloatArray

_EDGE_PX, _MARGIN_PX, _BAR_PX, _FONT_PX = 420, 16, 12, 13
_MOST_CELL_PX = 64
LEGEND_PX = 52
_INK, _LINE = (235, 235, 235), (250, 250, 250)
_LADDER = (1.0, 2.0, 3.0, 5.0, 7.5)
_MOST_LINES, _MOST_PLANS, _TICKS = 6, 4, 5
# A line shorter than this has no label.
_LABELLED_PX = 60


class Quantity(NamedTuple):
    """What is drawn: its title, and the unit of its values."""

    title: str
    unit: str


def plan_picture(sensors: Sensors, values: FloatArray, quantity: Quantity) -> NDArray[np.uint8]:
    """A picture (h, w, 3) of the largest planes beside each other, north (-z) up, one scale.

    Args:
        sensors: where the values are; points that lie in no grid are left out.
        values: (P,), positive numbers are drawn.
        quantity: what they are.
    """
    scale = scale_of(values[sensors.cell[:, 0] >= 0])
    counts = np.bincount(sensors.plane, sensors.cell[:, 0] >= 0, len(sensors.names))
    planes = [int(n) for n in np.argsort(-counts, kind="stable")[:_MOST_PLANS] if counts[n] > 0]
    plans = [_plan(sensors, values, plane, scale, quantity) for plane in sorted(planes)]
    width = max(sum(plan.width + _MARGIN_PX for plan in plans) + _MARGIN_PX, _EDGE_PX)
    height = max((plan.height for plan in plans), default=0) + 2 * _MARGIN_PX + LEGEND_PX
    sheet = Image.new("RGB", (width, height), UNUSED)
    left = _MARGIN_PX
    for plan in plans:
        sheet.paste(plan, (left, _MARGIN_PX))
        left += plan.width + _MARGIN_PX
    draw_legend(sheet, scale, quantity)
    return np.asarray(sheet, np.uint8).copy()


def _plan(
    sensors: Sensors, values: FloatArray, plane: int, scale: Scale, quantity: Quantity
) -> Image.Image:
    here = np.flatnonzero((sensors.plane == plane) & (sensors.cell[:, 0] >= 0))
    row, column = (sensors.cell[here] - sensors.cell[here].min(axis=0)).T
    grid = np.full((row.max() + 1, column.max() + 1), np.nan)
    grid[row, column] = values[here]
    size = int(np.clip(_EDGE_PX // max(grid.shape), 3, _MOST_CELL_PX))
    fine, inside = _smooth(grid, size)
    # What has nothing is as dark as the least; only what lies in no room stays empty.
    pixels = coloured(np.where(inside, np.maximum(fine, scale.low), np.nan), scale)
    lines = _levels(grid)
    level = np.searchsorted(lines, fine)
    edge = np.zeros(level.shape, bool)
    edge[:, 1:] |= (level[:, 1:] != level[:, :-1]) & inside[:, 1:] & inside[:, :-1]
    edge[1:] |= (level[1:] != level[:-1]) & inside[1:] & inside[:-1]
    pixels[edge] = _LINE
    title = Image.new("RGB", (max(pixels.shape[1], 150), pixels.shape[0] + 20), UNUSED)
    title.paste(Image.fromarray(pixels), (0, 20))
    pen, font = ImageDraw.Draw(title, "RGBA"), ImageFont.load_default(_FONT_PX)
    pen.text((0, 2), sensors.names[plane], _INK, font=font)
    for number, value in enumerate(lines):
        above = np.maximum(level[:, 1:], level[:, :-1]) == number + 1
        at = np.argwhere(edge[:, 1:] & above & (level[:, 1:] != level[:, :-1]))
        if len(at) < _LABELLED_PX // 3:
            continue
        y, x = at[len(at) * (number + 1) // (len(lines) + 1)]
        said = f"{value:g}"
        box = pen.textbbox((x, y + 12), said, font=font)
        pen.rectangle(box, fill=(0, 0, 0, 140))
        pen.text((x, y + 12), said, _INK, font=font)
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
    return np.nan_to_num(fine), np.kron(known, np.ones((size, size), bool)) & (weight > 0.0)


def _levels(grid: FloatArray) -> FloatArray:
    """Round values at which lines are drawn, at most a few."""
    used = grid[np.isfinite(grid) & (grid > 0.0)]
    if not len(used):
        return np.empty(0)
    low, high = np.quantile(used, (0.02, 0.98))
    tens = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    ladder = np.array([step * 10.0**ten for ten in tens for step in _LADDER])
    found = ladder[(ladder > low) & (ladder < high)]
    return found[:: max(1, -(-len(found) // _MOST_LINES))]


def draw_legend(sheet: Image.Image, scale: Scale, quantity: Quantity) -> None:
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
        said = f"{scale.at(share):,.3g}" if scale.at(share) < 1000.0 else f"{scale.at(share):,.0f}"
        room = width - pen.textlength(said, font=font)
        pen.text((_MARGIN_PX + share * room, top + _FONT_PX + 4 + _BAR_PX), said, _INK, font=font)
