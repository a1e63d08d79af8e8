"""The scenes that need little: they are what their script makes, and they are what they say."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from vrut_lite.scene.ground import has_own_ground
from vrut_lite.scene.loading import load_scene

SCENES = Path(__file__).resolve().parents[2] / "scenes"
NAMES = ["ground.glb", "indoor.glb", "planet.glb", "room.glb"]


@pytest.fixture(scope="module")
def scenes():
    return {name: load_scene(SCENES / "work" / name) for name in NAMES}


def test_the_script_makes_the_committed_bytes(tmp_path):
    """Nobody edits them by hand; each below 300 kB."""
    command = [
        sys.executable,
        "-m",
        "vrut_lite_lab.scenes.build_scenes",
        "work",
        "--into",
        tmp_path,
    ]
    subprocess.run(command, cwd=SCENES.parent, check=True, capture_output=True)
    assert sorted(path.name for path in (SCENES / "work").iterdir()) == NAMES
    for name in NAMES:
        made = (tmp_path / name).read_bytes()
        assert made == (SCENES / "work" / name).read_bytes(), name
        assert len(made) < 300_000


def test_only_the_planet_brings_its_ground_and_is_as_large_as_one(scenes):
    """More than 2,000 km across and curved as the Earth: 126 km lower at the rim (1 % of that)."""
    assert {name for name, scene in scenes.items() if has_own_ground(scene)} == {"planet.glb"}
    planet = scenes["planet.glb"]
    size_m = planet.upper_m - planet.lower_m
    assert size_m[0] > 2e6
    rim_m = 6.36e6 * (1.0 - np.cos(0.2))
    np.testing.assert_allclose(-planet.lower_m[1], rim_m, rtol=0.01)
