"""One revision after the other: the next begins when the present one is whole, or a draft is."""

import pytest

from vrut_lite.app.engine.revision_gate import RevisionGate
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Input
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.recording.replay_runner import ReplayRunner


class Ask(Input, frozen=True, kw_only=True):
    """An hour that is dragged: the latest that waits counts."""

    number: int


class Light(Module):
    """Computes an hour in a job."""

    manifest = Manifest(name="light", title="Light", version="1")

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.hours = []

    @handles(Ask)
    def on_ask(self, message):
        self.hours.append(message.number)
        self.link.start_job("hour", tuple, role="awaited")


class Drag:
    """A kernel behind a gate of a quarter of a second, on a clock of the test's own."""

    def __init__(self):
        self.now_s = 100.0
        self.kernel = Kernel(runner=ReplayRunner())
        self.kernel.add_module(Light)
        self.gate = RevisionGate(0.25, lambda: self.now_s)
        self.pump()

    @property
    def hours(self):
        return self.kernel.seats["light"].module.hours

    def pump(self, **how):
        self.gate.pump(self.kernel, **how)

    def ask(self, number):
        self.kernel.inject(Ask(number=number))
        self.pump()


@pytest.fixture
def drag():
    return Drag()


def test_hours_that_come_meanwhile_merge_until_the_present_one_is_whole(drag):
    """None is computed that no picture shows."""
    for number in range(4):
        drag.ask(number)
    assert drag.hours == [0]
    drag.now_s += 0.1
    drag.kernel.runner.wait()
    drag.pump()
    assert drag.kernel.is_whole
    # It is drawn before the next one begins.
    assert drag.hours == [0]
    drag.pump()
    assert drag.hours == [0, 3]
    assert drag.gate.percentile_s(95) == pytest.approx(0.1)


def test_a_draft_ends_the_wait(drag):
    """So that pictures never starve; the hour under way is shown when it comes."""
    drag.ask(0)
    drag.ask(1)
    drag.now_s = drag.gate.due_s - 0.001
    drag.pump()
    assert not drag.kernel.is_whole
    drag.now_s += 0.002
    drag.pump()
    assert drag.kernel.is_whole
    assert drag.kernel.jobs.modules("drafted") == ("light",)
    drag.pump()
    assert drag.hours == [0, 1]


def test_no_revision_begins_beside_a_picture_that_shows_another(drag):
    drag.kernel.inject(Ask(number=0))
    drag.pump(may_begin=False)
    assert drag.hours == []
    drag.pump()
    assert drag.hours == [0]


def test_a_question_is_asked_after_all_that_was_sent_before(drag):
    drag.ask(0)
    drag.kernel.inject(Ask(number=1))
    drag.gate.pump_all(drag.kernel)
    assert drag.hours == [0, 1]
    assert not drag.kernel.is_whole
