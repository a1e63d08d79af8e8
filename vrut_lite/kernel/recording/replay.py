"""Replays a journal: the same inputs by the same way, and every answer compared."""

from collections.abc import Iterable, Iterator
from itertools import zip_longest
from typing import BinaryIO

import msgspec

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.discovery import discover
from vrut_lite.kernel.job_desk import JOBS
from vrut_lite.kernel.jobs import HeldRunner
from vrut_lite.kernel.messages import JobResult
from vrut_lite.kernel.module import Module
from vrut_lite.kernel.recording.codec import decode
from vrut_lite.kernel.recording.comparison import entry_difference
from vrut_lite.kernel.recording.entry import Entry
from vrut_lite.kernel.recording.journal_reader import Journal
from vrut_lite.kernel.recording.observer import Observer, entry_of
from vrut_lite.kernel.recording.recipes import Recipes
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
        self._recipes = Recipes()
        self.kernel = Kernel(runner=self._runner)
        restore_setup(self.kernel, journal.setup, known, services or {}, self._runner.release)
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
            there[0] = self._recipes.translated(self._with_sender(there[0]))
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
            translated = self._recipes.translated(expected)
            phrase = entry_difference(translated, actual, by_value, self._exact_digits(expected))
            if phrase is not None:
                return offset, f"{_title(expected)}: {phrase}"
            self._recipes.note(expected, actual)
        return None

    def _exact_digits(self, entry: Entry) -> bool:
        """Whether who said it, or whose job it was, gives the same digits in every run."""
        of_job = entry.type_name == JobResult.__name__
        seat = self.kernel.seats.get(_job_of(entry)[0] if of_job else entry.sender)
        return seat is None or seat.manifest.exact_digits

    def _signature_differences(self) -> list[str]:
        manifests = (seat.manifest for seat in self.kernel.seats.values())
        here = signature_of((manifest.name, manifest.version) for manifest in manifests)
        return differences(self._journal.signature, here)

    def _feed(self, entry: Entry, number: int) -> None:
        """Give the kernel one input and let it settle."""
        try:
            if _is_own(entry):
                # Where the job is not begun here, the comparison finds its result missing.
                self._runner.release(*_job_of(entry))
            else:
                kind = self._registry.find_input(entry.type_name)
                self.kernel.inject(decode(kind, entry.message, self._journal.array))
        except UserError as error:
            raise UserError(
                f"{self._journal.path}, message {number}: {error}; the journal was written by "
                f"vrut_lite {self._journal.signature.get('vrut_lite', 'of unknown version')}"
            ) from None
        self.kernel.pump()

    def _with_sender(self, entry: Entry) -> Entry:
        """The entry, with the sender that journals of earlier versions left out.

        They do not say who brought a result: a job of its name that is begun here, if any.
        """
        of_job = entry.type_name == JobResult.__name__ and not self._journal.setup.steps
        if of_job and _job_of(entry) in self._runner.held:
            return msgspec.structs.replace(entry, sender=JOBS)
        return entry


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


def _is_own(entry: Entry) -> bool:
    """Whether a job of the recorded kernel's own brought the input."""
    return entry.type_name == JobResult.__name__ and entry.sender == JOBS


def _job_of(entry: Entry) -> tuple[str, str]:
    """Module and name of the job whose result the entry is."""
    return str(entry.message.get("module")), str(entry.message.get("job"))


def _title(entry: Entry) -> str:
    return f"{entry.type_name} from {entry.sender}"
