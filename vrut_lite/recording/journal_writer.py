"""Writes a journal as MCAP: equal messages make equal bytes.

No wall time and no library version enter the file; an entry's number is its log time, the
number of its transaction its publish time.
"""

from typing import IO, Any, get_type_hints

import msgspec
import numpy as np
import zstandard
from mcap.writer import CompressionType, Writer

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Message
from vrut_lite.message_codec import ARRAY_BYTES, MESSAGE_BYTES
from vrut_lite.recording.entry import Entry, Kind, Setup
from vrut_lite.recording.limits import METADATA_BYTES
from vrut_lite.recording.signature import Signature

FORMAT = "1"
PROFILE = "vrut_lite"
METADATA = "journal"

_TEXT = {"type": "string"}
# Names and lengths beside the facts themselves, and some more.
_METADATA_HEAD_BYTES = 1024


class JournalWriter:
    """Appends entries to a binary stream; `finish` completes the file.

    Raises:
        UserError: a reader would refuse this entry.
    """

    def __init__(self, stream: IO[bytes], signature: Signature, setup: Setup, full: bool = False):
        self._writer = Writer(stream, compression=CompressionType.ZSTD, enable_data_crcs=True)
        self._writer.start(profile=PROFILE, library=f"vrut_lite journal {FORMAT}")
        facts = {
            "format": FORMAT,
            "full": _json_text(full),
            "signature": _json_text(signature),
            "setup": _json_text(setup),
        }
        _check_facts(facts)
        self._writer.add_metadata(METADATA, facts)
        self._channels: dict[tuple[Kind, str], int] = {}
        self._arrays: set[str] = set()
        self._entries = 0
        self._transactions = 0

    def add(self, entry: Entry, message_type: type[Message]) -> None:
        """Append an entry."""
        body = msgspec.json.encode(
            {"sender": entry.sender, "digest": entry.digest, "message": entry.message}
        )
        if len(body) > MESSAGE_BYTES:
            raise UserError(f"a {entry.type_name} of {len(body)} bytes is too large for a journal")
        self._transactions += entry.kind == "input"
        self._writer.add_message(
            channel_id=self._channel(entry, message_type),
            log_time=self._entries,
            publish_time=self._transactions,
            sequence=self._entries,
            data=body,
        )
        self._entries += 1

    def add_array(self, array: Array) -> None:
        """Append an array's bytes, unless the journal has them."""
        if array.digest in self._arrays:
            return
        data = np.ascontiguousarray(array.values).tobytes()
        if len(data) > ARRAY_BYTES:
            raise UserError(f"an array of {len(data)} bytes is too large for a journal")
        self._arrays.add(array.digest)
        self._writer.add_attachment(
            create_time=0,
            log_time=self._entries,
            name=array.digest,
            media_type="application/zstd",
            data=zstandard.compress(data),
        )

    def finish(self) -> None:
        """Complete the file; the stream stays open."""
        self._writer.finish()

    def _channel(self, entry: Entry, message_type: type[Message]) -> int:
        place = (entry.kind, entry.type_name)
        if place not in self._channels:
            schema = self._writer.register_schema(
                entry.type_name, "jsonschema", msgspec.json.encode(_schema(message_type))
            )
            self._channels[place] = self._writer.register_channel(
                f"/{entry.kind}/{entry.type_name}", "json", schema
            )
        return self._channels[place]


def _check_facts(facts: dict[str, str]) -> None:
    if len("".join(facts.values()).encode()) + _METADATA_HEAD_BYTES > METADATA_BYTES:
        raise UserError("the session's modules, settings and demands are too many for a journal")
    try:
        msgspec.json.decode(facts["setup"], type=Setup)
    except msgspec.ValidationError as error:
        raise UserError(f"the session cannot be recorded as it began: {error}") from None


def _json_text(value: Any) -> str:
    return msgspec.json.encode(value).decode()


def _schema(message_type: type[Message]) -> dict[str, Any]:
    """JSON schema of an entry of this type; programs such as Foxglove list fields by it."""
    hints = get_type_hints(message_type)
    fields = {name: _field_schema(hints[name]) for name in message_type.__struct_fields__}
    message = {"type": "object", "properties": fields}
    return {
        "type": "object",
        "properties": {"sender": _TEXT, "digest": _TEXT, "message": message},
    }


def _field_schema(hint: Any) -> dict[str, Any]:
    """JSON type of a field; an array, or a union with one, is an object."""
    try:
        (schema,), components = msgspec.json.schema_components([hint])
    except TypeError:
        return {"type": "object"}
    return {"type": "object"} if components else schema
