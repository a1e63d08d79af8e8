"""Text of files that other programs and people wrote, in the encodings and line ends they use."""

import codecs
import re
from pathlib import Path

from vrut_lite.errors import UserError

# UTF-32's marks begin with those of UTF-16.
_MARKS = {
    codecs.BOM_UTF8: "utf-8",
    codecs.BOM_UTF32_LE: "utf-32-le",
    codecs.BOM_UTF32_BE: "utf-32-be",
    codecs.BOM_UTF16_LE: "utf-16-le",
    codecs.BOM_UTF16_BE: "utf-16-be",
}
_LOOKED_AT_BYTES = 4096
_LINE_ENDS = re.compile(rb"\r\n?")


def plain_text(data: bytes) -> bytes:
    """The bytes of a text without byte order mark, not in UTF-16 or UTF-32, lines ended by LF.

    Bytes that need no change are returned as they are; a text in an encoding of single bytes
    keeps it.
    """
    mark = next((mark for mark in _MARKS if data.startswith(mark)), b"")
    encoding = _MARKS.get(mark) or _unmarked_encoding(data[:_LOOKED_AT_BYTES])
    data = data[len(mark) :] if mark else data
    if encoding != "utf-8":
        data = data.decode(encoding, errors="replace").encode()
    # Programs of DOS end a text by Ctrl-Z.
    data = data.rstrip(b"\x1a\0")
    return _LINE_ENDS.sub(b"\n", data) if b"\r" in data else data


def read_text(file: Path, what: str, most_bytes: int) -> str:
    """The text of a file, lines ended by LF; `what` names it in a refusal, as "the sensors".

    Raises:
        UserError: it cannot be read, or has more than `most_bytes`.
    """
    try:
        if file.stat().st_size > most_bytes:
            raise UserError(f"cannot read {what} {file}: more than {most_bytes >> 20} MB")
        return decoded(plain_text(file.read_bytes()))
    # A path with a null byte is a ValueError.
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UserError(f"cannot read {what} {file}: {reason}") from None


def decoded(text: bytes) -> str:
    """Plain text as UTF-8, or as Windows-1252 where it is no UTF-8."""
    try:
        return text.decode()
    except UnicodeDecodeError:
        return text.decode("cp1252", errors="replace")


def _unmarked_encoding(start: bytes) -> str:
    """UTF-16 where every other byte of the first letters is 0."""
    even, odd = start[0::2], start[1::2]
    if odd and 2 * odd.count(0) > len(odd) and not even.count(0):
        return "utf-16-le"
    if even and 2 * even.count(0) > len(even) and not odd.count(0):
        return "utf-16-be"
    return "utf-8"
