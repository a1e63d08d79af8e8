"""Turning around stays above ground and out of walls, and looks around among them."""

import math

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from window_driver import SCENES, move_pointer

from vrut_lite.app.view.camera_rig import CameraRig
from vrut_lite.app.view.surroundings import OccupiedCells
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.project import load_project
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed


@pytest.fixture(scope="module")
def pavilion():
    return packed(load_scene(SCENES / "pavilion.gltf"))


@pytest.fixture(scope="module")
def around(pavilion):
    return OccupiedCells(pavilion)


def test_surfaces_fill_their_cells(pavilion, around):
    """Every corner of every triangle is found, and air high above the ground is free."""
    corners = np.concatenate(
        [pavilion.geometry.world_triangles(part).reshape(-1, 3)
         for part in range(len(pavilion.geometry.part_mesh.values))]
    )  # fmt: skip
    assert around.is_filled(corners).mean() > 0.99
    upper = np.array(pavilion.upper_m)
    assert not around.is_filled((upper + 0.1)[None])[0]


def test_who_stands_before_a_building_turns_around_it_and_who_stands_in_it_looks(pavilion, around):
    """The roof above decides, and what closes the horizon nearer than the target."""
    middle = 0.5 * (np.array(pavilion.lower_m) + pavilion.upper_m)
    outside = np.array(pavilion.camera.eye_m)
    assert not around.encloses(outside, middle)
    # Below the roof.
    assert around.encloses(np.array([0.0, 1.7, 0.0]), np.array([5.0, 1.7, 5.0]))


def test_turning_stays_above_the_ground():
    """However far one drags down: the eye comes down to the ground and no farther."""
    rig = CameraRig()
    rig.eye_m, rig.elevation_rad, rig.distance_m = np.array([0.0, 4.0, 10.0]), -0.3, 10.0
    target = rig.target_m
    for _ in range(40):
        rig.orbit(0.0, -0.05, lowest_m=0.2)
    assert rig.eye_m[1] == pytest.approx(0.2)
    assert np.allclose(rig.target_m, target)
    # One that was below already may go up again.
    rig.orbit(0.0, 0.1, lowest_m=5.0)
    assert rig.eye_m[1] > 0.2


def test_a_drag_in_the_first_scene_stays_in_the_street(shared_headless_window, qtbot):
    """250 pixels: the view turns by a quarter of its width or so, and the eye stays where it is."""
    driver = shared_headless_window
    view = driver.window.desk.viewport
    driver.window.actions_by_name["orbit"].trigger()
    driver.window.files.open_project(load_project(SCENES / "street.toml"))
    driver.until_heard(SceneOpened, lambda m: m.path.endswith("street.obj"))
    driver.until(lambda: np.allclose(view.rig.eye_m, (-1.2, 1.7, 16.0)))
    driver.until(lambda: view._hand.surroundings is not None)
    azimuth_rad = view.rig.azimuth_rad
    middle = view.rect().center()
    qtbot.mousePress(view, Qt.MouseButton.LeftButton, pos=middle)
    spot = middle + QPoint(250, 0)
    move_pointer(view, spot, Qt.MouseButton.LeftButton)
    qtbot.mouseRelease(view, Qt.MouseButton.LeftButton, pos=spot)
    assert np.allclose(view.rig.eye_m, (-1.2, 1.7, 16.0))
    assert 0.05 < abs(math.remainder(view.rig.azimuth_rad - azimuth_rad, math.tau)) < 1.0
