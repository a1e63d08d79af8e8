"""Replays a journal: injects its inputs again and compares every message."""

from collections.abc import Iterable, Iterator
from itertools import chain, groupby, zip_longest
from typing import BinaryIO

import msgspec

from vrut_lite.discovery import discover
from vrut_lite.errors import UserError, one_line
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.job_scheduler import JOBS
from vrut_lite.kernel.messages import JobResult
from vrut_lite.kernel.module import Module
from vrut_lite.message_codec import decode
from vrut_lite.recording.comparison import Difference, entry_difference
from vrut_lite.recording.entry import Entry
from vrut_lite.recording.gpu_stand_in import GpuStandIn
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.later_fields import with_later_fields
from vrut_lite.recording.observer import Observer, entry_of
from vrut_lite.recording.recipes import Recipes
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.registry import Registry
from vrut_lite.recording.replay_runner import ReplayRunner
from vrut_lite.recording.setup import Services, restore_setup
from vrut_lite.recording.signature import differences, signature_of
from vrut_lite.sky.sky_sum import SkySum

_LONGEST_PHRASE = 800
# An input and its consequences, read one by one: a journal may be of any length.
Transaction = Iterator[Entry]


# The host's own modules that need neither a scene nor GL: a journal may name them.
HEADLESS: tuple[type[Module], ...] = (SkySum, GpuStandIn)


class Outcome(msgspec.Struct, frozen=True, kw_only=True):
    """The result of a replay; `difference` is a sentence about the first different message.

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

    `modules` are those that it may load; by default the installed ones and `HEADLESS`.

    Raises:
        UserError: the journal needs a module that is missing or does not start as it did.
    """

    def __init__(
        self,
        journal: Journal,
        modules: Iterable[type[Module]] | None = None,
        services: Services | None = None,
    ):
        known = list(modules) if modules is not None else [*discover()[0], *HEADLESS]
        self._journal = journal
        self._runner = ReplayRunner()
        self._recipes = Recipes()
        self.kernel = Kernel(runner=self._runner)
        try:
            restore_setup(self.kernel, journal.setup, known, services or {}, self._runner.release)
        except UserError as error:
            raise UserError(f"cannot replay the journal {journal.path}: {error}") from None
        self._registry = Registry(seat.module_type for seat in self.kernel.seats.values())

    def run(self, to_the_end: bool = False) -> Outcome:
        """Replay and compare up to the first difference, or all of it.

        Raises:
            UserError: the journal holds an input that this version does not know or refuses.
        """
        heard: list[Entry] = []
        observer = Observer(self.kernel, lambda *seen: heard.append(entry_of(*seen)))
        try:
            return self._run(heard, to_the_end)
        finally:
            observer.close()

    def _run(self, heard: list[Entry], to_the_end: bool) -> Outcome:
        unequal = self._signature_differences()
        inputs = messages = 0
        difference: str | None = None
        for there in transactions(self._journal.entries()):
            first = self._recipes.translated(self._with_sender(next(there)))
            self._feed(first, inputs + messages)
            count, found = self._compare(chain([first], there), heard, bool(unequal))
            if difference is None and found is not None:
                offset, phrase = found
                difference = (
                    f"message {inputs + messages + offset}, after input {inputs} "
                    f"({first.type_name}), {one_line(phrase, _LONGEST_PHRASE)}"
                )
            inputs += 1
            messages += count - 1
            heard.clear()
            if difference is not None and not to_the_end:
                break
        return Outcome(
            inputs=inputs,
            messages=messages,
            signature_differences=tuple(unequal),
            difference=difference,
        )

    def _compare(
        self, there: Transaction, here: list[Entry], by_value: bool
    ) -> tuple[int, tuple[int, str] | None]:
        """Length of the recorded transaction, and the place and kind of the first difference."""
        count, found = 0, None
        for offset, (expected, actual) in enumerate(zip_longest(there, here)):
            count += expected is not None
            if found is None and (phrase := self._difference(expected, actual, by_value)):
                found = offset, phrase
        return count, found

    def _difference(
        self, expected: Entry | None, actual: Entry | None, by_value: bool
    ) -> Difference:
        if expected is not None and actual is not None:
            expected = self._with_later_fields(expected, actual)
            phrase = entry_difference(self._recipes.translated(expected), actual, by_value)
            if phrase is None:
                self._recipes.note(expected, actual)
            return phrase and f"{_title(expected)}: {phrase}"
        if expected is not None:
            return f"{_title(expected)}, is in the journal and not here"
        return None if actual is None else f"{_title(actual)}, is here and not in the journal"

    def _with_later_fields(self, expected: Entry, actual: Entry) -> Entry:
        if expected.digest == actual.digest or expected.type_name != actual.type_name:
            return expected
        kind = self._registry.find(expected.type_name)
        message = with_later_fields(kind, expected.message, actual.message)
        return msgspec.structs.replace(expected, message=message)

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

        They lack the sender of a result: it is a job of its name that was started here, if any.
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
    """Entries in groups that each begin with an input; the next ends the one before.

    Raises:
        UserError: the first entry is no input.
    """
    inputs = 0

    def number(entry: Entry) -> int:
        nonlocal inputs
        inputs += entry.kind == "input"
        if inputs == 0:
            raise UserError(f"the journal begins with a {entry.type_name}, which is no input")
        return inputs

    return (group for _, group in groupby(entries, number))


def _is_own(entry: Entry) -> bool:
    """Whether a job of the recorded kernel's own brought the input."""
    return entry.type_name == JobResult.__name__ and entry.sender == JOBS


def _job_of(entry: Entry) -> tuple[str, str]:
    """Module and name of the job whose result the entry is."""
    return str(entry.message.get("module")), str(entry.message.get("job"))


def _title(entry: Entry) -> str:
    return f"{entry.type_name} from {entry.sender}"
