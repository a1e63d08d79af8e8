"""Without OpenGL the window shows the sky, from the same cube map as with it."""

from dataclasses import replace

import numpy as np
import pytest
from window_driver import SCENES, WindowDriver

from vrut_lite.app.engine import cpu_sky
from vrut_lite.app.engine.cpu_sky import CpuSkyStage, best_stage
from vrut_lite.errors import UserError
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.picture import SetExposure

UP = MoveCamera(eye_m=(1.5, 1.5, 3.4), target_m=(0.0, 6.0, 0.0), vertical_field_of_view_rad=0.8)


def test_without_opengl_there_is_the_sky_and_a_line(monkeypatch):
    """The reason is told among the failures; libraries there but no context is such a case."""

    def refuse():
        raise UserError("no OpenGL 4.3 through EGL here")

    monkeypatch.setattr(cpu_sky, "GlStage", refuse)
    stage = best_stage()
    assert isinstance(stage, CpuSkyStage)
    assert stage.failures == ["the sky alone is drawn, on the CPU: no OpenGL 4.3 through EGL here"]
    stage.close()


def test_the_window_draws_the_sky_on_the_cpu(qtbot, tmp_path):
    """All panels work; the picture is blue above at noon and obeys the exposure."""
    driver = WindowDriver(qtbot, lambda: CpuSkyStage("no context"), tmp_path)
    driver.session.send(UP, SetExposure(mode="manual", ev100=13.0))
    driver.until(lambda: driver.session.shown.picture.ev100 == 13.0)
    radiance = driver.session.shown.picture.radiance
    assert np.isfinite(radiance).all()
    red, _, blue = radiance.mean(axis=(0, 1))
    assert blue > 1.5 * red > 0.0
    facts = driver.window.statusBar().facts
    assert facts.text().strip().endswith("CPU, sky alone")
    # The line with the reason fades; the tooltip stays.
    assert facts.toolTip() == "CPU, sky alone (no context)"
    driver.close()


@pytest.mark.gl
def test_the_cpu_sky_is_the_frames_own(qtbot, tmp_path):
    """Where no mesh stands both show the same radiance: 2 % for other cube sizes and filters."""
    from vrut_lite.app.engine.session_project import inputs_of
    from vrut_lite.app.engine.stage import GlStage
    from vrut_lite.project import load_project

    skies = []
    for open_stage in (GlStage, lambda: CpuSkyStage("for comparison")):
        stage = open_stage()
        for message in [*inputs_of(load_project(SCENES / "sundial.toml"), stage.kernel), UP]:
            stage.kernel.inject(message)
        stage.kernel.pump_until_idle()
        state = replace(stage.state, size_px=(120, 80), exposure=SetExposure())
        skies.append(stage.draw(state, True).radiance)
        stage.close()
    assert np.median(np.abs(skies[1] / skies[0] - 1.0)) < 0.02
