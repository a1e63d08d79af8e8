"""A figure: tiles in rows and columns with captions, and the colour scale below."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from vrut_lite_lab.study.framework.colour_scales import DECADES, error_scale, luminance_scale
from vrut_lite_lab.study.framework.fisheye import Picture
from vrut_lite_lab.study.report.panels import TILE

_GAP, _LEFT, _TOP, _SCALE_HEIGHT, _BAR = 6, 92, 40, 44, 14
_INK, _PAPER = (20, 20, 20), (255, 255, 255)
_FONT_PX = 12


def sheet(
    columns: Sequence[str],
    rows: Sequence[str],
    tiles: Sequence[Sequence[Picture | None]],
    notes: Sequence[Sequence[str]],
    scale: str = "",
) -> NDArray[np.uint8]:
    """One picture (h, w, 3).

    Args:
        columns, rows: captions; a row's has its second line after a comma.
        tiles: by row and column; None leaves a place empty.
        notes: likewise, what is written at the lower left of each.
        scale: `luminance`, `percent` or `error` puts that scale below.
    """
    pitch = TILE + _GAP
    height = _TOP + pitch * len(rows) + (_SCALE_HEIGHT if scale else 0)
    image = Image.new("RGB", (_LEFT + pitch * len(columns), height), _PAPER)
    pen, font = ImageDraw.Draw(image), _font(_FONT_PX)
    for j, caption in enumerate(columns):
        pen.multiline_text((_LEFT + j * pitch, 4), _in_two_lines(caption, font), _INK, font=font)
    for i, caption in enumerate(rows):
        top = _TOP + i * pitch
        pen.multiline_text((4, top + TILE // 3), caption.replace(", ", "\n"), _INK, font=font)
        for j, (tile, note) in enumerate(zip(tiles[i], notes[i], strict=True)):
            left = _LEFT + j * pitch
            if tile is not None:
                image.paste(Image.fromarray(tile), (left, top))
            pen.text((left, top + TILE - _FONT_PX - 2), note, _INK, font=font)
    if scale:
        _draw_scale(image, height - _SCALE_HEIGHT + 8, scale)
    return np.asarray(image)


def _font(size_px: int) -> ImageFont.FreeTypeFont:
    """Matplotlib's own: Pillow's has no multiplication sign."""
    from matplotlib import get_data_path

    return ImageFont.truetype(f"{get_data_path()}/fonts/ttf/DejaVuSans.ttf", size_px)


def _in_two_lines(caption: str, font: ImageFont.FreeTypeFont) -> str:
    """Broken where a tile's width is full."""
    lines = [""]
    for word in caption.split(" "):
        longer = f"{lines[-1]} {word}".strip()
        if len(lines) == 1 and font.getlength(longer) > TILE:
            lines.append(word)
        else:
            lines[-1] = longer
    return "\n".join(lines)


def _draw_scale(image: Image.Image, top: int, scale: str) -> None:
    colours = error_scale() if scale == "error" else luminance_scale()
    step = (image.width - _LEFT - 40) // len(colours)
    bar = np.repeat(colours[None], _BAR, axis=0).repeat(step, axis=1)
    image.paste(Image.fromarray(np.ascontiguousarray(bar)), (_LEFT, top))
    pen, font = ImageDraw.Draw(image), _font(_FONT_PX - 2)
    for share, text in _ticks(scale):
        at = (_LEFT + int(share * step * len(colours)), top + _BAR + 2)
        pen.text(at, text, _INK, font=font, anchor="ma")


def _ticks(scale: str) -> list[tuple[float, str]]:
    if scale == "error":
        # The middle colour belongs to 0 to 10 %.
        return [((20 + k) / 41, f"{10 * k} %") for k in range(-20, 21, 5)]
    unit = " %" if scale == "percent" else ""
    return [(k / DECADES, f"{10**k:,}{unit}") for k in range(DECADES + 1)]
