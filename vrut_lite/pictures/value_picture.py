"""Pictures of values in false colours, with their legend."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from vrut_lite.geometry.false_colours import (
    Scale,
    coloured,
    iso_lines,
    round_levels,
    scale_of,
    scale_pixels,
)
from vrut_lite.numeric_types import Float32Array
from vrut_lite.quantities import with_unit


class Quantity(NamedTuple):
    """Quantity that a picture shows instead of radiance, with the format of its values."""

    title: str
    unit: str
    factor: float = 1.0
    has_lines: bool = False

    def said(self, value: float) -> str:
        """A value with its unit."""
        return with_unit(value * self.factor, self.unit)


QUANTITIES: dict[str, Quantity] = {
    "illuminance": Quantity("illuminance", "lx", has_lines=True),
    "texels": Quantity("edge of the light map's texels", "m"),
    "noise": Quantity("noise of the light map's rays", "%", 100.0),
}
_TICKS = 5
_MARGIN_PX, _BAR_PX, _FONT_PX = 8, 10, 11
_NARROWEST_PX = 160
_INK = (235, 235, 235)
# Largest ratio of neighbouring pixels across an iso-line; more is an edge of an object or a shadow.
_STEEPEST = 1.15


class Values(NamedTuple):
    """Values (h, w) float32 of a picture, row 0 at the top: NaN where no surface is seen."""

    values: Float32Array
    quantity: Quantity
    scale: Scale

    def said_at(self, x: int, y: int) -> str:
        """Text of a pixel's value; empty without one."""
        value = float(self.values[y, x])
        return self.quantity.said(value) if np.isfinite(value) else ""


def values_of(values: Float32Array, shown: str) -> Values:
    """Values (h, w) with a scale for their range."""
    return Values(values, QUANTITIES[shown], scale_of(values))


def value_pixels(found: Values) -> NDArray[np.uint8]:
    """The picture (h, w, 3) with iso-lines of light and a legend, where there is room for one."""
    pixels = coloured(found.values, found.scale)
    height, width = pixels.shape[:2]
    levels = round_levels(found.scale) if found.quantity.has_lines else np.empty(0)
    line = iso_lines(found.values, levels, _STEEPEST)
    pixels[line >= 0] = _INK
    if width < _NARROWEST_PX or height < _NARROWEST_PX // 2 or found.scale.high <= 0.0:
        return pixels
    image = Image.fromarray(pixels)
    pen, font = ImageDraw.Draw(image, "RGBA"), ImageFont.load_default(_FONT_PX)
    for number, value in enumerate(levels):
        at = np.argwhere(line == number)
        if len(at) >= width // 4:
            y, x = at[len(at) // 2]
            said = found.quantity.said(value)
            place = (min(x, width - pen.textlength(said, font=font)), y - _FONT_PX // 2)
            pen.rectangle(pen.textbbox(place, said, font=font), fill=(0, 0, 0, 150))
            pen.text(place, said, _INK, font=font)
    top = height - 2 * _FONT_PX - _BAR_PX - 2 * _MARGIN_PX
    pen.rectangle((0, top - _MARGIN_PX // 2, width, height), fill=(0, 0, 0, 170))
    pen.text((_MARGIN_PX, top), found.quantity.title, _INK, font=font)
    bar = Image.fromarray(scale_pixels(width - 2 * _MARGIN_PX)).resize(
        (width - 2 * _MARGIN_PX, _BAR_PX)
    )
    below = top + _FONT_PX + _MARGIN_PX // 2
    image.paste(bar, (_MARGIN_PX, below))
    for tick in range(_TICKS):
        share = tick / (_TICKS - 1)
        said = found.quantity.said(found.scale.at(share))
        room = width - 2 * _MARGIN_PX - pen.textlength(said, font=font)
        place = (_MARGIN_PX + share * room, below + _BAR_PX + 2)
        pen.text(place, said, _INK, font=font)
    return np.asarray(image, np.uint8).copy()
