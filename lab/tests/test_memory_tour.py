"""The window's memory stays the same, however many scenes are opened and however long it plays."""

import os
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("PySide6.QtWidgets", reason="the window needs PySide6")

# Openings and samples of play after which caches have their final size.
_FIRST_OPENINGS, _MOST_GROWTH = 10, 0.05
_LONG_MINUTES = 5.0


@pytest.mark.long
@pytest.mark.gl
def test_scenes_and_play_leave_a_windows_memory_as_it_was(tmp_path, request):
    """Within 5 %, by the real window: 50 scenes and --soak-minutes of play from five minutes on, a
    few of both before."""
    from vrut_lite_lab.memory_tour.curve import columns_of

    minutes = request.config.getoption("--soak-minutes")
    openings = 50 if minutes >= _LONG_MINUTES else 20
    command = (
        *(sys.executable, "-m", "vrut_lite_lab.memory_tour", str(tmp_path), "--tours", "0"),
        *("--openings", str(openings), "--play", str(max(minutes, 1.0))),
    )
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
    columns = columns_of(tmp_path)
    resident = np.array(columns["resident"], float)
    chapters = np.array(columns["chapter"])
    # Two scenes in turn: means over pairs.
    opened = resident[chapters == "openings"][_FIRST_OPENINGS : openings // 2 * 2]
    played = resident[chapters == "play"]
    for curve in (opened, played[len(played) // 4 :]):
        third = max(len(curve) // 3, 1)
        assert curve[-third:].mean() < (1.0 + _MOST_GROWTH) * curve[:third].mean()
