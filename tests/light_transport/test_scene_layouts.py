"""The project's own scenes in the light map."""

from pathlib import Path

import numpy as np
import pytest
from layout_checks import check

from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.mark.parametrize(
    ("name", "most_charts", "least_fill"),
    [
        ("work/indoor.glb", 200, 0.75),
        *(
            pytest.param(*case, marks=pytest.mark.long)
            for case in [
                ("work/room.glb", 100, 0.8),
                ("work/ground.glb", 300, 0.6),
                ("large/hall.glb", 200, 0.75),
                ("large/satellite.glb", 250, 0.65),
                ("street.obj", 5000, 0.7),
                ("pavilion.gltf", 700, 0.6),
                ("sundial.glb", 300, 0.55),
            ]
        ),
    ],
)
def test_scenes_fill_a_small_map_with_few_charts(name, most_charts, least_fill):
    """Some 150,000 texels, each of one triangle, and look-ups that stay on their surface."""
    scene = packed(load_scene(SCENES / name))
    layout = check(scene)
    assert 105_000 < layout.texels < 170_000
    assert layout.charts <= most_charts
    assert layout.texels / np.prod(layout.message.size_px) > least_fill
    assert (layout.message.part_shape.values >= 0).all()
