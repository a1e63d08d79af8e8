import numpy as np
import pytest
from session import JOURNAL, MODULES, open_kernel, play, rain, sun_at
from vrut_lite.kernel.messages import EnableModule, Fault

from new_layer.bow import BINS, STEP_DEG, RainbowShown, phase_rgb, radiance


@pytest.fixture
def kernel():
    """The real kernel; every fault fails the test."""
    kernel, faults = open_kernel(), []
    kernel.tap(lambda message, _: faults.append(message) if isinstance(message, Fault) else None)
    yield kernel
    kernel.close()
    assert faults == []


def test_the_recorded_session_replays(replay_journal):
    """A difference is a changed layer: accept it with --update-journals."""
    assert replay_journal(JOURNAL, MODULES).messages > 5


def test_the_bows_stand_where_descartes_found_them():
    """Brightest at 42.3 (red) and 50.6 degrees; the band between them is dark."""
    angle_deg = (np.arange(BINS) + 0.5) * STEP_DEG
    red, _, blue = phase_rgb().T
    first, second = (angle_deg > 38.0) & (angle_deg < 45.0), (angle_deg > 48.0) & (angle_deg < 55.0)
    assert angle_deg[first][red[first].argmax()] == pytest.approx(42.2, abs=0.4)
    assert angle_deg[first][blue[first].argmax()] == pytest.approx(40.8, abs=0.5)
    assert angle_deg[second][red[second].argmax()] == pytest.approx(50.6, abs=0.5)
    assert angle_deg[second][blue[second].argmax()] > 51.5
    dark = (angle_deg > 44.0) & (angle_deg < 49.0)
    assert red[dark].max() < 0.05 * red[first].max()


def test_a_drop_sends_out_no_more_than_falls_on_it():
    edges_rad = np.radians(np.arange(BINS + 1) * STEP_DEG)
    cap_sr = 2.0 * np.pi * -np.diff(np.cos(edges_rad))
    assert np.all(phase_rgb() >= 0.0)
    assert np.all(cap_sr @ phase_rgb() < 0.1)


def test_the_bow_is_opposite_the_sun_and_as_bright_as_the_rain(kernel):
    play(kernel, [sun_at(10.0), rain(0.5)])
    shown = kernel.last(RainbowShown)
    turned = np.radians(42.0 - 10.0)
    towards = np.array([-np.cos(turned), np.sin(turned), 0.0])
    bow = radiance(shown, towards)
    assert bow.min() > 0.0
    play(kernel, [rain(1.0)])
    assert radiance(kernel.last(RainbowShown), towards) == pytest.approx(2.0 * bow)
    assert radiance(shown, -towards).max() == 0.0


def test_there_is_none_at_night_nor_without_rain(kernel):
    play(kernel, [sun_at(10.0), rain(0.5), sun_at(-5.0)])
    assert max(kernel.last(RainbowShown).light_rgb) == 0.0
    play(kernel, [sun_at(10.0), rain(0.0)])
    assert max(kernel.last(RainbowShown).light_rgb) == 0.0


def test_it_comes_back_with_its_module(kernel):
    """The scene drops what a disabled module showed: it is posted again, though it is the same."""
    posted = []
    kernel.tap(lambda message, _: posted.append(message))
    play(kernel, [sun_at(10.0), rain(0.5)])
    shown = kernel.last(RainbowShown)
    posted.clear()
    play(kernel, [EnableModule(module="new_layer", enabled=False)])
    play(kernel, [EnableModule(module="new_layer")])
    assert [message for message in posted if isinstance(message, RainbowShown)] == [shown]
