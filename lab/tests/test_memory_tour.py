"""The window's memory stays the same, however many scenes are opened and however long it plays."""

import os
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("PySide6.QtWidgets", reason="the window needs PySide6")

# Openings after which caches have their final size, and minutes of play: of its clock's first day,
# whose night, once met, adds 140 MiB.
_FIRST_OPENINGS, _FIRST_DAY_MINUTES, _MOST_GROWTH = 10, 2.5, 0.05
_LONG_MINUTES = 5.0


@pytest.mark.long
@pytest.mark.gl
def test_scenes_and_play_leave_a_windows_memory_as_it_was(tmp_path, request):
    """Within 5 %, by the real window: twenty scenes and five minutes of play, or 50 scenes and
    --soak-minutes from five on."""
    from vrut_lite_lab.memory_tour.curve import columns_of

    minutes = request.config.getoption("--soak-minutes")
    openings = 50 if minutes >= _LONG_MINUTES else 20
    command = (
        *(sys.executable, "-m", "vrut_lite_lab.memory_tour", str(tmp_path), "--tours", "0"),
        *("--openings", str(openings), "--play", str(max(minutes, _LONG_MINUTES))),
    )
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
    columns = columns_of(tmp_path)
    resident = np.array(columns["resident"], float)
    chapters = np.array(columns["chapter"])
    opened = resident[chapters == "openings"][_FIRST_OPENINGS:openings]
    minute = np.array(columns["minute"], float)
    playing = np.array(columns["act"]) == "playing"
    played = resident[playing & (minute > minute[playing][0] + _FIRST_DAY_MINUTES)]
    for curve in (opened, played):
        third = max(len(curve) // 3, 1)
        # The least of each: memory that the allocator has not returned yet comes and goes.
        assert curve[-third:].min() < (1.0 + _MOST_GROWTH) * curve[:third].min()
