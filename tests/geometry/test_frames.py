"""Frames of reference: east, north, up and the world's axes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.geometry.frames import (
    angles_from_direction,
    direction_from_angles,
    enu_from_world,
    world_from_enu,
)

ANGLE = st.floats(-np.pi, np.pi)


def test_the_worlds_axes():
    """glTF's frame as the design fixes it: east +X, up +Y, north -Z."""
    np.testing.assert_array_equal(world_from_enu(np.eye(3)), [[1, 0, 0], [0, 0, -1], [0, 1, 0]])


@pytest.mark.parametrize(
    ("azimuth_deg", "enu"), [(0, (0, 1, 0)), (90, (1, 0, 0)), (180, (0, -1, 0)), (270, (-1, 0, 0))]
)
def test_azimuth_runs_clockwise_from_north(azimuth_deg, enu):
    """North, east, south, west: the surveyors' sense."""
    np.testing.assert_allclose(direction_from_angles(np.radians(azimuth_deg), 0.0), enu, atol=1e-15)


def test_a_north_offset_turns_north_to_the_left_of_the_picture():
    """With the scene's -Z 30 degrees clockwise of north, north lies at the world's azimuth -30."""
    north = world_from_enu([0.0, 1.0, 0.0], np.radians(30.0))
    np.testing.assert_allclose(north, [-0.5, 0.0, -np.sqrt(0.75)], atol=1e-15)


@given(ANGLE, st.floats(-1.57, 1.57), ANGLE)
def test_there_and_back(azimuth_rad, elevation_rad, offset_rad):
    """Angles to a direction, to world axes and back are the same, whatever the offset."""
    world = world_from_enu(direction_from_angles(azimuth_rad, elevation_rad), offset_rad)
    assert np.linalg.norm(world) == pytest.approx(1.0, abs=1e-14)
    azimuth, elevation = angles_from_direction(enu_from_world(world, offset_rad))
    assert elevation == pytest.approx(elevation_rad, abs=1e-13)
    turn = (azimuth - azimuth_rad + np.pi) % (2 * np.pi) - np.pi
    assert turn * np.cos(elevation_rad) == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("west", [1e-16, 1e-20, 1e-300, 5e-324])
def test_azimuth_just_west_of_north_is_zero(west):
    """Azimuth stays below 360 degrees, where rounding would give a full turn."""
    azimuth, _ = angles_from_direction([-west, 1.0, 0.0])
    assert azimuth == 0.0
