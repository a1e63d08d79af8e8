"""Large coordinates: precision holds 400 km up."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from light_messages import light_messages
from scene_files import glb_bytes
from stateful_backend import StatefulBackend, opened

from vrut_lite.messages.camera import MoveCamera, camera_from_pose, look_at
from vrut_lite.messages.picture import SetExposure
from vrut_lite.project import load_project
from vrut_lite.render.passes.view import translation
from vrut_lite.scene.loading import load_scene

SCENES = Path(__file__).resolve().parents[2] / "scenes"
ALTITUDE_M = 400e3
EYE_M, TARGET_M = np.array([-2.9, 2.1, 6.8]), np.array([0.35, -0.7, 0.0])


@pytest.fixture
def backend(gl_owner):
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(gl_owner)
    yield StatefulBackend(backend, size_px=(160, 120))
    backend.close()


def test_the_satellite_is_of_real_size_and_where_satellites_are():
    """A body of 1.2 m between panels 8.6 m from tip to tip, 400 km up, in its project's view."""
    scene = load_scene(SCENES / "large" / "satellite.glb")
    size_m = scene.upper_m - scene.lower_m
    assert 7.0 < size_m[0] < 9.0
    assert np.all(size_m[1:] < 5.0)
    assert abs(scene.lower_m[1] - ALTITUDE_M) < 3.0
    camera = load_project(SCENES / "large" / "planet.toml").camera
    assert camera is not None
    assert np.linalg.norm(np.array(camera.eye_m) - scene.lower_m) < 15.0


def satellite_at(altitude_m):
    """Bytes of the bundled satellite with its nodes at another height."""
    data = (SCENES / "large" / "satellite.glb").read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + size])
    for node in document["nodes"]:
        if "mesh" in node:
            node["translation"][1] = altitude_m
    return glb_bytes(document, data[28 + size :])


@pytest.mark.gl
def test_a_thing_400_km_up_looks_as_it_does_on_the_ground(backend, tmp_path):
    """With the same light and view no pixel differs by more than the rounding to 32 bits.

    A float32 coordinate of 4e5 m has steps of 3 cm, ten pixels here; an eye in between, too.
    """
    cube = np.full((6, 16, 16, 3), 2.0)
    background, sun, ambient = light_messages(cube, (0.3, 0.8, 0.5), (500.0, 480.0, 440.0))
    backend.change(exposure=SetExposure(mode="manual", ev100=13.0))
    pictures = []
    for altitude_m in (0.0, ALTITUDE_M):
        path = tmp_path / f"{altitude_m:.0f}.glb"
        path.write_bytes(satellite_at(altitude_m))
        backend.change(scene=opened(path), background=background, key_light=sun, ambient=ambient)
        up = np.array([0.0, altitude_m, 0.0])
        backend.change(
            moved_camera=MoveCamera(
                eye_m=tuple(map(float, EYE_M + up)),
                target_m=tuple(map(float, TARGET_M + up)),
                vertical_field_of_view_rad=0.9,
            )
        )
        pictures.append(backend.draw().radiance)
    assert np.ptp(pictures[0]) > 50.0
    off = np.abs(pictures[1] - pictures[0]).max(axis=2)
    assert np.mean(off > 1e-3 * pictures[0].max()) < 1e-3
    np.testing.assert_allclose(pictures[1].mean(), pictures[0].mean(), rtol=1e-5)


@pytest.mark.parametrize("height_m", [1.7, 1e3, 4e5, 3e6, 9e6])
def test_the_camera_is_exact_from_ground_to_space(height_m):
    """Positions relative to the eye are exact to a micrometre at any height (float64: 2e-9 m)."""
    eye = np.array([12.3, height_m, -45.6])
    point = eye + np.array([0.25, -0.5, -2.0])
    model = np.eye(4)
    model[:3, 3] = point
    placed = (translation(-eye) @ model).astype(np.float32)
    np.testing.assert_allclose(placed[:3, 3], [0.25, -0.5, -2.0], atol=1e-6)
    turned = look_at(eye, eye + np.array([0.0, -0.3, -1.0]))[:3, :3]
    expected = look_at(np.zeros(3), [0.0, -0.3, -1.0])[:3, :3]
    np.testing.assert_allclose(turned, expected, atol=1e-8)


@pytest.mark.parametrize("height_m", [1.7, 4e5, 3e6])
def test_a_scenes_own_camera_keeps_its_direction_from_ground_to_space(height_m):
    """A pose becomes an eye and a target one metre ahead, without loss of angle."""
    pose = np.eye(4)
    pose[:3, :3] = look_at(np.zeros(3), [0.4, -0.3, -1.0])[:3, :3].T
    pose[:3, 3] = [0.0, height_m, 0.0]
    camera = camera_from_pose(pose, 0.8)
    ahead = np.subtract(camera.target_m, camera.eye_m)
    np.testing.assert_allclose(ahead, -pose[:3, 2], atol=1e-8)
