"""Records a session as a journal."""

from typing import BinaryIO

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import JobResult, Message
from vrut_lite.kernel.recording.codec import arrays_of, decode
from vrut_lite.kernel.recording.entry import Entry, Kind
from vrut_lite.kernel.recording.journal_writer import JournalWriter
from vrut_lite.kernel.recording.observer import Observer, entry_of
from vrut_lite.kernel.recording.registry import Registry
from vrut_lite.kernel.recording.setup import capture_setup
from vrut_lite.kernel.recording.signature import signature_of


class Recorder:
    """Writes all that a kernel admits and delivers, until `close`; begins on a fresh kernel.

    A light journal holds arrays by digest and a few sampled values, a full one their bytes
    too. What cannot be recorded ends the recording, never the session: `close` tells it.
    """

    def __init__(self, kernel: Kernel, stream: BinaryIO, full: bool = False):
        kernel.pump()
        setup = capture_setup(kernel)
        self.inputs = 0
        self.messages = 0
        self._full = full
        self._refusal: UserError | None = None
        self._registry = Registry(seat.module_type for seat in kernel.seats.values())
        signature = signature_of((module.name, module.version) for module in setup.modules)
        self._writer = JournalWriter(stream, signature, setup, full)
        self._observer = Observer(kernel, self._add)

    def close(self) -> None:
        """Complete the journal; the stream stays open.

        Raises:
            UserError: something that was said could not be recorded.
        """
        self._observer.close()
        if self._refusal is not None:
            raise self._refusal
        self._writer.finish()

    def _add(self, kind: Kind, message: Message, sender: str) -> None:
        try:
            self._write(entry_of(kind, message, sender), message)
        # Whatever it is (a full disk, a message that nests without end): the session goes on.
        except Exception as error:
            self._observer.close()
            name = type(message).__name__
            self._refusal = UserError(f"the session could not be recorded at a {name}: {error}")

    def _write(self, entry: Entry, message: Message) -> None:
        if entry.kind == "input":
            self._registry.find(entry.type_name)
            if not isinstance(message, JobResult):
                _check_readable(entry, message)
        if self._full:
            for array in arrays_of(message):
                self._writer.add_array(array)
        self._writer.add(entry, type(message))
        self.inputs += entry.kind == "input"
        self.messages += entry.kind == "derived"


def _check_readable(entry: Entry, message: Message) -> None:
    """Read an input back; UserError if a reader of the journal would refuse it."""
    arrays = {array.digest: array for array in arrays_of(message)}
    decode(type(message), entry.message, lambda handle: arrays[handle["$array"]])
