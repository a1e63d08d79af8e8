"""Reads Radiance's pictures (.hdr, .pic): a text head, a size, and lines of RGBE or XYZE pixels.

G. Ward, "Real Pixels", Graphics Gems II, 1991, and Radiance's color.c, header.c and resolu.c.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from photo_sky.primaries import rgb_from_primaries, rgb_from_xyz
from vrut_lite.geometry.colour import SRGB_CHROMATICITIES
from vrut_lite.numeric_types import FloatArray

# Luminance (cd m^-2) of the radiance 1, by definition of Radiance; its Y is in cd m^-2 itself.
_LUMENS_PER_WATT = 179.0
# Lines of other lengths are never packed in the newer way.
_SHORTEST_PACKED, _LONGEST_PACKED = 8, 0x7FFF
_FORMATS = ("32-bit_rle_rgbe", "32-bit_rle_xyze")
# Longest run: four marks of 8 bits one after another.
_MOST_MARKS = 4


@dataclass
class HdrHead:
    """The head of a Radiance picture.

    Attributes:
        lines, length: number of lines as stored, and pixels of each.
        by_columns: whether a line is a column of the picture.
        bottom_first, right_first: whether the lowest row, or the rightmost column, comes first.
        exposure, colour_correction: what pixels were multiplied by, all lines of the head together.
        xyz: whether pixels are CIE XYZ.
        rounded: whether mantissas were rounded to nearest, as this program writes them; others
            cut them off, so that a half is added. A program that copies the head puts its own
            line behind this program's.
        body: where the pixels begin.
    """

    lines: int = 0
    length: int = 0
    by_columns: bool = False
    bottom_first: bool = False
    right_first: bool = False
    exposure: float = 1.0
    colour_correction: FloatArray = field(default_factory=lambda: np.ones(3))
    primaries: tuple[float, ...] = SRGB_CHROMATICITIES
    xyz: bool = False
    rounded: bool = False
    body: int = 0

    @property
    def cd_m2_per_unit(self) -> float:
        """Luminance of a stored RGB (1, 1, 1)."""
        return (1.0 if self.xyz else _LUMENS_PER_WATT) / self.exposure

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture."""
        return (self.lines, self.length) if self.by_columns else (self.length, self.lines)


def read_head(data: bytes) -> HdrHead:
    """The head of a file.

    Raises:
        ValueError: the head is not Radiance's, or a value in it is not valid.
    """
    if not data.startswith(b"#?"):
        raise ValueError("no head")
    head, at = HdrHead(), 0
    while True:
        line, at = _line(data, at)
        if not line:
            break
        _read_variable(head, line.decode("latin-1"))
    line, head.body = _line(data, at)
    _read_size(head, line.decode("latin-1").split())
    return head


def pixels_of(data: bytes, head: HdrHead) -> FloatArray:
    """Linear sRGB (h, w, 3) as stored, the top left pixel first: radiance times the exposure.

    Raises:
        ValueError, IndexError: the lines are damaged.
    """
    stored = _lines(data, head)
    exponent = stored[..., 3].astype(int) - 136
    scale = np.where(stored[..., 3] > 0, np.ldexp(1.0, exponent).astype(np.float64), 0.0)
    half = 0.0 if head.rounded else 0.5
    values = np.asarray((stored[..., :3] + half) * scale[..., None], np.float64)
    values /= head.colour_correction
    values = rgb_from_xyz(values) if head.xyz else rgb_from_primaries(values, head.primaries)
    if head.by_columns:
        values = values.transpose(1, 0, 2)
    values = values[::-1] if head.bottom_first else values
    return np.ascontiguousarray(values[:, ::-1] if head.right_first else values)


def _line(data: bytes, at: int) -> tuple[bytes, int]:
    """A line of text without its end, which may be that of another system, and the next line."""
    end = data.index(b"\n", at)
    return data[at:end].rstrip(b"\r"), end + 1


def _read_variable(head: HdrHead, line: str) -> None:
    name, _, text = line.partition("=")
    name, words = name.strip(), text.split()
    head.rounded = (name, words) == ("MANTISSAS", ["rounded"]) or (
        head.rounded and name == "FORMAT"
    )
    if name == "EXPOSURE":
        head.exposure *= _factors(words, 1)[0]
    elif name == "COLORCORR":
        head.colour_correction = head.colour_correction * _factors(words, 3)
    elif name == "PRIMARIES":
        head.primaries = tuple(float(word) for word in words)
    elif name == "FORMAT":
        if words[:1] not in ([form] for form in _FORMATS):
            raise ValueError("another format")
        head.xyz = words[0] == _FORMATS[1]


def _factors(words: list[str], count: int) -> FloatArray:
    values = [float(word) for word in words[:count]]
    if len(values) != count or not all(math.isfinite(v) and v > 0.0 for v in values):
        raise ValueError("a factor that is none")
    return np.array(values)


def _read_size(head: HdrHead, words: list[str]) -> None:
    """The size, which says in which order pixels come: "-Y 512 +X 1024" is the usual one."""
    axes = words[::2]
    if len(words) != 4 or {axis[1:] for axis in axes} != {"X", "Y"}:
        raise ValueError("no size")
    if any(axis[0] not in "+-" for axis in axes):
        raise ValueError("no size")
    head.lines, head.length = int(words[1]), int(words[3])
    head.by_columns = axes[0][1:] == "X"
    head.bottom_first, head.right_first = "+Y" in axes, "-X" in axes


def _lines(data: bytes, head: HdrHead) -> NDArray[np.uint8]:
    """The pixels' bytes (lines, length, 4), each line plain or packed in either way."""
    rows = np.empty((head.lines, head.length, 4), np.uint8)
    at = head.body
    may_be_packed = _SHORTEST_PACKED <= head.length <= _LONGEST_PACKED
    for row in rows:
        # A colour of red 2 and green 2 has a blue of 128 or more: no packed line begins so.
        if may_be_packed and data[at : at + 2] == b"\x02\x02" and data[at + 2] < 128:
            at = _unpack(data, at, row)
        else:
            at = _take_plain(data, at, row)
    return rows


def _unpack(data: bytes, at: int, row: NDArray[np.uint8]) -> int:
    """A line whose four parts are packed in runs one after another; where the next line begins."""
    length = len(row)
    if data[at + 2] * 256 + data[at + 3] != length:
        raise ValueError("another length")
    at += 4
    for part in row.T:
        filled = 0
        while filled < length:
            count = data[at]
            is_run = count > 128
            count -= 128 if is_run else 0
            if not 0 < count <= length - filled:
                raise ValueError("a run too long")
            taken = data[at + 1 : at + 2] * count if is_run else data[at + 1 : at + 1 + count]
            part[filled : filled + count] = np.frombuffer(taken, np.uint8)
            filled += count
            at += 2 if is_run else 1 + count
    return at


def _take_plain(data: bytes, at: int, row: NDArray[np.uint8]) -> int:
    """A line of pixels, of which 1, 1, 1, n repeats the one before n times; the next line.

    Marks that follow each other hold further bytes of the number, the lowest first.
    """
    stored = np.frombuffer(data, np.uint8, min(4 * len(row), (len(data) - at) // 4 * 4), at)
    stored = stored.reshape(-1, 4)
    is_mark = (stored[:, :3] == 1).all(axis=1)
    if not is_mark.any():
        row[:] = stored
        return at + stored.size
    number = np.arange(len(stored))
    source = np.maximum.accumulate(np.where(is_mark, -1, number))
    place = number - source - 1
    if source[0] < 0 or place.max() >= _MOST_MARKS:
        raise ValueError("a run of nothing")
    count = np.where(is_mark, stored[:, 3].astype(np.int64) << (8 * place), 1)
    last = int(np.searchsorted(np.cumsum(count), len(row)))
    if last == len(stored) or count[: last + 1].sum() != len(row):
        raise ValueError("a run too long")
    row[:] = np.repeat(stored[source[: last + 1]], count[: last + 1], axis=0)
    return at + 4 * (last + 1)
