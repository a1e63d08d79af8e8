"""Reads a journal; whatever is wrong with the file is told in one sentence."""

import io
import re
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
import zstandard
from mcap.exceptions import McapError
from mcap.records import Attachment, Channel, Chunk, McapRecord, Metadata
from mcap.records import Message as McapMessage
from mcap.stream_reader import StreamReader, breakup_chunk

from vrut_lite.errors import UserError
from vrut_lite.kernel.array import Array
from vrut_lite.kernel.recording.codec import Handle, digest_of, no_arrays
from vrut_lite.kernel.recording.entry import Entry, Setup
from vrut_lite.kernel.recording.integrity import check_integrity
from vrut_lite.kernel.recording.journal_writer import FORMAT
from vrut_lite.kernel.recording.limits import (
    ARRAY_BYTES,
    CHUNK_BYTES,
    FILE_BYTES,
    MESSAGE_BYTES,
)
from vrut_lite.kernel.recording.signature import Signature

T = TypeVar("T")

_TOPIC = re.compile(r"/(input|derived)/(\w{1,100})")
_DTYPE = re.compile(r"[<>|][biuf]\d\d?")
_READING_ERRORS = (
    McapError,
    ValueError,
    TypeError,
    struct.error,
    zstandard.ZstdError,
    msgspec.MsgspecError,
    RecursionError,
    OverflowError,
)


class _Body(msgspec.Struct, frozen=True):
    sender: str
    digest: str
    message: dict[str, Any]


class Journal:
    """A journal file: its signature, its setup, and its entries in file order.

    Raises:
        UserError: the file cannot be read, is too large, damaged, or of another format.
    """

    def __init__(self, path: str | Path):
        self.path = Path(path)
        self._data = self._read_file()
        self._arrays: dict[str, bytes] | None = None
        with self._reading():
            check_integrity(self._data)
            facts = next((r.metadata for r in self._records() if isinstance(r, Metadata)), {})
            if facts.get("format") != FORMAT:
                raise UserError(f"its format is not {FORMAT}, the one that this version reads")
            self.full = _from_json(facts.get("full", ""), bool)
            self.signature = _from_json(facts.get("signature", ""), Signature)
            self.setup = _from_json(facts.get("setup", ""), Setup)

    def entries(self) -> Iterator[Entry]:
        """The entries, in the order they were written; timestamps play no part."""
        channels: dict[int, Channel] = {}
        with self._reading():
            for record in self._records():
                if isinstance(record, Chunk):
                    for inner in _open_chunk(record):
                        if isinstance(inner, Channel):
                            channels[inner.id] = inner
                        elif isinstance(inner, McapMessage):
                            yield _entry(channels, inner)

    def array(self, handle: Handle) -> Array:
        """The array of a handle, its content compared with its digest.

        Raises:
            UserError: the journal does not hold it, or holds another.
        """
        digest, arrays = str(handle["$array"]), self._all_arrays()
        if digest not in arrays:
            return no_arrays(handle)
        with self._reading():
            array = _unpacked(arrays[digest], handle)
            if array.digest != digest:
                raise UserError(f"the array {digest} has another content than its name says")
            return array

    def _all_arrays(self) -> dict[str, bytes]:
        """Every array by its digest, compressed."""
        if self._arrays is None:
            with self._reading():
                found = (r for r in self._records() if isinstance(r, Attachment))
                self._arrays = {attachment.name: attachment.data for attachment in found}
        return self._arrays

    def _read_file(self) -> bytes:
        try:
            if self.path.exists() and not self.path.is_file():
                raise UserError(f"cannot open the journal {self.path}: it is not a regular file")
            if self.path.stat().st_size > FILE_BYTES:
                raise UserError(f"the journal {self.path} is larger than {FILE_BYTES} bytes")
            return self.path.read_bytes()
        except OSError as error:
            raise UserError(
                f"cannot open the journal {self.path}: {error.strerror or error}"
            ) from None

    def _records(self) -> Iterator[McapRecord]:
        return StreamReader(
            io.BytesIO(self._data), emit_chunks=True, record_size_limit=len(self._data)
        ).records

    @contextmanager
    def _reading(self) -> Iterator[None]:
        try:
            yield
        except UserError as error:
            raise UserError(f"cannot read the journal {self.path}: {error}") from None
        except _READING_ERRORS as error:
            reason = str(error) or type(error).__name__
            raise UserError(f"cannot read the journal {self.path}: {reason}") from None


def _open_chunk(chunk: Chunk) -> list[McapRecord]:
    """The records of a chunk, its true size known before it is unpacked.

    zstandard allocates what a frame claims, whatever limit it is given.
    """
    if chunk.compression != "zstd":
        raise UserError(f"a chunk is compressed by '{chunk.compression}', not by zstd")
    if not 0 <= zstandard.frame_content_size(chunk.data) <= CHUNK_BYTES:
        raise UserError(f"a chunk is larger than {CHUNK_BYTES} bytes")
    return breakup_chunk(chunk, validate_crc=True)


def _entry(channels: dict[int, Channel], message: McapMessage) -> Entry:
    channel = channels.get(message.channel_id)
    topic = _TOPIC.fullmatch(channel.topic) if channel is not None else None
    if topic is None:
        raise UserError(f"message {message.sequence} is on no known channel")
    if len(message.data) > MESSAGE_BYTES:
        raise UserError(f"message {message.sequence} is larger than {MESSAGE_BYTES} bytes")
    body = _from_json(message.data, _Body)
    if not body.sender.isprintable():
        raise UserError(f"message {message.sequence} has no sender's name")
    if digest_of(topic[2], body.message) != body.digest:
        raise UserError(f"message {message.sequence}, a {topic[2]}, does not fit its own digest")
    return Entry(
        kind="input" if topic[1] == "input" else "derived",
        type_name=topic[2],
        sender=body.sender,
        digest=body.digest,
        message=body.message,
    )


def _unpacked(data: bytes, handle: Handle) -> Array:
    dtype, shape = handle.get("dtype"), handle.get("shape")
    if not (isinstance(dtype, str) and _DTYPE.fullmatch(dtype)):
        raise UserError(f"an array's element type is {dtype}, not a plain number")
    if not (isinstance(shape, list) and all(isinstance(n, int) and n >= 0 for n in shape)):
        raise UserError(f"an array's shape is {shape}")
    if not 0 <= zstandard.frame_content_size(data) <= ARRAY_BYTES:
        raise UserError(f"an array is larger than {ARRAY_BYTES} bytes")
    values = np.frombuffer(zstandard.decompress(data), np.dtype(dtype))
    return Array(values.reshape(shape))


def _from_json(text: str | bytes, kind: type[T]) -> T:
    return msgspec.json.decode(text, type=kind)
