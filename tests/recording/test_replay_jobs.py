"""Background jobs in a replay: whose result was it, and which work is done at all."""

import io
import threading
from datetime import datetime

import msgspec
import numpy as np
import pytest

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Derived, EnableModule, Input, JobResult
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.journal_writer import JournalWriter
from vrut_lite.recording.lines import dump_lines, read_inputs
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.registry import Registry
from vrut_lite.recording.replay import rerecord

WORK_DONE = []


class Order(Input, frozen=True, kw_only=True):
    """Start a kind of work, or cancel what a name stands for."""

    work: str = "cancel"
    number: int = 0
    job: str = "sky"

    def key(self) -> None:
        return None


class Answer(Derived, frozen=True, kw_only=True):
    value: str

    def key(self) -> None:
        return None


def quick(number):
    WORK_DONE.append(number)
    return number


def until_cancelled(number, control):
    WORK_DONE.append(number)
    threading.Event().wait(0.001)
    while not control.cancelled():
        threading.Event().wait(0.001)
    return "late"


def raising(number):
    WORK_DONE.append(number)
    raise ValueError(f"cannot do {number}")


class Office(Module):
    manifest = Manifest(name="office", title="Office", version="1")
    speaks = (Answer,)

    @handles(Order)
    def on_order(self, message: Order) -> None:
        if message.work == "cancel":
            self.link.cancel_job(message.job)
        else:
            work = {"quick": quick, "until": until_cancelled, "raising": raising}[message.work]
            self.link.start_job(message.job, work, message.number)

    @handles(JobResult)
    def on_result(self, message: JobResult) -> None:
        value = message.value.digest if isinstance(message.value, Array) else message.value
        self.link.post(Answer(value=f"{message.job} {value} {message.error}"))


def elsewhere(value, job="sky", **fields):
    return JobResult(module="office", job=job, value=value, **fields)


def recorded(folder, *acts):
    """The journal of a session: inputs, each in its own transaction; None waits for all jobs."""
    stream, kernel = io.BytesIO(), Kernel()
    kernel.add_module(Office)
    recorder = Recorder(kernel, stream, full=True)
    for act in acts:
        if act is None:
            kernel.pump_until_idle()
        else:
            kernel.inject(act)
            kernel.pump()
    recorder.close()
    kernel.close()
    WORK_DONE.clear()
    path = folder / "session.mcap"
    path.write_bytes(stream.getvalue())
    return path


def replayed(path):
    """How the replay differs, and the work that was done in it."""
    WORK_DONE.clear()
    again = io.BytesIO()
    outcome = rerecord(Journal(path), again, [Office])
    assert outcome.difference is not None or again.getvalue() == path.read_bytes()
    return outcome.difference, list(WORK_DONE)


FIRST, SECOND, THIRD = (Order(work="quick", number=n) for n in (1, 2, 3))
FOR_EVER = Order(work="until", number=9)
ARRAY = Array(np.arange(6.0).reshape(2, 3))


@pytest.mark.parametrize(
    ("acts", "done"),
    [
        ([FOR_EVER, Order(), None, elsewhere(7)], []),  # Cancelled, then answered by another.
        ([FOR_EVER, elsewhere(7)], []),  # Answered while it runs.
        ([FOR_EVER, FIRST, elsewhere(7), None], [1]),  # The pending one runs then.
        ([FIRST, None, elsewhere(ARRAY)], [1]),  # Long finished.
        ([elsewhere(7), FIRST, None, elsewhere(8), SECOND, None], [1, 2]),
        ([FOR_EVER, elsewhere(1), FOR_EVER, elsewhere(2), FIRST, None], [1]),
        ([FOR_EVER, EnableModule(module="office", enabled=False), elsewhere(3)], []),
        ([elsewhere(None, error="no shader"), FIRST, None], [1]),
        ([elsewhere(None, error="raised", trace="Traceback"), FIRST, None], [1]),
    ],
)
def test_a_result_from_elsewhere_may_have_a_jobs_name(tmp_path, acts, done):
    """The journal knows which of two results of one name a job of the kernel's own brought."""
    difference, work = replayed(recorded(tmp_path, *acts))
    assert (difference, work) == (None, done)


@pytest.mark.parametrize(
    ("acts", "done"),
    [
        ([FOR_EVER, Order()], []),
        ([FOR_EVER, EnableModule(module="office", enabled=False)], []),
        ([FOR_EVER], []),  # Still running when the recording ended.
        ([FOR_EVER, Order(), FIRST, None], [1]),
        ([FOR_EVER, FIRST, SECOND, Order(), THIRD, None], [3]),
        ([Order(work="until", job="other"), FIRST, Order(job="other"), None], [1]),
    ],
)
def test_work_whose_result_was_never_admitted_is_not_done(tmp_path, acts, done):
    """Work that runs until it is cancelled would hold a replay up for ever."""
    difference, work = replayed(recorded(tmp_path, *acts))
    assert (difference, work) == (None, done)


def test_work_that_raised_is_a_fault_where_it_was(tmp_path):
    """Also between results of others: faults are counted in the journal's order."""
    acts = []
    for number in range(3):
        acts += [Order(work="raising", number=number, job=f"job {number}"), FIRST, None]
    assert replayed(recorded(tmp_path, *acts))[0] is None


def test_a_job_that_is_not_begun_any_more_is_named(tmp_path):
    """A module that changed: its old result is not brought in from the journal."""

    class Idle(Office):
        @handles(Order)
        def on_order(self, message: Order) -> None:
            pass

    path = recorded(tmp_path, FIRST, None)
    outcome = rerecord(Journal(path), io.BytesIO(), [Idle])
    assert outcome.difference == (
        "message 1, after input 1 (JobResult), JobResult from jobs, is in the journal and not here"
    )


def test_a_cancelled_job_that_never_returns_holds_up_no_other():
    """`wait_idle` waits only for results that are still wanted."""
    kernel, ended = Kernel(), threading.Event()
    kernel.add_module(Office)

    def deaf(number):
        ended.wait(20)

    kernel.jobs.start(("office", "deaf"), deaf, (1,))
    kernel.inject(Order(job="deaf"))
    kernel.inject(FIRST)
    waiting = threading.Thread(target=kernel.pump_until_idle)
    waiting.start()
    waiting.join(10)
    assert not waiting.is_alive()
    ended.set()
    kernel.close()


def test_a_journal_without_marks_still_replays(tmp_path):
    """Earlier versions did not record the sender of a result: it is a started job of its name."""
    path = recorded(tmp_path, FIRST, None, elsewhere(7, job="gpu"), SECOND, None)
    journal, older = Journal(path), tmp_path / "older.mcap"
    setup = msgspec.structs.replace(journal.setup, steps=[])
    with older.open("wb") as stream:
        writer = JournalWriter(stream, journal.signature, setup, full=True)
        for entry in journal.entries():
            kind = {"Order": Order, "Answer": Answer}.get(entry.type_name, JobResult)
            sender = "host" if entry.kind == "input" else entry.sender
            writer.add(msgspec.structs.replace(entry, sender=sender), kind)
        writer.finish()
    WORK_DONE.clear()
    assert rerecord(Journal(older), io.BytesIO(), [Office]).difference is None
    assert WORK_DONE == [1, 2]


def test_a_dump_gives_the_results_from_elsewhere_alone(tmp_path):
    """A kernel that is given the inputs again makes the results of jobs itself."""
    journal = Journal(recorded(tmp_path, FIRST, None, elsewhere(7), SECOND, None))
    script = tmp_path / "script.jsonl"
    script.write_text("\n".join(dump_lines(journal)))
    inputs = read_inputs(script, Registry([Office]))
    assert inputs == [FIRST, elsewhere(7), SECOND]


PLAIN = [None, True, 7, 1.5, float("inf"), "text", [1, [2.5]], {"a": {"b": [None]}}, ARRAY]


@pytest.mark.parametrize("value", PLAIN, ids=lambda value: type(value).__name__)
def test_plain_values_from_elsewhere_are_heard_again(tmp_path, value):
    """A module hears equal messages of equal types in the replay."""
    assert replayed(recorded(tmp_path, elsewhere(value), elsewhere([value])))[0] is None


@pytest.mark.parametrize(
    "value",
    [(1, 2), [(1,)], np.zeros(2), {1: 2}, {1}, b"x", 1j, np.float32(1.5), {"$float": "nan"},
     {"$array": "x"}, object(), datetime(2026, 6, 21), 2**70],
    ids=lambda value: type(value).__name__,
)  # fmt: skip
def test_a_value_from_elsewhere_that_would_be_another_is_refused(tmp_path, value):
    """A tuple would be a list in the replay, and a module may tell them apart."""
    with pytest.raises(UserError, match="could not be recorded at a JobResult"):
        recorded(tmp_path, elsewhere(value))
