"""A picture that stands in the window gets light by rays of its own, and a moved one does not."""

from dataclasses import replace

import numpy as np
import pytest
from test_window_exposure import INSIDE, OUTSIDE, RunningEngine
from window_driver import PATIENCE_MS

from vrut_lite.array import Array
from vrut_lite.daylight.view_light import ViewLightChanged

VIEW_LIGHT = ViewLightChanged(
    layout_key="l", camera=OUTSIDE, size_px=(16, 9), edge_px=2, radiance_scale=2.0, rays=64,
    light=Array(np.ones((5, 8, 4), np.float16)), plane=Array(np.ones((5, 8, 4), np.float32)),
    mirrored=Array(np.zeros((2, 5, 8, 4), np.float16)), source="s",
)  # fmt: skip


@pytest.fixture
def running():
    running = RunningEngine()
    yield running
    running.engine.stop()
    assert running.engine.join(PATIENCE_MS / 1000)


def is_asked_for(running):
    answer = running.engine.ask(lambda stage: stage.kernel.wanted(ViewLightChanged) is not None)
    return answer.result(PATIENCE_MS / 1000)


def test_a_picture_at_rest_is_finished_anew_when_the_light_of_its_points_arrives(running):
    """No quick picture comes between: one sees it grow finer. A moved camera asks no more."""
    assert running.shown[-1].still
    assert is_asked_for(running)
    running.shown.clear()

    def arrives(stage):
        stage._view.state = replace(stage.state, view_light=VIEW_LIGHT)

    running.engine.ask(arrives, changes=True).result(PATIENCE_MS / 1000)
    running.wait(0.5)
    assert [shown.still for shown in running.shown] == [True]
    running.send(INSIDE)
    running.wait(0.1)
    assert not running.shown[-1].still
    assert not is_asked_for(running)
