"""Messages as table rows: live ones as the kernel delivers them, and those of a journal."""

from collections import deque
from collections.abc import Iterator
from datetime import datetime
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.foreign_errors import sentence_of
from vrut_lite.interrupts import pass_interrupt
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Input, Message
from vrut_lite.kernel.trace import TraceEntry
from vrut_lite.memory_limit import VARIABLE, memory_limit_bytes
from vrut_lite.recording.entry import Entry as JournalEntry
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.limits import DECODED_PER_BYTE

_MOST_WAITING = 4096
_LONGEST_TEXT = 160
_MOST_FIELDS = 64
_AND_MORE = "\N{HORIZONTAL ELLIPSIS}"
Fields = tuple[tuple[str, str], ...]


class MessageRow(NamedTuple):
    """One message. `cause` is the number of the message that caused it, 0 for an input.

    Receivers, and the milliseconds of all their handlers, are known for live messages only.
    """

    number: int
    cause: int
    type_name: str
    sender: str
    is_input: bool
    receivers: tuple[str, ...]
    ms: float | None
    fields: Fields

    @property
    def searched(self) -> str:
        """The text that a filter searches."""
        return " ".join((self.type_name, self.sender, *self.receivers)).lower()


class MessageWatch:
    """Keeps rows of delivered messages while `watching`; on the kernel's thread."""

    def __init__(self, kernel: Kernel):
        self.watching = True
        self._kernel = kernel
        self._seen: deque[MessageRow] = deque(maxlen=_MOST_WAITING)
        kernel.tap(self._saw)

    def take(self) -> list[MessageRow]:
        """The messages since the last call, with the receivers of each."""
        rows = {row.number: row for row in self._seen}
        self._seen.clear()
        if not rows:
            return []
        oldest = min(rows)
        for delivery in reversed(self._kernel.trace.deliveries.copy()):
            entry = TraceEntry(*delivery)
            if entry.sequence < oldest:
                break
            if entry.sequence in rows:
                rows[entry.sequence] = _delivered(rows[entry.sequence], entry)
        return list(rows.values())

    def _saw(self, message: Message, sender: str) -> None:
        if not self.watching:
            return
        self._seen.append(
            MessageRow(
                number=self._kernel.dispatcher.current,
                cause=0,
                type_name=type(message).__name__,
                sender=sender,
                is_input=isinstance(message, Input),
                receivers=(),
                ms=0.0,
                fields=_fields_of(message),
            )
        )


def _fields_of(message: Message) -> Fields:
    """The fields of a message as text; a job's result may hold anything."""
    try:
        return _first_fields(message)
    except BaseException as error:
        pass_interrupt(error)
        return (("", f"cannot be shown: {sentence_of(error)}"),)


def _delivered(row: MessageRow, entry: TraceEntry) -> MessageRow:
    receivers = (entry.receiver, *row.receivers) if entry.receiver else row.receivers
    ms = (row.ms or 0.0) + (entry.end_ns - entry.start_ns) / 1e6
    # An input type that a module posts (a demand) is not an input from outside.
    is_input = row.is_input and entry.cause == 0
    return row._replace(cause=entry.cause, is_input=is_input, receivers=receivers, ms=ms)


class OpenJournal(NamedTuple):
    """A journal, its messages, and of these the inputs, by their numbers."""

    journal: Journal
    rows: list[MessageRow]
    inputs: dict[int, JournalEntry]


def open_journal(path: str | Path) -> OpenJournal:
    """The messages of a journal, numbered from 1; the cause of each is its transaction's input.

    Raises:
        UserError: the file cannot be read, or a list of its messages would take too much memory.
    """
    opened = OpenJournal(Journal(path), [], {})
    if opened.journal.message_bytes > memory_limit_bytes() // DECODED_PER_BYTE:
        raise UserError(
            f"the messages of {path} are too many for a list "
            f"({opened.journal.message_bytes >> 20} MiB): look at them with `vrut-lite dump`, or "
            f"set {VARIABLE} higher"
        )
    rows = opened.rows
    cause = 0
    for number, entry in enumerate(opened.journal.entries(), 1):
        is_input = entry.kind == "input"
        if is_input:
            opened.inputs[number] = entry
        rows.append(
            MessageRow(
                number=number,
                cause=0 if is_input else cause,
                type_name=entry.type_name,
                sender=entry.sender,
                is_input=is_input,
                receivers=(),
                ms=None,
                fields=_first_fields(entry.message),
            )
        )
        cause = number if is_input else cause
    return opened


def _first_fields(value: Any) -> Fields:
    """The first fields of a message, and whether there are more."""
    fields = tuple(islice(_fields("", value), _MOST_FIELDS + 1))
    return fields if len(fields) <= _MOST_FIELDS else (*fields[:-1], (_AND_MORE, _AND_MORE))


def _fields(path: str, value: Any) -> Iterator[tuple[str, str]]:
    """Names and short texts of fields, nested ones by dotted names."""
    if isinstance(value, msgspec.Struct):
        value = msgspec.structs.asdict(value)
    if isinstance(value, dict) and "$array" not in value:
        for name, part in value.items():
            yield from _fields(f"{path}.{name}" if path else str(name), part)
    else:
        yield path[-_LONGEST_TEXT:], value_text(value)


def value_text(value: Any) -> str:
    """A value in one line."""
    match value:
        case Array():
            text = f"{value.dtype} {value.shape}"
        case {"$array": _, "dtype": str(dtype), "shape": list(shape)}:
            text = f"{dtype} {tuple(shape)}"
        case float():
            text = f"{value:.6g}"
        case datetime():
            text = value.isoformat()
        case tuple() | list():
            text = ", ".join(value_text(part) for part in value)
        case _:
            text = " ".join(str(value).split())
    return text if len(text) <= _LONGEST_TEXT else text[:_LONGEST_TEXT] + _AND_MORE
