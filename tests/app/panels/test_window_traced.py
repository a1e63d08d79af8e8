"""The path tracer's picture beside the frame: switched on, it grows; off, nobody traces."""

import numpy as np
import pytest
from path_tracer_here import mitsuba_or_skip
from PySide6.QtCore import Qt

from vrut_lite.kernel.messages import Demand, SetSetting


@pytest.fixture
def driver(drawn_window):
    mitsuba_or_skip()
    return drawn_window.activated()


def demands(driver):
    return [m.size for m in driver.heard if isinstance(m, Demand) and m.consumer == "window"]


def coarse(pixels):
    """Means of 16 x 16 pixels, in which the grain of few paths is gone."""
    rows, columns = (size // 16 for size in pixels.shape[:2])
    blocks = pixels[: 16 * rows, : 16 * columns].astype(float)
    return blocks.reshape(rows, 16, columns, 16, 3).mean(axis=(1, 3)).ravel()


@pytest.mark.long
@pytest.mark.gl
def test_the_path_traced_picture_grows_while_it_is_seen(driver):
    """Its key shows it beside the frame, with the samples that it has; a moved camera and
    other settings begin it anew, and hidden it costs nothing."""
    driver.session.send(SetSetting(module="path_tracer", name="spp", value=3))
    panel = driver.panel("panel path_tracer")
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_T)
    driver.until(lambda: panel.shown is not None and panel.shown.samples == 3)
    assert panel.progress.text() == "3 of 3 paths a pixel"
    # The sundial under the sky at the frame's exposure: its picture is the frame's, but for grain.
    driver.until(lambda: driver.session.shown.still)
    frame, traced = driver.session.shown.picture.display, panel.shown.pixels
    assert traced.shape == frame.shape
    assert abs(float(traced.mean()) - float(frame.mean())) < 8.0
    assert np.corrcoef(coarse(traced), coarse(frame))[0, 1] > 0.95
    driver.session.send(SetSetting(module="path_tracer", name="spp", value=4))
    driver.until(lambda: panel.shown.samples_wanted == panel.shown.samples == 4)
    driver.qtbot.keyClick(driver.window, Qt.Key.Key_T)
    assert not panel.isVisible()
    driver.until(lambda: demands(driver) == [None, 0])
    begun = driver.asked(lambda stage: stage.kernel.seats["path_tracer"].counters.done.copy())
    driver.session.send(SetSetting(module="path_tracer", name="spp", value=5))
    driver.settled()
    assert driver.asked(lambda stage: stage.kernel.seats["path_tracer"].counters.done) == begun
