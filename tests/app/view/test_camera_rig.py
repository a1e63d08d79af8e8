"""Cameras in the hand: what a movement must keep, it keeps to rounding."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.app.view.camera_rig import CameraRig, dip_rad
from vrut_lite.app.view.view_projection import project_directions
from vrut_lite.messages.camera import MoveCamera, pixel_rays

CAMERA = MoveCamera(
    eye_m=(3.0, 2.0, 8.0), target_m=(0.0, 1.0, -1.0), vertical_field_of_view_rad=0.9
)
ways = st.floats(-2.0, 2.0)


def rig_at(camera=CAMERA):
    rig = CameraRig()
    rig.adopt(camera)
    return rig


def test_a_camera_that_is_adopted_is_the_one_that_is_sent():
    """Taking over the scene's own camera must not move the picture."""
    sent = rig_at().camera()
    assert np.allclose(sent.eye_m, CAMERA.eye_m, atol=1e-12)
    assert np.allclose(sent.target_m, CAMERA.target_m, atol=1e-12)
    assert sent.vertical_field_of_view_rad == CAMERA.vertical_field_of_view_rad


@given(right=ways, up=ways)
def test_turning_around_the_scene_keeps_target_and_distance(right, up):
    """Orbiting is a rotation about the target; near the zenith it stops instead of rolling."""
    rig = rig_at()
    target = rig.target_m
    rig.orbit(right, up)
    assert np.allclose(rig.target_m, target, atol=1e-9)
    assert math.isclose(np.linalg.norm(rig.eye_m - target), rig.distance_m)
    assert abs(rig.elevation_rad) < math.pi / 2


@given(right=ways, up=ways)
def test_looking_around_keeps_the_eye(right, up):
    """The head turns, the feet stay."""
    rig = rig_at()
    rig.look_around(right, up)
    assert rig.eye_m == pytest.approx(CAMERA.eye_m)


def test_what_is_dragged_stays_under_the_pointer():
    """Shifting by a tenth of the view moves the target's place in the picture by a tenth."""
    rig = rig_at()
    target = rig.target_m
    rig.pan(0.1, 0.05)
    direction = target - rig.eye_m
    (place,) = project_directions([direction / np.linalg.norm(direction)], rig.camera(), 1.5)
    # Shares of the picture's height, so 1.5 times less of its width.
    assert place == pytest.approx([0.5 + 0.1 / 1.5, 0.5 - 0.05], abs=2e-3)


def test_nearer_and_away_again_comes_back():
    """A step of the wheel to and fro changes nothing."""
    rig = rig_at()
    rig.dolly(3.0)
    assert rig.distance_m < 9.0
    rig.dolly(-3.0)
    assert rig.eye_m == pytest.approx(CAMERA.eye_m)


@given(steps=st.floats(-300.0, 300.0))
def test_climbing_keeps_the_horizon_in_its_place(steps):
    """From the ground to space the planet's edge stays where it was in the picture."""
    rig = CameraRig()
    rig.elevation_rad = 0.1
    above_rad = rig.elevation_rad + dip_rad(rig.eye_m[1])
    rig.climb(steps)
    assert 1.0 < rig.eye_m[1] <= 4e7
    assert rig.elevation_rad + dip_rad(rig.eye_m[1]) == pytest.approx(above_rad, abs=1e-9)


def test_a_hundred_steps_lead_from_the_ground_to_space():
    """A wheel has some 20 steps a turn: space must be a few turns away, 100 km and more."""
    rig = CameraRig()
    rig.climb(100.0)
    assert rig.eye_m[1] > 1e5


@given(x=st.integers(0, 299), y=st.integers(0, 199))
def test_directions_are_projected_where_the_light_meter_sees_them(x, y):
    """`pixel_rays` is the frame's own: its inverse must lead back to the pixel."""
    direction = pixel_rays(CAMERA, (300, 200), x, y)
    (place,) = project_directions([direction], CAMERA, 1.5)
    assert place == pytest.approx([(x + 0.5) / 300, (y + 0.5) / 200], abs=1e-9)


def test_what_lies_behind_is_nowhere():
    """The sun at one's back must not be drawn in front."""
    behind = np.subtract(CAMERA.eye_m, CAMERA.target_m)
    assert np.isnan(project_directions([behind], CAMERA, 1.5)).all()
