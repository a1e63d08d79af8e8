"""The profiler over the picture: what takes the time, what is left out, what is waited for."""

import time
from itertools import takewhile

import pytest
from PySide6.QtCore import Qt
from window_driver import NOON

from vrut_lite.app.engine.profile import FRAME, Profile, Profiler
from vrut_lite.app.view.profiler_overlay import lines_of
from vrut_lite.kernel.messages import ClockMoved, RestartModule, SetClock
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.render.device import Device
from vrut_lite.sky.device_choice import DeviceChoice


class Sleeping(Module):
    manifest = Manifest(name="sleeping", title="Sleeping", version="1")

    @handles(ClockMoved)
    def on_clock(self, message):
        time.sleep(0.5)
        self.counters.skip("dreaming", 3)


@pytest.fixture
def driver(headless_window):
    return headless_window.activated()


def line(overlay, name):
    return next((line for line in overlay.lines if line.name == name), None)


def open_profiler(driver):
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_F3)
    overlay = driver.window.profiler
    driver.until(lambda: line(overlay, "Frame") is not None)
    return overlay


@pytest.mark.long
def test_the_milliseconds_of_a_module_and_what_it_leaves_out_are_shown(driver):
    """A module that sleeps half a second is seen with that, above all that took less, and with the
    work it skips."""
    # Whatever else is done at a move of the clock is compiled by then.
    driver.session.send(SetClock(instant=NOON.replace(minute=2)))
    driver.settled()
    driver.asked(lambda stage: stage.kernel.add_module(Sleeping))
    overlay = open_profiler(driver)
    driver.session.send(SetClock(instant=NOON.replace(minute=1)))
    driver.until(lambda: line(overlay, "sleeping") is not None)
    assert line(overlay, "sleeping").ms >= 500.0
    names = [line.name for line in overlay.lines]
    heading = next(i for i, name in enumerate(names) if name.startswith("Modules"))
    modules = list(takewhile(lambda line: not line.heading, overlay.lines[heading + 1 :]))
    assert "sleeping" in [line.name for line in modules]
    spent_ms = [line.ms for line in modules]
    assert spent_ms == sorted(spent_ms, reverse=True)
    assert line(overlay, "sleeping: dreaming").value == "3"
    assert driver.window.actions_by_name["profiler"].isChecked()


@pytest.mark.long
def test_the_longest_wait_of_the_window_is_shown(driver):
    """Something that holds the window's own thread for 80 ms is told as such."""
    overlay = open_profiler(driver)
    time.sleep(0.08)
    driver.until(
        lambda: float(line(overlay, "longest wait of the window").value.split()[0]) >= 75.0
    )


def test_hidden_it_measures_nothing(driver):
    """A hidden profiler measures nothing in window and kernel."""
    overlay = open_profiler(driver)
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_F3)
    assert not overlay.isVisible()
    assert not overlay._looking.isActive()
    assert not overlay._beating.isActive()


@pytest.mark.gl
def test_passes_of_the_frame_and_work_that_frames_leave_out(drawn_window):
    """The profiler lists the frame's passes and its skipped work; before, no pass was measured."""
    assert not drawn_window.asked(lambda stage: stage.pass_seconds)
    overlay = open_profiler(drawn_window.activated())
    drawn_window.session.send(SetClock(instant=NOON.replace(minute=1)))
    drawn_window.until(lambda: line(overlay, "frame: upload: unchanged") is not None)
    passes = set(drawn_window.asked(lambda stage: stage.pass_seconds))
    assert len(passes) >= 3
    assert passes & {line.name for line in overlay.lines}
    assert float(line(overlay, "Frame").value.split()[0].replace(",", "")) > 0.0
    # "auto" with a renderer that draws as a processor does.
    assert line(overlay, "sky computed by").value == "processor"
    assert line(overlay, "light computed by").value == "processor"


# --- the parts, without a window -----------------------------------------------------------


@pytest.fixture
def stage():
    from window_driver import HeadlessStage

    stage = HeadlessStage()
    stage.kernel.add_module(Sleeping)
    yield stage
    stage.close()


def tick(stage, minute):
    stage.kernel.inject(SetClock(instant=NOON.replace(minute=minute)))
    stage.kernel.pump_until_idle()


@pytest.mark.long
def test_a_profile_holds_what_happened_since_the_one_before(stage):
    """Counts and times of that span alone; a module that started anew counts from zero."""
    profiler = Profiler(stage)
    tick(stage, 1)
    tick(stage, 2)
    first = profiler.take()
    assert first.modules["sleeping"] >= 100.0
    assert first.skipped[("sleeping", "dreaming")] == 6
    assert first.span_s >= 0.1
    nothing = profiler.take()
    assert "sleeping" not in nothing.modules
    assert not nothing.skipped
    stage.kernel.inject(RestartModule(module="sleeping"))
    tick(stage, 3)
    again = profiler.take()
    assert again.skipped[("sleeping", "dreaming")] == 6
    stage.frame_counters.skip("mesh: out of view", 5)
    assert profiler.take().skipped == {(FRAME, "mesh: out of view"): 5}


def test_a_profile_in_lines():
    """The longest and the most first, what rounds to nothing left out."""
    profile = Profile(
        span_s=0.5,
        modules={"scene": 1.0, "clouds": 7.25, "bridge": 0.01},
        jobs={"bruneton_sky: solve": 812.0},
        passes={"sky": 3.0, "meshes": 30.0},
        skipped={("frame", "mesh"): 1200, ("scene", "air"): 2},
        device=Device("llvmpipe", "4.5", 95.0),
        devices={
            "sky": DeviceChoice(True, "0.16 of 2 ms, trial 0.1 ns", 1024),
            "air": DeviceChoice(False, "the card failed"),
        },
    )
    lines = lines_of(profile, 40.0, 12.0, 55.0, (0.06, 0.11))
    lines = [(line.name, line.value) for line in lines]
    assert lines == [
        ("Frame", "40 ms"),
        ("since the picture before", "55 ms"),
        ("longest wait of the window", "12 ms"),
        ("gesture to whole state, 95 %", "60, 110 ms"),
        ("meshes", "30.0"),
        ("sky", "3.0"),
        ("Modules, in 0.5 s", "ms"),
        ("clouds", "7.2"),
        ("scene", "1.0"),
        ("Jobs that ended", "ms"),
        ("bruneton_sky: solve", "812.0"),
        ("Drawn by", "processor"),
        ("trial, a pixel", "95 ns"),
        ("while something moves", "one sample, taken over"),
        ("sky computed by", "card, 1024\N{SUPERSCRIPT TWO}"),
        ("because", "0.16 of 2 ms, trial 0.1 ns"),
        ("air computed by", "processor"),
        ("because", "the card failed"),
        ("Work left out", "times"),
        ("frame: mesh", "1,200"),
        ("scene: air", "2"),
    ]
