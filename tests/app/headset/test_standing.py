"""Where a headset's room stands in the scene: rigid motions, by analytic cases and at random."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from vrut_lite.app.headset.aim import Aim
from vrut_lite.app.headset.controllers import SNAP_TURN_RAD, SnapTurn
from vrut_lite.app.headset.loop import level_camera, middle_of
from vrut_lite.app.headset.marker import ring
from vrut_lite.app.headset.openxr import LocatedEye, tangents_of
from vrut_lite.app.headset.standing import (
    RoomPose,
    Standing,
    azimuth_rad,
    floor_below,
    rotation_of,
    standing_at,
    teleport_target,
)
from vrut_lite.frame_part import Hit
from vrut_lite.messages.camera import MoveCamera

METRES = st.floats(-50.0, 50.0)
PLACES = st.tuples(METRES, METRES, METRES).map(np.array)
ANGLES = st.floats(-math.pi, math.pi)
QUATERNIONS = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)
POSES = st.builds(lambda at, turn: RoomPose(at, rotation_of(turn)), PLACES, QUATERNIONS)
UPRIGHT = RoomPose(np.array([0.3, 1.6, -0.2]), np.eye(3))


def level(angle_rad):
    """A rotation to the right (clockwise from above) by an angle."""
    return Rotation.from_euler("y", -angle_rad).as_matrix()


@given(QUATERNIONS)
def test_a_quaternion_turns_as_scipy_has_it(quaternion):
    expected = Rotation.from_quat(quaternion).as_matrix()
    np.testing.assert_allclose(rotation_of(quaternion), expected, atol=1e-12)


@pytest.mark.parametrize(
    ("forward", "degrees"),
    [((0, 0, -1), 0), ((1, 0, 0), 90), ((0, 0.5, 1), 180), ((-2, -1, 0), -90)],
)
def test_azimuths_go_clockwise_from_north(forward, degrees):
    """From -z over +x, as the camera's rig has them, whatever the elevation."""
    assert math.degrees(azimuth_rad(forward)) == pytest.approx(degrees)


@given(PLACES, ANGLES, POSES.filter(lambda head: np.hypot(*head.forward[[0, 2]]) > 0.05))
def test_one_enters_above_the_floor_and_looks_as_the_camera_did(floor_m, towards_rad, head):
    """Wherever in the room the headset lies: the head is above the point, as high as in the room,
    and looks along the azimuth, with its own elevation."""
    seen = standing_at(floor_m, towards_rad, head).in_world(head)
    above = np.array([0.0, head.position_m[1], 0.0])
    np.testing.assert_allclose(seen.position_m, floor_m + above, atol=1e-9)
    off_rad = math.remainder(azimuth_rad(seen.forward) - towards_rad, math.tau)
    assert off_rad == pytest.approx(0.0, abs=1e-9)
    assert seen.forward[1] == pytest.approx(head.forward[1], abs=1e-12)


@given(PLACES, ANGLES, POSES, ANGLES)
def test_a_snap_turn_turns_about_the_head(origin_m, azimuth, head, angle_rad):
    """The eyes stay where they are, or the world would swing around one."""
    before = Standing(origin_m, azimuth)
    after = before.turned(angle_rad, head)
    here, there = before.in_world(head), after.in_world(head)
    np.testing.assert_allclose(there.position_m, here.position_m, atol=1e-9)
    np.testing.assert_allclose(there.rotation, level(angle_rad) @ here.rotation, atol=1e-9)


@given(PLACES, ANGLES, POSES, PLACES)
def test_a_teleport_shifts_the_head_above_its_target(origin_m, azimuth, head, target_m):
    """Without a turn, and with the floor of the room at the target's height."""
    before = Standing(origin_m, azimuth)
    after = before.with_head_at(target_m, head)
    there = after.in_world(head)
    np.testing.assert_allclose(there.position_m[[0, 2]], target_m[[0, 2]], atol=1e-9)
    assert after.origin_m[1] == target_m[1]
    np.testing.assert_array_equal(there.rotation, before.in_world(head).rotation)


# --- targets in a scene --------------------------------------------------------------------


def plane_at(height_m, normal=(0.0, 1.0, 0.0)):
    """Rays that meet one infinite plane through (0, height, 0), by its equation."""
    normal = np.asarray(normal, float) / np.linalg.norm(normal)
    through = np.array([0.0, height_m, 0.0])

    def first_hit(eye_m, direction):
        along = float(normal @ direction)
        reach_m = float(normal @ (through - eye_m)) / along if along else -1.0
        if reach_m <= 0.0:
            return None
        facing = normal if along < 0.0 else -normal
        return Hit(np.asarray(eye_m) + reach_m * np.asarray(direction), facing, "stone", 0, 0)

    return first_hit


def pointing(x, y, z, at=(0.0, 1.5, 0.0)):
    """A hand whose -z points in a direction."""
    forward = np.array([x, y, z], float) / np.linalg.norm([x, y, z])
    turn, _ = Rotation.align_vectors([forward], [[0.0, 0.0, -1.0]])
    return RoomPose(np.array(at, float), turn.as_matrix())


def test_the_floor_is_straight_below():
    np.testing.assert_allclose(floor_below((3.0, 4.0, 5.0), plane_at(1.0)), (3.0, 1.0, 5.0))
    assert floor_below((3.0, 0.5, 5.0), plane_at(1.0)) is None


def test_a_hand_points_at_the_floor():
    """From 1.5 m, down by a right triangle of 3, 4, 5: two metres ahead."""
    target_m = teleport_target(pointing(0.0, -3.0, -4.0), plane_at(0.0))
    np.testing.assert_allclose(target_m, (0.0, 0.0, -2.0), atol=1e-9)


@pytest.mark.parametrize(
    ("hand", "first_hit"),
    [
        (pointing(0, 1, -1), plane_at(0.0)),
        (pointing(0, -1, -100), plane_at(0.0)),
        (pointing(0, -1, -0.5), plane_at(0.0, normal=(0.0, 1.0, 1.2))),
        (pointing(0, 1, -1), plane_at(3.0)),
    ],
    ids=["the sky", "farther than 50 m", "a slope of 50 degrees", "a ceiling"],
)
def test_nobody_can_stand_there(hand, first_hit):
    assert teleport_target(hand, first_hit) is None


@pytest.mark.parametrize(("height_m", "fits"), [(1.7, False), (1.9, True)])
def test_a_body_needs_room(height_m, fits):
    """A table 1.7 m above the floor hides a place to stand, one 1.9 m above does not."""
    floor, table = plane_at(0.0), plane_at(height_m)

    def first_hit(eye_m, direction):
        return (floor if direction[1] < 0.0 else table)(eye_m, direction)

    found = teleport_target(pointing(0.0, -1.0, -1.0, at=(0.0, 1.0, 0.0)), first_hit)
    assert (found is not None) == fits


def test_one_goes_where_the_hand_points_at_last():
    """Another thread casts the rays; the release clears the target."""
    aim, floor = Aim(), plane_at(0.0)
    assert aim.release() is None
    aim.point(pointing(0.0, -3.0, -4.0), lambda: floor)
    np.testing.assert_allclose(aim.release(), (0.0, 0.0, -2.0), atol=1e-9)
    assert aim.target_m is None
    assert aim.release() is None
    aim.close()


@given(PLACES, ANGLES, PLACES)
def test_a_point_of_the_world_has_its_place_in_the_room(origin_m, azimuth, point_m):
    """And back, as the ring of a teleport is located there and seen here."""
    room = Standing(origin_m, azimuth)
    back = room.in_world(RoomPose(room.in_room(point_m), np.eye(3)))
    np.testing.assert_allclose(back.position_m, point_m, atol=1e-9)


def test_the_ring_is_round_and_hollow():
    """Its area is that between its circles, within a texel of its edges; corners are clear."""
    picture = ring(128)
    radii = 0.95**2 - 0.75**2
    assert picture[..., 3].mean() / 255.0 == pytest.approx(math.pi / 4.0 * radii, rel=0.01)
    assert picture[0, 0].max() == picture[64, 64].max() == 0
    np.testing.assert_array_equal(picture, picture[::-1].swapaxes(0, 1))


def test_an_eyes_angles_are_those_of_its_edges():
    """By name: OpenXR has the upper angle before the lower one, projections after it."""
    fov = SimpleNamespace(
        angle_left=-math.atan(1.2), angle_right=math.atan(0.9),
        angle_up=math.atan(0.8), angle_down=-math.atan(1.1),
    )  # fmt: skip
    assert tangents_of(fov) == pytest.approx((-1.2, 0.9, -1.1, 0.8))


# --- head and thumbstick -------------------------------------------------------------------


def test_the_window_looks_level_from_between_the_eyes():
    """Ahead as the head does, at the angle that the window had."""
    nod = Rotation.from_euler("x", -0.6).as_matrix()
    eyes = [
        LocatedEye(RoomPose(np.array([x, 1.6, 0.0]), nod), (-1, 1, -1, 1), None) for x in (-1, 3)
    ]
    like = MoveCamera(eye_m=(0, 0, 0), target_m=(0, 0, 1), vertical_field_of_view_rad=0.7)
    camera = level_camera(middle_of(eyes), like)
    assert camera.eye_m == pytest.approx((1.0, 1.6, 0.0))
    assert np.subtract(camera.target_m, camera.eye_m) == pytest.approx((0.0, 0.0, -1.0))
    assert camera.vertical_field_of_view_rad == 0.7


def test_a_thumbstick_turns_once_a_push():
    """Held aside, and trembling, it turns no further; back in the middle it may turn again."""
    stick, turn = SnapTurn(), SNAP_TURN_RAD
    pushes = [0.0, 0.5, 0.9, 1.0, 0.6, 0.8, 0.1, -0.9, -0.2, 1.0]
    turns = [stick.turn_rad(push) for push in pushes]
    assert turns == [0, 0, turn, 0, 0, 0, 0, -turn, 0, turn]
