"""Automatic exposure of real pictures while an hour is dragged."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from vrut_lite.host import Host
from vrut_lite.kernel.messages import SetClock
from vrut_lite.pictures.exposure import automatic_ev100
from vrut_lite.project import Project, daylight_inputs, setting_inputs, view_inputs

pytestmark = pytest.mark.gl
SUNDIAL = Path(__file__).parents[2] / "scenes" / "sundial.glb"
MINUTES = 2


def test_exposure_does_not_jump_while_the_sun_rises():
    """Around sunrise the correction comes in gradually: by a fifth of a
    stop a minute at most, as the exposure itself, which dawn moves by as much."""
    project = Project(
        scene=str(SUNDIAL),
        size=(64, 40),
        at="2026-06-21T05:00",
        settings={"light_transport": {"on": False}},
    )
    start = datetime(2026, 6, 21, 2, 44, tzinfo=UTC)
    corrected, correction = [], []
    with Host(cube_size=64) as host:
        host.inject(*setting_inputs(project, host.kernel))
        host.inject(*daylight_inputs(project), *view_inputs(project))
        for step in range(30):
            host.inject(SetClock(instant=start + timedelta(minutes=MINUTES * step)))
            host.settle()
            picture = host.draw()
            corrected.append(picture.ev100)
            correction.append(automatic_ev100(picture.radiance) - picture.ev100)
    assert correction[0] == 0.0
    assert correction[-1] > 0.5
    assert np.abs(np.diff(correction)).max() < 0.2 * MINUTES
    assert np.abs(np.diff(corrected)).max() < 0.2 * MINUTES
