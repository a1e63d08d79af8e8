"""Replays a journal: the same inputs by the same way, and every answer compared."""

from collections.abc import Iterable, Iterator
from itertools import zip_longest
from typing import BinaryIO

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.discovery import discover
from vrut_lite.kernel.jobs import HeldRunner
from vrut_lite.kernel.messages import JobResult
from vrut_lite.kernel.module import Module
from vrut_lite.kernel.recording.codec import decode
from vrut_lite.kernel.recording.comparison import entry_difference
from vrut_lite.kernel.recording.entry import Entry
from vrut_lite.kernel.recording.journal_reader import Journal
from vrut_lite.kernel.recording.observer import Observer, entry_of
from vrut_lite.kernel.recording.recorder import Recorder
from vrut_lite.kernel.recording.registry import Registry
from vrut_lite.kernel.recording.setup import Services, restore_setup
from vrut_lite.kernel.recording.signature import differences, signature_of

Transaction = list[Entry]


class Outcome(msgspec.Struct, frozen=True, kw_only=True):
    """What a replay found; `difference` is a sentence about the first message that differs.

    `signature_differences` is empty where digests were compared, and says otherwise why
    values were.
    """

    inputs: int
    messages: int
    signature_differences: tuple[str, ...]
    difference: str | None

    @property
    def by_value(self) -> bool:
        """Whether values were compared, within tolerances, instead of digests."""
        return bool(self.signature_differences)


class Replay:
    """A kernel set up as a journal's was, ready to be given its inputs.

    Raises:
        UserError: the journal needs a module that is missing or does not start as it did.
    """

    def __init__(
        self,
        journal: Journal,
        modules: Iterable[type[Module]] | None = None,
        services: Services | None = None,
    ):
        known = list(modules) if modules is not None else discover()[0]
        self._journal = journal
        self._runner = HeldRunner()
        self.kernel = Kernel(runner=self._runner)
        restore_setup(self.kernel, journal.setup, known, services or {})
        self._registry = Registry(seat.module_type for seat in self.kernel.seats.values())

    def run(self, to_the_end: bool = False) -> Outcome:
        """Replay and compare up to the first difference, or all of it.

        Raises:
            UserError: the journal holds an input that this version does not know or refuses.
        """
        heard: Transaction = []
        observer = Observer(self.kernel, lambda *seen: heard.append(entry_of(*seen)))
        try:
            return self._run(heard, to_the_end)
        finally:
            observer.close()

    def _run(self, heard: Transaction, to_the_end: bool) -> Outcome:
        unequal = self._signature_differences()
        inputs = messages = 0
        difference: str | None = None
        for there in transactions(self._journal.entries()):
            self._feed(there[0], inputs + messages)
            found = self._first_difference(there, heard, bool(unequal))
            if difference is None and found is not None:
                offset, phrase = found
                difference = (
                    f"message {inputs + messages + offset}, after input {inputs} "
                    f"({there[0].type_name}), {phrase}"
                )
            inputs += 1
            messages += len(there) - 1
            heard.clear()
            if difference is not None and not to_the_end:
                break
        return Outcome(
            inputs=inputs,
            messages=messages,
            signature_differences=tuple(unequal),
            difference=difference,
        )

    def _first_difference(
        self, there: Transaction, here: Transaction, by_value: bool
    ) -> tuple[int, str] | None:
        """Where two transactions part, counted from their input, and how."""
        for offset, (expected, actual) in enumerate(zip_longest(there, here)):
            if actual is None:
                return offset, f"{_title(expected)}, is in the journal and not here"
            if expected is None:
                return offset, f"{_title(actual)}, is here and not in the journal"
            phrase = entry_difference(expected, actual, by_value, self._exact_digits(expected))
            if phrase is not None:
                return offset, f"{_title(expected)}: {phrase}"
        return None

    def _exact_digits(self, entry: Entry) -> bool:
        """Whether who said it, or whose job it was, gives the same digits in every run."""
        of_job = entry.type_name == JobResult.__name__
        seat = self.kernel.seats.get(str(entry.message["module"]) if of_job else entry.sender)
        return seat is None or seat.manifest.exact_digits

    def _signature_differences(self) -> list[str]:
        manifests = (seat.manifest for seat in self.kernel.seats.values())
        here = signature_of((manifest.name, manifest.version) for manifest in manifests)
        return differences(self._journal.signature, here)

    def _feed(self, entry: Entry, number: int) -> None:
        """Give the kernel one input and let it settle."""
        try:
            if not self._release(entry):
                kind = self._registry.find_input(entry.type_name)
                self.kernel.inject(decode(kind, entry.message, self._journal.array))
        except UserError as error:
            raise UserError(
                f"{self._journal.path}, message {number}: {error}; the journal was written by "
                f"vrut_lite {self._journal.signature.get('vrut_lite', 'of unknown version')}"
            ) from None
        self.kernel.pump()

    def _release(self, entry: Entry) -> bool:
        """Let go the result of a job that ran in the replay too, if the input is one."""
        if entry.type_name != JobResult.__name__:
            return False
        module, job = entry.message.get("module"), entry.message.get("job")
        return self._runner.release(str(module), str(job))


def rerecord(
    journal: Journal,
    stream: BinaryIO,
    modules: Iterable[type[Module]] | None = None,
    services: Services | None = None,
) -> Outcome:
    """Write a journal of the same inputs with what this version answers to them.

    Raises:
        UserError: as `Replay` and `Replay.run`.
    """
    replay = Replay(journal, modules, services)
    recorder = Recorder(replay.kernel, stream, journal.full)
    outcome = replay.run(to_the_end=True)
    recorder.close()
    return outcome


def transactions(entries: Iterable[Entry]) -> Iterator[Transaction]:
    """Entries in groups that each begin with an input.

    Raises:
        UserError: the first entry is no input.
    """
    group: Transaction = []
    for entry in entries:
        if entry.kind == "input" and group:
            yield group
            group = []
        if not group and entry.kind != "input":
            raise UserError(f"the journal begins with a {entry.type_name}, which is no input")
        group.append(entry)
    if group:
        yield group


def _title(entry: Entry) -> str:
    return f"{entry.type_name} from {entry.sender}"
