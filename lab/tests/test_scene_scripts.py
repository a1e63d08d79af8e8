"""The committed scenes are their scripts' output, and the climb finds jumps of light."""

import numpy as np
import pytest
from long_parameters import mostly_long

from vrut_lite_lab.pictures.climb import heights_m, steps_between
from vrut_lite_lab.scenes.build_scenes import SCENES, SETS

ASSETS = {".glb", ".gltf", ".bin", ".obj", ".mtl", ".png"}
# Eroding the terrain takes 20 s, the small set's textures 10.
SLOW = {"small", "large"}


@pytest.mark.parametrize("name", mostly_long(SETS, lambda name: name not in SLOW))
def test_the_scripts_make_the_committed_bytes(name):
    """Nobody edits a scene by hand, and none lies there that no script makes."""
    subfolder, scripts = SETS[name]
    folder = SCENES / subfolder
    made = {file: data for script in scripts for file, data in script.build().items()}
    assert set(made) == {path.name for path in folder.iterdir() if path.suffix in ASSETS}
    for file, data in made.items():
        assert data == (folder / file).read_bytes(), file


def test_the_climb_tells_a_jump_of_light_from_what_moves():
    """A step in brightness between two of many pictures is reported; an edge that moves is not."""
    rows = np.arange(90)[:, None, None]
    pictures = []
    for number in range(40):
        lit = np.where(rows < 30 + number, 200.0, 40.0) + (12.0 if number >= 25 else 0.0)
        pictures.append(np.broadcast_to(lit, (90, 120, 3)).astype(np.uint8))
    steps = steps_between(heights_m(1.4)[:40], pictures)
    told = [number for number, step in enumerate(steps) if step.jump]
    assert 24 in told
    assert set(told) <= {23, 24, 25}
