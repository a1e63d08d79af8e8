"""Reads a journal; an invalid file raises a UserError of one sentence."""

import re
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, TypeVar

import msgspec
import zstandard

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.memory_limit import VARIABLE, memory_limit_bytes
from vrut_lite.message_codec import MESSAGE_BYTES, Handle, check_nesting, digest_of
from vrut_lite.recording.contents import Contents, read_contents
from vrut_lite.recording.earlier_names import in_todays_words
from vrut_lite.recording.entry import Entry, Kind, Setup
from vrut_lite.recording.integrity import checked_section
from vrut_lite.recording.journal_writer import FORMAT
from vrut_lite.recording.limits import FILE_BYTES, MOST_PACKED_RATIO, MOST_UNPACKED_BYTES, RECORDS
from vrut_lite.recording.mcap_records import CHANNEL, MESSAGE, SCHEMA, Fields, records
from vrut_lite.recording.signature import Signature
from vrut_lite.recording.stored_arrays import StoredArrays

T = TypeVar("T")
# Kind and type of the messages of a channel.
Topic = tuple[Kind, str]

_TOPIC = re.compile(r"/(input|derived)/(\w{1,100})")
# Channel, number, and two times.
_MESSAGE_HEAD_BYTES = 2 + 4 + 8 + 8
_READING_ERRORS = (
    ValueError,
    TypeError,
    struct.error,
    zstandard.ZstdError,
    msgspec.MsgspecError,
    RecursionError,
    OverflowError,
)


class _Body(msgspec.Struct, frozen=True):
    sender: Annotated[str, msgspec.Meta(max_length=200)]
    digest: str
    message: dict[str, Any]


class Journal:
    """A journal file: its signature, its setup, and its entries in file order.

    `message_bytes` is the size of all its entries as JSON.

    Raises:
        UserError: the file cannot be read, is too large, damaged, or of another format.
    """

    def __init__(self, path: str | Path):
        self.path = Path(path)
        data = self._read_file()
        with self._reading():
            contents = read_contents(checked_section(data))
            facts = contents.facts
            if facts.get("format") != FORMAT:
                raise UserError(f"its format is not {FORMAT}, the one that this version reads")
            _check_sizes(len(data), contents)
            self.full = _from_json(facts.get("full", ""), bool)
            self.signature = _from_json(facts.get("signature", ""), Signature)
            self.setup = _in_todays_words(_from_json(facts.get("setup", ""), Setup))
            check_nesting(msgspec.to_builtins(self.setup))
        self.message_bytes = contents.message_bytes
        self._chunks = contents.chunks
        self._arrays = StoredArrays(contents.arrays)

    def entries(self) -> Iterator[Entry]:
        """The entries, in the order they were written; timestamps play no part."""
        topics: dict[int, Topic | None] = {}
        number = described = 0
        with self._reading():
            for chunk in self._chunks:
                for opcode, content in records(memoryview(chunk.unpack())):
                    if opcode == MESSAGE:
                        yield _entry(topics, content, number)
                        number += 1
                        continue
                    described += 1
                    if opcode not in (SCHEMA, CHANNEL) or described > RECORDS:
                        raise UserError("a chunk holds what is no message")
                    if opcode == CHANNEL:
                        _note_channel(topics, Fields(content))

    def array(self, handle: Handle) -> Array:
        """The array of a handle, its content compared with its digest.

        Raises:
            UserError: the journal does not hold it, or holds another.
        """
        with self._reading():
            return self._arrays.find(handle)

    def _read_file(self) -> bytes:
        try:
            if self.path.exists() and not self.path.is_file():
                raise UserError(f"cannot open the journal {self.path}: it is not a regular file")
            most_bytes = min(FILE_BYTES, memory_limit_bytes())
            if self.path.stat().st_size > most_bytes:
                raise UserError(f"the journal {self.path} is larger than {most_bytes} bytes")
            return self.path.read_bytes()
        except OSError as error:
            raise UserError(
                f"cannot open the journal {self.path}: {error.strerror or error}"
            ) from None

    @contextmanager
    def _reading(self) -> Iterator[None]:
        try:
            yield
        except UserError as error:
            raise UserError(f"cannot read the journal {self.path}: {error}") from None
        except _READING_ERRORS as error:
            reason = str(error) or type(error).__name__
            raise UserError(f"cannot read the journal {self.path}: {reason}") from None


def _check_sizes(file_bytes: int, contents: Contents) -> None:
    if contents.message_bytes > MOST_UNPACKED_BYTES + MOST_PACKED_RATIO * file_bytes:
        raise UserError(
            f"its messages unpack to {contents.message_bytes >> 20} MiB, more than "
            f"{MOST_PACKED_RATIO} times what it takes: no session does"
        )
    size_bytes = file_bytes + contents.message_bytes + contents.array_bytes
    most_bytes = memory_limit_bytes()
    if size_bytes > most_bytes:
        raise UserError(
            f"the file, its messages and its arrays unpacked are {size_bytes >> 20} MiB, and "
            f"{most_bytes >> 20} MiB is the limit: set {VARIABLE} higher if you trust it"
        )


def _note_channel(topics: dict[int, Topic | None], fields: Fields) -> None:
    """Remember what a channel carries; None if nothing of ours."""
    number = fields.number(2)
    fields.number(2)  # Its schema, which is for other programs.
    found = _TOPIC.fullmatch(fields.text())
    topic: Topic | None = None
    if found is not None:
        topic = ("input" if found[1] == "input" else "derived", found[2])
    if topics.setdefault(number, topic) != topic:
        raise UserError(f"channel {number} carries now this and now that")


def _entry(topics: dict[int, Topic | None], content: memoryview, number: int) -> Entry:
    topic = topics.get(Fields(content).number(2))
    if topic is None:
        raise UserError(f"message {number} is on no known channel")
    kind, type_name = topic
    data = content[_MESSAGE_HEAD_BYTES:]
    if len(data) > MESSAGE_BYTES:
        raise UserError(f"message {number} is larger than {MESSAGE_BYTES} bytes")
    try:
        body = _from_json(data, _Body)
        digest = digest_of(type_name, body.message)
    except (UserError, *_READING_ERRORS) as error:
        raise UserError(f"message {number}, a {type_name}: {error}") from None
    if not body.sender.isprintable():
        raise UserError(f"message {number} has no sender's name")
    if digest != body.digest:
        raise UserError(f"message {number}, a {type_name}, does not fit its own digest")
    name, message = in_todays_words(type_name, body.message)
    if (name, message) != (type_name, body.message):
        digest = digest_of(name, message)
    return Entry(kind=kind, type_name=name, sender=body.sender, digest=digest, message=message)


def _in_todays_words(setup: Setup) -> Setup:
    steps = []
    for step in setup.steps:
        name, message = in_todays_words(step.type_name, step.message)
        steps.append(msgspec.structs.replace(step, type_name=name, message=message))
    demands = [in_todays_words("Demand", demand)[1] for demand in setup.demands]
    return msgspec.structs.replace(setup, steps=steps, demands=demands)


def _from_json(text: str | bytes | memoryview, kind: type[T]) -> T:
    return msgspec.json.decode(text, type=kind)
