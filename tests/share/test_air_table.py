"""The air of a page against the sky's own, which pictures of the program look up."""

import math
from pathlib import Path

import msgspec
import numpy as np
import pytest
from share.air_table import BELOW, VIEWS, air_table
from share.shared_scene import SharedScene
from share.sky_table import COLUMNS, sky_table

from vrut_lite.geometry.colour import luminance
from vrut_lite.project import project_of_path
from vrut_lite.sky.air_volume import look_up_air

SCENE = str(Path(__file__).parents[2] / "scenes" / "work" / "room.glb")
SIZE_M = 20.0


def skies_of(**changes):
    project = msgspec.structs.replace(project_of_path(SCENE), **changes)
    opened = SharedScene(project)
    try:
        return opened.sun_skies(np.radians([0.0, 20.0]))
    finally:
        opened.close()


def test_air_is_that_of_the_sky_in_every_direction():
    """Upwards, level and down, towards the sun and away: at nodes, and along the scene's size."""
    skies = skies_of()
    table = sky_table(skies)
    air = air_table(skies, table, SIZE_M)
    sky, shares = skies[1], air.radiance[1].astype(float)
    layer, sunlit = shares[..., :3] * table.level_rgb[1], shares[..., 3]
    heights = {0: -0.5 * math.pi, BELOW - 1: 0.0, BELOW: 0.0, len(layer) - 1: 0.5 * math.pi}
    for row, height in heights.items():
        for column in (0, COLUMNS // 2, COLUMNS - 1):
            turned = sky.azimuth_rad + math.pi * (column / (COLUMNS - 1)) ** 2
            level = math.cos(height)
            d = [level * math.sin(turned), math.sin(height), -level * math.cos(turned)]
            found = look_up_air(sky.air, d, 0.5 * SIZE_M)
            mean = (found.shaded + found.sunlit) / (1.0 - found.transmittance)
            assert layer[row, column] == pytest.approx(mean, rel=2e-3)
            share = luminance(found.sunlit) / luminance(found.shaded + found.sunlit)
            assert sunlit[row, column] == pytest.approx(share, rel=2e-3)
    left = look_up_air(sky.air, [0.0, 0.0, -1.0], SIZE_M).transmittance
    assert np.exp(-air.optical_depth[VIEWS // 2].astype(float)) == pytest.approx(left, rel=1e-4)
    # Beside the sun haze is brighter than away from it.
    assert layer[BELOW + 15, 0, 1] > 2.0 * layer[BELOW + 15, -1, 1]


def test_a_scene_to_be_seen_without_air_has_none():
    skies = skies_of(air=False)
    air = air_table(skies, sky_table(skies), SIZE_M)
    assert not air.radiance.any()
    assert not air.optical_depth.any()
