"""The albedo at a scene's border, which the ground around it continues."""

import numpy as np
import pytest
import trimesh

from vrut_lite.scene.border import border_albedo
from vrut_lite.scene.loading import load_scene

# Mean reflectance of a rough dielectric's coat in even light, by the table of the shaders.
COAT = 0.02
LAWN, STONE, ROOF = (0.1, 0.2, 0.05), (0.5, 0.5, 0.5), (0.4, 0.1, 0.1)


def box(size_m, at_m, rgb):
    """A box of a colour."""
    made = trimesh.creation.box(size_m).apply_translation(at_m)
    material = trimesh.visual.material.PBRMaterial(
        baseColorFactor=[*rgb, 1.0], metallicFactor=0.0, roughnessFactor=1.0
    )
    made.visual = trimesh.visual.TextureVisuals(material=material)
    return made


def border_of(folder, *meshes):
    trimesh.Scene(list(meshes)).export(folder / "scene.glb")
    return border_albedo(load_scene(folder / "scene.glb"))


def test_a_lawn_around_a_terrace_goes_on(tmp_path):
    """The border's own colour with its coat, not that of the middle or of a roof."""
    lawn = box((40.0, 0.1, 40.0), (0.0, -0.05, 0.0), LAWN)
    terrace = box((20.0, 0.1, 20.0), (0.0, 0.02, 0.0), STONE)
    house = box((8.0, 6.0, 8.0), (0.0, 3.0, 0.0), ROOF)
    found = border_of(tmp_path, lawn, terrace, house)
    # Pressed colours have 8 bits in the file.
    np.testing.assert_allclose(found, COAT + (1.0 - COAT) * np.array(LAWN), atol=0.012)


def test_a_room_has_no_border(tmp_path):
    """A floor under a roof is no ground, nor is the roof."""
    floor = box((6.0, 0.1, 6.0), (0.0, 0.0, 0.0), STONE)
    roof = box((6.0, 0.1, 6.0), (0.0, 3.0, 0.0), ROOF)
    assert border_of(tmp_path, floor, roof) is None


def test_houses_at_the_edge_leave_the_road_between_them(tmp_path):
    """Where most of the edge is roofs, what little ground is there does not stand for all."""
    road = box((40.0, 0.1, 40.0), (0.0, -0.05, 0.0), STONE)
    houses = [box((4.0, 9.0, 40.0), (x, 4.5, 0.0), ROOF) for x in (-18.0, 18.0)]
    found = border_of(tmp_path, road, *houses)
    assert found == pytest.approx((COAT + (1.0 - COAT) * 0.5,) * 3, abs=0.012)
    more = [box((40.0, 9.0, 4.0), (0.0, 4.5, z), ROOF) for z in (-18.0, 18.0)]
    assert border_of(tmp_path, road, *houses, *more) is None
