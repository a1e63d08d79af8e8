"""The declared contents of a journal: all sizes are known before anything is unpacked."""

from collections.abc import Iterator
from typing import NamedTuple

import zstandard

from vrut_lite.errors import UserError
from vrut_lite.message_codec import ARRAY_BYTES
from vrut_lite.recording.journal_writer import METADATA as JOURNAL
from vrut_lite.recording.limits import CHUNK_BYTES, METADATA_BYTES, RECORDS
from vrut_lite.recording.mcap_records import (
    ATTACHMENT,
    CHUNK,
    MESSAGE,
    METADATA,
    Fields,
    Record,
    records,
)


class PackedContent(NamedTuple):
    """Zstandard bytes, and their declared unpacked size."""

    data: memoryview
    size: int

    def unpack(self) -> bytes:
        """The unpacked bytes; UserError or ZstdError if their size differs from the declared
        one."""
        if zstandard.frame_content_size(self.data) != self.size:
            raise UserError("it is damaged: what is packed has another size than is said of it")
        return zstandard.decompress(self.data)


class Contents(NamedTuple):
    """The facts of a journal, its chunks of messages, and its arrays by digest."""

    facts: dict[str, str]
    chunks: list[PackedContent]
    arrays: dict[str, PackedContent]

    @property
    def message_bytes(self) -> int:
        """Unpacked size of all messages."""
        return sum(chunk.size for chunk in self.chunks)

    @property
    def array_bytes(self) -> int:
        """Unpacked size of all arrays, each counted once."""
        return sum(array.size for array in self.arrays.values())


def read_contents(section: memoryview) -> Contents:
    """The contents of a data section, in one pass.

    Raises:
        UserError: a part is damaged, too large, or there twice.
    """
    found = Contents({}, [], {})
    for opcode, content in _limited(records(section)):
        if opcode == CHUNK:
            found.chunks.append(_chunk(Fields(content)))
        elif opcode == ATTACHMENT:
            _note_array(found.arrays, Fields(content))
        elif opcode == METADATA:
            _note_facts(found.facts, Fields(content))
        elif opcode == MESSAGE:
            raise UserError("a message lies outside the chunks")
    return found


def _limited(every: Iterator[Record]) -> Iterator[Record]:
    for number, record in enumerate(every):
        if number >= RECORDS:
            raise UserError(f"it has more than {RECORDS} records")
        yield record


def _chunk(fields: Fields) -> PackedContent:
    fields.part(16)  # The times of its first and its last message.
    size = fields.number(8)
    fields.part(4)  # Its checksum: that of the whole data section fits.
    compression = fields.text()
    if compression != "zstd":
        raise UserError(f"a chunk is compressed by '{compression}', not by zstd")
    if size > CHUNK_BYTES:
        raise UserError(f"a chunk is larger than {CHUNK_BYTES} bytes")
    return PackedContent(fields.part(fields.number(8)), size)


def _note_array(arrays: dict[str, PackedContent], fields: Fields) -> None:
    fields.part(16)  # Two times.
    digest = fields.text()
    fields.text()  # Its media type.
    data = fields.part(fields.number(8))
    if digest in arrays:
        raise UserError(f"the array {digest} is there twice")
    try:
        size = zstandard.frame_content_size(data)
    except zstandard.ZstdError:
        raise UserError(f"the array {digest} is damaged") from None
    if not 0 <= size <= ARRAY_BYTES:
        raise UserError(f"the array {digest} is larger than {ARRAY_BYTES} bytes")
    arrays[digest] = PackedContent(data, size)


def _note_facts(facts: dict[str, str], fields: Fields) -> None:
    if len(fields.left) > METADATA_BYTES:
        raise UserError(f"its facts take more than {METADATA_BYTES} bytes")
    if fields.text() != JOURNAL:
        return
    if facts:
        raise UserError("its facts are there twice")
    pairs = Fields(fields.part(fields.number(4)))
    while pairs.left:
        name = pairs.text()
        facts[name] = pairs.text()
