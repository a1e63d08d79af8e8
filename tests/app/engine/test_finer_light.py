"""A picture that stands in the window gets light by rays of its own, and a moved one does not."""

from dataclasses import replace
from itertools import groupby

import msgspec
import numpy as np
import pytest
from test_window_exposure import INSIDE, OUTSIDE, RunningEngine
from window_driver import PATIENCE_MS

from vrut_lite.app.engine.finer_light import FinerLight
from vrut_lite.array import Array
from vrut_lite.kernel.bus import Kernel
from vrut_lite.messages.light_map import SurfaceLightChanged
from vrut_lite.messages.view_light import ViewLightChanged
from vrut_lite.scene.scene_state import SceneState

VIEW_LIGHT = ViewLightChanged(
    layout_key="l", camera=OUTSIDE, size_px=(16, 9), edge_px=2, radiance_scale=2.0, rays=64,
    light=Array(np.ones((5, 8, 4), np.float16)), plane=Array(np.ones((5, 8, 4), np.float32)),
    mirrored=Array(np.zeros((2, 5, 8, 4), np.float16)), source="s",
)  # fmt: skip

SURFACE_LIGHT = SurfaceLightChanged(
    layout_key="l", texels=Array(np.ones((4, 4, 4), np.float16)), probes=None,
    radiance_scale=1.0, rays=1, source="s",
)  # fmt: skip


def heard(state, message):
    """The state with a message that frame parts show."""
    own = {**state.parts.get("light_transport", {}), type(message): message}
    return replace(state, parts={**state.parts, "light_transport": own})


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
        stage._view.pending = heard(stage.state, VIEW_LIGHT)

    running.engine.ask(arrives, changes=True).result(PATIENCE_MS / 1000)
    running.wait(0.5)
    assert [shown.still for shown in running.shown] == [True]
    running.send(INSIDE)
    running.wait(0.1)
    assert not running.shown[-1].still
    assert not is_asked_for(running)


def test_light_that_comes_late_is_seen_in_a_finished_picture(running):
    """A picture that stands is not coarse again for it; the first light of surfaces is quick. The
    exposure may adapt afterwards, by pictures that are finished."""

    def arrives(light):
        def change(stage):
            stage._view.pending = heard(stage.state, light)

        running.shown.clear()
        running.engine.ask(change, changes=True).result(PATIENCE_MS / 1000)
        running.wait(0.5)
        return [still for still, _ in groupby(shown.still for shown in running.shown)]

    assert arrives(SURFACE_LIGHT) == [False, True]
    assert arrives(msgspec.structs.replace(SURFACE_LIGHT, rays=2)) == [True]


def test_rays_of_a_standing_picture_give_way_to_an_input_and_go_on_when_it_changed_nothing():
    """Until a second after the last input; a picture that is drawn meanwhile ends the pause."""
    kernel = Kernel()

    def is_wanted():
        kernel.pump_until_idle()
        return kernel.wanted(ViewLightChanged) is not None

    light, state = FinerLight(), SceneState()
    light.give_way(kernel, state, 0.0)
    assert light.resumes_at_s is None
    light.drew(kernel, still=True)
    light.resume(kernel, 0.0)
    assert is_wanted()
    for now_s in (10.0, 10.5):
        light.give_way(kernel, state, now_s)
        assert not is_wanted()
    light.resume(kernel, 11.4)
    assert not is_wanted()
    light.resume(kernel, 11.5)
    assert is_wanted()
    known = heard(replace(state, moved_camera=OUTSIDE, size_px=(16, 9)), VIEW_LIGHT)
    light.give_way(kernel, known, 12.0)
    assert is_wanted()
    light.give_way(kernel, state, 12.0)
    light.drew(kernel, still=False)
    light.resume(kernel, 20.0)
    assert not is_wanted()
    kernel.close()
