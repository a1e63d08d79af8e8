"""The kernel acts on inputs beside a moving picture, so that the next one need not wait for it."""

import threading
import time
from datetime import timedelta

import pytest
from window_driver import NOON, PATIENCE_MS, SUNDIAL_AT_NOON, HeadlessStage

from vrut_lite.app.engine.engine import Engine
from vrut_lite.app.engine.revision_news import HEARD, PICTURE, PROBLEM
from vrut_lite.kernel.messages import ClockMoved, SetClock
from vrut_lite.messages.camera import MoveCamera

FROM_HERE = MoveCamera(
    eye_m=(3.0, 1.0, 4.0), target_m=(0.0, 0.0, 0.0), vertical_field_of_view_rad=0.9
)


class GatedEngine:
    """An engine whose moving pictures wait at a gate, and what it told.

    `drawn` are the sun's directions in the moving pictures that have begun.
    """

    def __init__(self):
        self.drawn, self.hours, self.problems, self.stills = [], [], [], 0
        self.gate, self.fails = threading.Event(), False
        self.gate.set()
        gated = self

        class Stage(HeadlessStage):
            def draw(self, state, still, is_given_up=None):
                if not still:
                    gated.drawn.append(state.key_light.direction)
                    assert gated.gate.wait(PATIENCE_MS / 1000)
                    if gated.fails:
                        raise RuntimeError("the gate is stuck")
                return super().draw(state, still, is_given_up)

        self.engine = Engine(Stage, self._told)
        self.engine.start()
        self.send(*SUNDIAL_AT_NOON, FROM_HERE)
        self.rest()

    def _told(self, key, value):
        if key == PICTURE:
            self.stills += value.still
        elif key[0] == PROBLEM:
            self.problems.append(value)
        elif key[0] == HEARD and isinstance(value[0], ClockMoved):
            self.hours.append(value[0].instant)

    def send(self, *inputs):
        self.engine.send(*inputs)

    def until(self, condition):
        end_s = time.monotonic() + PATIENCE_MS / 1000
        while not condition():
            assert time.monotonic() < end_s
            time.sleep(0.001)

    def reach_the_second_hour(self):
        """The picture of the first hour is at the gate, and the kernel has acted on the second."""
        self.gate.clear()
        self.send(SetClock(instant=after(1)))
        self.until(lambda: self.drawn)
        self.send(SetClock(instant=after(2)))
        self.until(lambda: after(2) in self.hours)

    def rest(self):
        """Wait for a finished picture, and forget what was told."""
        before = self.stills
        self.gate.set()
        self.until(lambda: self.stills > before)
        self.drawn.clear()
        self.hours.clear()


@pytest.fixture
def running():
    running = GatedEngine()
    yield running
    running.gate.set()
    running.engine.stop()
    assert running.engine.join(PATIENCE_MS / 1000)


def after(hours):
    return NOON + timedelta(hours=hours)


def test_the_kernel_acts_beside_a_picture_on_what_the_next_one_shows(running):
    """A picture takes as long as the sky of the next hour: one after the other would show fewer.
    It acts once: hours that come later merge, and none is computed that no picture shows."""
    running.reach_the_second_hour()
    for hours in (3, 4, 5):
        running.send(SetClock(instant=after(hours)))
    assert running.hours == [after(1), after(2)]
    assert len(running.drawn) == 1
    running.gate.set()
    running.until(lambda: len(running.drawn) == 3)
    assert running.hours == [after(1), after(2), after(5)]
    assert len(set(running.drawn)) == 3
    assert running.drawn[0][0] > running.drawn[1][0] > running.drawn[2][0]


def test_a_question_beside_a_picture_finds_all_that_was_sent_before_it(running):
    """As an undo does; what the kernel did beside the picture is not all."""
    running.reach_the_second_hour()
    running.send(SetClock(instant=after(3)))
    hour = running.engine.ask(lambda stage: stage.kernel.last(ClockMoved).instant)
    running.gate.set()
    assert hour.result(PATIENCE_MS / 1000) == after(3)


def test_a_picture_that_fails_loses_nothing_that_the_kernel_did_beside_it(running):
    """The trouble is told, and the next picture shows the hour that came meanwhile."""
    running.reach_the_second_hour()
    running.fails = True
    running.gate.set()
    running.until(lambda: running.problems)
    running.fails = False
    running.until(lambda: len(running.drawn) == 2)
    assert running.drawn[0][0] > running.drawn[1][0]
    assert "the gate is stuck" in running.problems[0]
