"""A revision holds one gesture: its inputs, and the awaited results of the jobs they cause."""

import pytest

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Input, JobResult
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.recording.replay_runner import ReplayRunner


class Ask(Input, frozen=True, kw_only=True):
    """Start a job in a role; its result starts a job of the next name, if there is one."""

    jobs: tuple[str, ...]
    role: str = "awaited"

    def key(self) -> None:
        return None


class Turn(Input, frozen=True, kw_only=True):
    """Begins no revision."""

    revises = False

    number: int = 0


class Open(Turn, frozen=True, kw_only=True):
    """Nothing overtakes it."""

    revises = True
    is_barrier = True


class Worker(Module):
    manifest = Manifest(name="worker", title="Worker", version="1")

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.heard = []

    @handles(Ask)
    def on_ask(self, message):
        self.heard.append(message.jobs)
        self.link.start_job(message.jobs[0], lambda: message.jobs[1:], role=message.role)

    @handles(Turn)
    @handles(Open)
    def on_turn(self, message):
        self.heard.append(type(message).__name__)
        if message.number:
            self.link.start_job("turn", tuple, role="awaited")

    @handles(JobResult)
    def on_result(self, message):
        self.heard.append(message.job)
        if message.value:
            name, *later = message.value
            self.link.start_job(name, lambda: tuple(later), role="awaited")


@pytest.fixture
def kernel():
    kernel = Kernel(runner=ReplayRunner())
    kernel.add_module(Worker)
    kernel.pump()
    return kernel


def heard(kernel):
    return kernel.seats["worker"].module.heard


def act(kernel, *inputs, within=False):
    kernel.inject(*inputs)
    kernel.pump(within=within)


def finish_one(kernel, within=True):
    """Let the jobs that run end, and the kernel act on their results alone."""
    kernel.runner.wait()
    kernel.pump(within=within)


def test_inputs_of_one_gesture_begin_one_revision_and_a_camera_none(kernel):
    act(kernel, Ask(jobs=("one",)), Ask(jobs=("two",)))
    assert kernel.revision == 1
    act(kernel, Turn())
    assert kernel.revision == 1
    act(kernel, Ask(jobs=("three",)))
    assert kernel.revision == 2


def test_a_revision_is_whole_with_the_last_result_of_its_chain(kernel):
    """The sum of the sky starts the light of surfaces: a picture needs both."""
    act(kernel, Ask(jobs=("sum", "hour")))
    assert not kernel.is_whole
    finish_one(kernel)
    assert heard(kernel)[-1] == "sum"
    assert not kernel.is_whole
    finish_one(kernel)
    assert heard(kernel)[-1] == "hour"
    assert kernel.is_whole


@pytest.mark.parametrize("role", ["aside", "refines", "drafted"])
def test_other_jobs_are_not_awaited(kernel, role):
    act(kernel, Ask(jobs=("rays",), role=role))
    assert kernel.is_whole
    assert kernel.jobs.modules(role) == ("worker",)


def test_what_a_camera_starts_is_not_awaited(kernel):
    """It must not hold up pictures; and it lets a revision wait that it replaces a job of."""
    act(kernel, Turn(number=1))
    assert kernel.is_whole
    act(kernel, Ask(jobs=("turn",)))
    act(kernel, Turn(number=2))
    finish_one(kernel)
    assert not kernel.is_whole
    finish_one(kernel)
    assert kernel.is_whole


def test_within_a_revision_no_other_begins(kernel):
    """Results come in, and a camera's move, but not past the scene that it was sent after."""
    act(kernel, Ask(jobs=("one",)))
    act(kernel, Ask(jobs=("two",)), within=True)
    act(kernel, Turn(), within=True)
    act(kernel, Open(), within=True)
    act(kernel, Turn(number=3), within=True)
    assert heard(kernel) == [("one",), "Turn"]
    finish_one(kernel)
    assert heard(kernel) == [("one",), "Turn", "one"]
    assert kernel.is_whole
    kernel.pump()
    assert heard(kernel)[3:] == [("two",), "Open", "Turn"]


def test_a_draft_serves_in_place_of_what_takes_long_and_its_result_is_awaited_anew(kernel):
    """A late result may start further work; pictures wait for both."""
    act(kernel, Ask(jobs=("layout", "hour")))
    kernel.jobs.await_no_longer()
    assert kernel.is_whole
    assert kernel.jobs.modules("drafted") == ("worker",)
    act(kernel, Turn())
    finish_one(kernel)
    assert not kernel.is_whole
    finish_one(kernel)
    assert kernel.is_whole
    assert kernel.jobs.modules("drafted") == ()


def test_a_result_from_outside_can_be_awaited(kernel):
    """A texture that the GPU makes is no job of the kernel's."""
    link = kernel.seats["worker"].link
    act(kernel, Ask(jobs=("one",)))
    finish_one(kernel)
    kernel.jobs.revision = kernel.revision
    link.await_result("cube")
    assert not kernel.is_whole
    act(kernel, JobResult(module="worker", job="cube"), within=True)
    assert kernel.is_whole
