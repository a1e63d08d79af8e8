"""A year as a picture: hours of the day against days, in false colours with a legend."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from light_transport.daylight_numbers.plan_picture import Quantity, draw_legend
from vrut_lite.geometry.false_colours import UNUSED, coloured, scale_of
from vrut_lite.numeric_types import FloatArray

_DAY_PX, _HOUR_PX = 2, 9
_LEFT_PX, _TOP_PX, _LEGEND_PX, _FONT_PX = 46, 24, 72, 13
_INK = (235, 235, 235)
_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
_FIRST_DAYS = (0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334)


def heat_map(values: FloatArray, title: str, quantity: Quantity) -> NDArray[np.uint8]:
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
