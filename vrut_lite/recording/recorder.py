"""Records a session as a journal."""

from typing import Any, BinaryIO

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.job_scheduler import JOBS
from vrut_lite.kernel.messages import JobResult, Message
from vrut_lite.message_codec import Handle, arrays_of, decode
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.recording.entry import Entry, Kind
from vrut_lite.recording.journal_writer import JournalWriter
from vrut_lite.recording.observer import Observer, entry_of
from vrut_lite.recording.registry import Registry
from vrut_lite.recording.setup import capture_setup
from vrut_lite.recording.signature import signature_of


class Recorder:
    """Writes all that a kernel admits and delivers, until `close`; begins on a fresh kernel.

    A light journal holds arrays by digest and a few sampled values, a full one their bytes
    too. A message that cannot be recorded ends the recording, never the session; `close` raises its
    error.
    """

    def __init__(self, kernel: Kernel, stream: BinaryIO, full: bool = False):
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
            UserError: a message could not be recorded.
        """
        self._observer.close()
        if self._refusal is not None:
            raise self._refusal
        self._writer.finish()

    def _add(self, kind: Kind, message: Message, sender: str) -> None:
        try:
            self._observer.check_modules()
            self._write(entry_of(kind, message, sender), message)
        # After any fault (a full disk, a message that nests without end) the session goes on.
        except Exception as error:
            self._observer.close()
            name = type(message).__name__
            self._refusal = UserError(f"the session could not be recorded at a {name}: {error}")

    def _write(self, entry: Entry, message: Message) -> None:
        if entry.kind == "input":
            self._registry.find(entry.type_name)
            if entry.sender != JOBS:
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

    def find_array(handle: Handle) -> Array:
        if handle["$array"] not in arrays:
            raise UserError("a field's name begins with $, as a journal's own do")
        return arrays[handle["$array"]]

    read = decode(type(message), entry.message, find_array)
    if isinstance(message, JobResult) and isinstance(read, JobResult):
        _check_heard(message.value, read.value)


def _check_heard(value: Any, read: Any) -> None:
    """Raise UserError unless a replay would deliver an equal message with equal types.

    Textures are distinguished from their fields by `GpuTexture.of`.
    """
    if isinstance(value, GpuTexture):
        return
    if type(value) is not type(read):
        raise UserError(
            f"a {type(value).__name__} in a result from elsewhere would be a "
            f"{type(read).__name__} in the replay: bring numbers, texts, lists, dictionaries or "
            "an Array"
        )
    if isinstance(value, list):
        for item, other in zip(value, read, strict=True):
            _check_heard(item, other)
    if isinstance(value, dict):
        if value.keys() != read.keys():
            raise UserError("a dictionary in a result from elsewhere has keys that are no texts")
        for key, item in value.items():
            _check_heard(item, read[key])
