"""Background jobs: one runs, the latest waits, results come back as inputs or not at all."""

import threading

import pytest

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import FAULTS_UNTIL_SUSPENSION, Kernel
from vrut_lite.kernel.jobs import ThreadRunner
from vrut_lite.kernel.messages import EnableModule, Fault, Input, JobResult, RestartModule
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.recording.replay_runner import ReplayRunner


class Ask(Input, frozen=True, kw_only=True):
    """Start (or, without work, cancel) the job of a name."""

    work: object = None
    arguments: tuple = ()
    job: str = "sum"

    def key(self) -> None:
        return None


class Worker(Module):
    manifest = Manifest(name="worker", title="Worker", version="1")

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.results = []

    @handles(Ask)
    def on_ask(self, message: Ask) -> None:
        if message.work is None:
            self.link.cancel_job(message.job)
        else:
            self.link.start_job(message.job, message.work, *message.arguments)

    @handles(JobResult)
    def on_result(self, message: JobResult) -> None:
        self.results.append((message.job, message.value, message.error))


class Bystander(Module):
    manifest = Manifest(name="bystander", title="Bystander", version="1")
    heard = 0

    @handles(JobResult)
    def on_result(self, message: JobResult) -> None:
        self.heard += 1


def echo(value):
    return value


def kernel_with(runner):
    kernel = Kernel(runner=runner)
    kernel.add_module(Worker)
    kernel.add_module(Bystander)
    kernel.pump()
    return kernel


def ask(kernel, *asked):
    for message in asked:
        kernel.inject(message)
    kernel.pump()


def results(kernel):
    return kernel.seats["worker"].module.results


@pytest.mark.parametrize("make_runner", [ThreadRunner, ReplayRunner])
def test_only_the_asking_module_gets_a_result(make_runner):
    """Only the asking module gets a job's result, on threads as in a replay."""
    kernel = kernel_with(make_runner())
    ask(kernel, Ask(work=sum, arguments=((1, 2),)), Ask(work=echo, arguments=(7,), job="other"))
    kernel.pump_until_idle()
    assert sorted(results(kernel)) == [("other", 7, ""), ("sum", 3, "")]
    assert kernel.seats["bystander"].module.heard == 0
    kernel.close()


def test_of_pending_jobs_the_latest_wins():
    """A dragged slider asks for a hundred skies and gets the first and the last."""
    runner = ReplayRunner()
    kernel = kernel_with(runner)
    ask(kernel, *(Ask(work=echo, arguments=(number,)) for number in range(100)))
    kernel.pump_until_idle()
    assert [value for _, value, _ in results(kernel)] == [0, 99]


def test_a_held_result_is_admitted_when_it_is_released():
    """A replay admits a result where the journal has it, not when the work ended."""
    runner = ReplayRunner()
    kernel = kernel_with(runner)
    ask(kernel, Ask(work=echo, arguments=(1,)))
    kernel.pump()
    assert (results(kernel), runner.held) == ([], [("worker", "sum")])
    assert runner.release("worker", "sum")
    assert not runner.release("worker", "sum")
    kernel.pump()
    assert results(kernel) == [("sum", 1, "")]


def test_only_one_job_of_a_key_runs_at_a_time_even_after_cancelling():
    """A cancelled job cannot be torn from its thread; its successor waits for its return."""
    kernel = kernel_with(ThreadRunner())
    started, go_on, running = threading.Semaphore(0), threading.Event(), []

    def work(number, control):
        running.append(number)
        started.release()
        go_on.wait(10)
        running.remove(number)
        return number, len(running), control.cancelled()

    ask(kernel, Ask(work=work, arguments=(1,)))
    assert started.acquire(timeout=10)
    ask(kernel, Ask(), Ask(work=work, arguments=(2,)), Ask(work=work, arguments=(3,)))
    assert running == [1]
    go_on.set()
    kernel.pump_until_idle()
    assert [value for _, value, _ in results(kernel)] == [(2, 0, False), (3, 0, False)]
    kernel.close()


def test_work_that_asks_learns_that_it_was_cancelled():
    """A table of an hour's work must stop when a setting has made it useless."""
    kernel = kernel_with(ThreadRunner())
    started, stopped = threading.Event(), threading.Event()

    def work(control):
        started.set()
        while not control.cancelled():
            stopped.wait(0.001)
        stopped.set()

    ask(kernel, Ask(work=work))
    assert started.wait(10)
    ask(kernel, Ask())
    assert stopped.wait(10)
    kernel.close()


@pytest.mark.parametrize(
    "ending", [Ask(), RestartModule(module="worker"), EnableModule(module="worker", enabled=False)]
)
def test_a_late_result_is_dropped(ending):
    """A module that cancelled or was restarted must not get an old job's result."""
    runner = ReplayRunner()
    kernel = kernel_with(runner)
    admitted = []
    kernel.watch_admission(admitted.append)
    ask(kernel, Ask(work=echo, arguments=(1,)))
    # The result waits in the inbox, behind what makes it late.
    kernel.inject(ending)
    runner.release("worker", "sum")
    kernel.pump()
    kernel.inject(EnableModule(module="worker"))
    kernel.pump()
    assert results(kernel) == []
    assert not any(isinstance(message, JobResult) for message in admitted)


def test_work_that_raises_is_a_result_and_a_fault():
    """A module learns that its work failed; three failures suspend it like any three faults."""
    kernel = kernel_with(ReplayRunner())
    faults = []
    kernel.tap(lambda message, _: faults.append(message) if isinstance(message, Fault) else None)
    for _ in range(FAULTS_UNTIL_SUSPENSION):
        ask(kernel, Ask(work=int, arguments=("three",)))
        module = kernel.seats["worker"].module
        kernel.pump_until_idle()
    assert module.results[0][2].startswith("ValueError: invalid literal")
    assert {fault.where for fault in faults} == {"job sum"}
    assert [fault.suspended for fault in faults] == [False, False, True]


def test_an_error_without_a_trace_is_the_modules_to_answer():
    """A module that falls back to the CPU when a shader fails must not be suspended for it."""
    kernel = kernel_with(ReplayRunner())
    for _ in range(FAULTS_UNTIL_SUSPENSION):
        kernel.inject(JobResult(module="worker", job="shader", error="does not compile"))
    kernel.pump()
    assert results(kernel) == [("shader", None, "does not compile")] * FAULTS_UNTIL_SUSPENSION
    assert kernel.last_fault("worker") is None


def test_a_users_error_in_work_never_suspends():
    """Bad input is the user's to mend, wherever it was found."""

    def refuse():
        raise UserError("the file is empty: choose another")

    kernel = kernel_with(ReplayRunner())
    for _ in range(FAULTS_UNTIL_SUSPENSION + 1):
        ask(kernel, Ask(work=refuse))
        kernel.pump_until_idle()
    assert kernel.seats["worker"].running
    assert kernel.last_fault("worker").error == "the file is empty: choose another"


def test_progress_goes_to_the_trace_alone():
    """Progress depends on wall time, and so must not be a message that a replay would miss."""

    def work(control):
        control.progress(0.5, "half of the orders")

    kernel = kernel_with(ReplayRunner())
    heard = []
    kernel.tap(lambda message, _: heard.append(type(message).__name__))
    ask(kernel, Ask(work=work, job="orders"))
    kernel.pump_until_idle()
    assert heard == ["Ask", "JobResult"]
    remarks = [(remark.kind, remark.module, remark.text) for remark in kernel.trace.remarks()]
    assert ("progress", "worker", "orders: 50% half of the orders") in remarks
    assert ("job", "worker", "orders") in remarks


def test_after_closing_nothing_starts():
    """A closing window must not wait for jobs."""
    kernel = kernel_with(ThreadRunner())
    kernel.close()
    ask(kernel, Ask(work=echo, arguments=(1,)))
    assert "cannot schedule" in kernel.last_fault("worker").error
