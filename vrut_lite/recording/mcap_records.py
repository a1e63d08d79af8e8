"""The records of MCAP bytes, one after the other, none of them copied (MCAP specification)."""

import struct
from collections.abc import Iterator

from vrut_lite.errors import UserError

SCHEMA, CHANNEL, MESSAGE, CHUNK = 0x03, 0x04, 0x05, 0x06
ATTACHMENT, METADATA = 0x09, 0x0C
_HEAD = struct.Struct("<BQ")

Record = tuple[int, memoryview]


def records(data: memoryview) -> Iterator[Record]:
    """Opcode and content of each record.

    Raises:
        UserError: the last one is cut short.
    """
    place = 0
    while place < len(data):
        start = place + _HEAD.size
        opcode, size = _HEAD.unpack_from(data, place) if start <= len(data) else (0, 0)
        place = start + size
        if place > len(data):
            raise UserError("it is damaged: a record is longer than what holds it")
        yield opcode, data[start:place]


class Fields:
    """The fields of a record, from the first on.

    All methods raise UserError where the record ends before the field does.
    """

    def __init__(self, content: memoryview):
        self.left = content

    def number(self, width: int) -> int:
        """An unsigned number of so many bytes."""
        return int.from_bytes(self.part(width), "little")

    def text(self) -> str:
        """A text; UnicodeDecodeError if it is not UTF-8."""
        return str(self.part(self.number(4)), "utf-8")

    def part(self, size: int) -> memoryview:
        """The next `size` bytes."""
        if size > len(self.left):
            raise UserError("it is damaged: a record ends before its fields do")
        part, self.left = self.left[:size], self.left[size:]
        return part
