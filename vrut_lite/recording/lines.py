"""Inputs and journals as JSON lines, for people and for programs that read no MCAP."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.kernel.job_scheduler import JOBS
from vrut_lite.kernel.messages import Input
from vrut_lite.memory_limit import VARIABLE, memory_limit_bytes
from vrut_lite.message_codec import MESSAGE_BYTES, decode
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.limits import DECODED_PER_BYTE
from vrut_lite.recording.registry import Registry

# A line of a dump has some more beside its message.
_LINE_BYTES = 2 * MESSAGE_BYTES
_NOT_SHOWN = re.compile(r"[\x7f-\x9f\u200b-\u200f\u2028-\u202e\u2066-\u2069]")


def dump_lines(journal: Journal) -> Iterator[str]:
    """A line about the journal, then one for each entry, numbered from 0.

    An entry is {"number", "input" or "derived": type, "sender", "digest", "message"}.
    """
    yield _line({"signature": journal.signature, "setup": journal.setup, "full": journal.full})
    for number, entry in enumerate(journal.entries()):
        yield _line(
            {
                "number": number,
                entry.kind: entry.type_name,
                "sender": entry.sender,
                "digest": entry.digest,
                "message": entry.message,
            }
        )


def read_inputs(path: str | Path, registry: Registry) -> list[Input]:
    """The inputs of a file of lines {"input": type, "message": {...}}.

    Lines without "input" are passed over, so that what `dump_lines` makes can be read, and so are
    results of the recorded kernel's own jobs: those will be done again.

    Raises:
        UserError: the file cannot be read, or a line holds no known input; the line is named.
    """
    file = Path(path)
    room_bytes = memory_limit_bytes() // DECODED_PER_BYTE
    inputs: list[Input] = []
    try:
        with file.open("rb") as stream:
            for number, line in enumerate(_lines(stream), 1):
                try:
                    found = _input_of(line, registry)
                    if found is not None:
                        inputs.append(found)
                        room_bytes -= len(line)
                    _check_room(room_bytes)
                except (UserError, ValueError, RecursionError) as error:
                    raise UserError(f"{file}, line {number}: {error}") from None
    except OSError as error:
        raise UserError(f"cannot open the inputs {file}: {error.strerror or error}") from None
    return inputs


def _lines(stream: BinaryIO) -> Iterator[bytes]:
    """The lines, none longer than one byte over the limit."""
    return iter(lambda: stream.readline(_LINE_BYTES + 1), b"")


def _check_room(room_bytes: int) -> None:
    if room_bytes < 0:
        raise UserError(
            f"these inputs take more memory than they may: play them in parts, or set {VARIABLE} "
            "higher"
        )


def _input_of(line: bytes, registry: Registry) -> Input | None:
    if len(line) > _LINE_BYTES:
        raise UserError(f"a line is longer than {_LINE_BYTES} bytes")
    if not line.strip():
        return None
    content = msgspec.json.decode(line)
    if not isinstance(content, dict):
        raise UserError('a line is an object: {"input": "SetClock", "message": {...}}')
    if "input" not in content or content.get("sender") == JOBS:
        return None
    kind = registry.find_input(str(content["input"]))
    return decode(kind, content.get("message", {}))


def _line(content: dict[str, Any]) -> str:
    """The JSON, with control characters escaped."""
    text = msgspec.json.encode(content).decode()
    return _NOT_SHOWN.sub(lambda letter: f"\\u{ord(letter[0]):04x}", text)
