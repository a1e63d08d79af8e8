"""Inputs and journals as JSON lines, for people and for programs that read no MCAP."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.kernel.job_desk import JOBS
from vrut_lite.kernel.messages import Input
from vrut_lite.kernel.recording.codec import decode
from vrut_lite.kernel.recording.journal_reader import Journal
from vrut_lite.kernel.recording.limits import FILE_BYTES
from vrut_lite.kernel.recording.registry import Registry


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
    try:
        if file.stat().st_size > FILE_BYTES:
            raise UserError(f"the inputs {file} are larger than {FILE_BYTES} bytes")
        lines = file.read_bytes().splitlines()
    except OSError as error:
        raise UserError(f"cannot open the inputs {file}: {error.strerror or error}") from None
    inputs = []
    for number, line in enumerate(lines, 1):
        try:
            found = _input_of(line, registry)
        except (UserError, msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            raise UserError(f"{file}, line {number}: {error}") from None
        if found is not None:
            inputs.append(found)
    return inputs


def _input_of(line: bytes, registry: Registry) -> Input | None:
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
    return msgspec.json.encode(content).decode()
