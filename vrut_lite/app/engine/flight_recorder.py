"""Records a live session from its beginning, so that a journal can be saved at any moment.

The kernel's thread only queues inputs and messages, with copies of mutable values; the recorder's
own thread makes digests and writes entries to a temporary file. A journal is written from there, as
often as wished, while the session and its recording
go on.
"""

import struct
import tempfile
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from pathlib import Path
from queue import SimpleQueue
from typing import IO, Any, NamedTuple

import msgspec
import zstandard

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Message
from vrut_lite.recording.entry import Entry, Kind
from vrut_lite.recording.frozen_copy import frozen_copy
from vrut_lite.recording.journal_writer import JournalWriter
from vrut_lite.recording.observer import Observer, entry_of
from vrut_lite.recording.registry import Registry
from vrut_lite.recording.setup import capture_setup
from vrut_lite.recording.signature import signature_of
from vrut_lite.write_atomic import atomic_output

# Days of playing time; the journal's reader takes at most four times this.
MOST_SPOOL_BYTES = 2**28
_LENGTH = struct.Struct("<I")


class Recorded(NamedTuple):
    """How much was recorded; `ended` is the reason why recording stopped, or empty."""

    inputs: int = 0
    messages: int = 0
    ended: str = ""


class FlightRecorder:
    """Begins on a kernel that has had no input of daylight yet.

    Raises:
        UserError: the kernel has already had one.
    """

    def __init__(self, kernel: Kernel, most_bytes: int = MOST_SPOOL_BYTES):
        self.recorded = Recorded()
        self._setup = capture_setup(kernel)
        self._registry = Registry(seat.module_type for seat in kernel.seats.values())
        self._signature = signature_of((m.name, m.version) for m in self._setup.modules)
        self._most_bytes = most_bytes
        self._spool: IO[bytes] = tempfile.TemporaryFile(prefix="vrut_lite-journal-")  # noqa: SIM115
        self._packer = zstandard.ZstdCompressor(level=1).stream_writer(self._spool, closefd=False)
        self._queue: SimpleQueue[Callable[[], None] | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._work, name="vrut-lite journal", daemon=True)
        self._thread.start()
        self._observer = Observer(kernel, self._saw)

    def save(self, path: str | Path) -> "Future[Recorded]":
        """Write the session until now as a light journal; from any thread.

        The future raises UserError if the file cannot be written.
        """
        answer: Future[Recorded] = Future()
        self._queue.put(lambda: self._answer(answer, Path(path)))
        return answer

    def close(self) -> None:
        """Stop recording and delete the temporary file."""
        self._observer.close()
        self._queue.put(None)
        self._thread.join()

    def _saw(self, kind: Kind, message: Message, sender: str) -> None:
        try:
            self._observer.check_modules()
            still = frozen_copy(message)
        # For example endless nesting in a message: recording ends, the session goes on.
        except Exception as problem:
            error = problem
            self._queue.put(lambda: self._end(message, error))
        else:
            self._queue.put(lambda: self._keep(kind, still, sender))

    # --- on the recorder's own thread --------------------------------------------------------

    def _work(self) -> None:
        while (act := self._queue.get()) is not None:
            act()
        self._packer.close()
        self._spool.close()

    def _keep(self, kind: Kind, message: Message, sender: str) -> None:
        inputs, messages, ended = self.recorded
        if ended:
            return
        try:
            self._registry.find(type(message).__name__)
            body = msgspec.msgpack.encode(entry_of(kind, message, sender))
            self._packer.write(_LENGTH.pack(len(body)) + body)
        # For example a full disk: recording ends, the session goes on.
        except Exception as error:
            self._end(message, error)
            return
        inputs, messages = inputs + (kind == "input"), messages + (kind == "derived")
        if kind == "input" and self._spool.tell() > self._most_bytes:
            ended = f"recording ended: the journal has {self._most_bytes >> 20} MiB"
            self._observer.close()
        self.recorded = Recorded(inputs, messages, ended)

    def _end(self, message: Message, error: Exception) -> None:
        """End the recording and note at which message."""
        self._observer.close()
        if not self.recorded.ended:
            ended = f"recording ended at a {type(message).__name__}: {error}"
            self.recorded = self.recorded._replace(ended=ended)

    def _answer(self, answer: "Future[Recorded]", path: Path) -> None:
        try:
            self._write(path)
            answer.set_result(self.recorded)
        except Exception as error:
            answer.set_exception(error)

    def _write(self, path: Path) -> None:
        with atomic_output(path) as beside, beside.open("wb") as stream:
            writer = JournalWriter(stream, self._signature, self._setup)
            for entry in self._entries():
                writer.add(entry, self._registry.find(entry.type_name))
            writer.finish()

    def _entries(self) -> Iterator[Entry]:
        """The recorded entries, from the temporary file."""
        self._packer.flush(zstandard.FLUSH_FRAME)
        self._spool.flush()
        end = self._spool.tell()
        self._spool.seek(0)
        try:
            reader = zstandard.ZstdDecompressor().stream_reader(
                self._spool, read_across_frames=True, closefd=False
            )
            while length := _read(reader, _LENGTH.size):
                body = _read(reader, _LENGTH.unpack(length)[0])
                yield msgspec.msgpack.decode(body, type=Entry)
        finally:
            self._spool.seek(end)


def _read(stream: Any, size: int) -> bytes:
    """`size` bytes, or none at the end of the stream."""
    parts = []
    while size and (part := stream.read(size)):
        parts.append(part)
        size -= len(part)
    return b"".join(parts)
