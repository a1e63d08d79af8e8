"""Lamps as the path tracer has them: the irradiance that their own values give."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest
import trimesh
from lamp_maker import lamps_of, spot_table
from light_messages import light_messages
from long_parameters import mostly_long
from path_tracer.settings import PathTracerSettings
from path_tracer.subject import Subject
from path_tracer.tracer import Tracer
from path_tracer_here import mitsuba_or_skip
from stateful_backend import opened

from vrut_lite.messages.camera import MoveCamera, pixel_rays
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.scene.scene_state import SceneState

mitsuba_or_skip()
ALBEDO = 0.3
SIZE = (24, 16)
DOWN = (0.0, -1.0, 0.0)


def dark_ground(tmp_path, lamps):
    """A matte plain under a black sky, seen from 6 m above; one small box stands far away."""
    path = tmp_path / "box.glb"
    trimesh.creation.box((0.1,) * 3).apply_translation((8.0, 0.05, 0.0)).export(path)
    background, key_light, ambient = light_messages(
        np.zeros((6, 8, 8, 3)), sun_irradiance=(0.0,) * 3
    )
    scene = msgspec.structs.replace(opened(path, GroundDisc((0.0, 0.0), 0.0, 100.0)), lamps=lamps)
    return Subject(
        SceneState(
            scene=scene,
            background=background,
            key_light=key_light,
            ambient=ambient,
            ground_albedo_rgb=(ALBEDO,) * 3,
            moved_camera=MoveCamera(
                eye_m=(0.0, 6.0, 0.1), target_m=(0.0, 0.0, 0.0), vertical_field_of_view_rad=0.6
            ),
            size_px=SIZE,
        ).under_clear_sky()
    )


LAMPS = {
    "point": {"position_m": (0.5, 2.0, 0.0), "intensity_rgb": (3.0, 2.0, 1.0)},
    "spot": {"position_m": (-1.0, 3.0, 0.3), "cone_rad": (0.3, 0.5), "axis": (0.2, -0.9, 0.1)},
    "luminaire": {
        "position_m": (0.0, 2.5, 0.6),
        "table": spot_table(),
        "axis": DOWN,
        "across": (0, 0, 1),
    },
}


@pytest.mark.parametrize("name", mostly_long(LAMPS, "luminaire".__eq__))
def test_ground_under_a_lamp_has_the_radiance_of_its_irradiance(tmp_path, name):
    """The luminaire is no body of rotation. Means of 8 x 8 pixels agree to 5 %, noise included."""
    lamps = lamps_of(LAMPS[name])
    subject = dark_ground(tmp_path, lamps)
    found = Tracer(subject, PathTracerSettings(max_bounces=1)).trace(0, 64)
    camera = subject.state.camera
    expected = np.zeros_like(found)
    for y in range(SIZE[1]):
        for x in range(SIZE[0]):
            ray = pixel_rays(camera, SIZE, x, y)
            point = np.asarray(camera.eye_m) - ray * (camera.eye_m[1] / ray[1])
            expected[y, x] = lamps.irradiance_at(0, point, (0.0, 1.0, 0.0)) * ALBEDO / np.pi
    blocks = [p.reshape(2, 8, 3, 8, 3).mean(axis=(1, 3)) for p in (found, expected)]
    np.testing.assert_allclose(*blocks, rtol=0.05, atol=0.01 * expected.max())


def test_a_lamp_moves_with_the_scenes_size(tmp_path):
    """Candela stay candela however many units of the tracer a metre has."""
    found = []
    for reach_m in (8.0, 80.0):
        lamps = lamps_of({"position_m": (0.0, 2.0, 0.0), "intensity_rgb": (1.0, 1.0, 1.0)})
        subject = dark_ground(tmp_path, lamps)
        scene = msgspec.structs.replace(subject.scene, upper_m=(reach_m, 1.0, 1.0))
        subject = Subject(replace(subject.state, scene=scene))
        settings = PathTracerSettings(variant="scalar", max_bounces=1)
        found.append(Tracer(subject, settings).trace(0, 4).mean())
    assert found[0] == pytest.approx(found[1], rel=1e-2)
