"""Matrices and tests by which a frame leaves out what it does not show."""

import numpy as np
import pytest

from vrut_lite.render.frustum import reaches
from vrut_lite.render.passes.view import normal_matrix

RANDOM = np.random.default_rng(20)


def test_normals_go_with_the_inverse_transpose() -> None:
    """Cofactors are |det| times the inverse transpose: normals stay upright, also in a mirror."""
    for _ in range(20):
        matrix = np.eye(4)
        matrix[:3, :3] = RANDOM.normal(size=(3, 3))
        m = matrix[:3, :3]
        wanted = abs(np.linalg.det(m)) * np.linalg.inv(m).T
        np.testing.assert_allclose(normal_matrix(matrix), wanted, rtol=1e-9, atol=1e-12)


def test_the_normal_of_a_flattened_mesh_is_that_of_its_plane() -> None:
    """Where one axis is flattened to nothing there is no inverse, but still a normal."""
    normal = normal_matrix(np.diag([2.0, 0.0, 3.0, 1.0])) @ [0.3, 1.0, -0.2]
    np.testing.assert_allclose(normal, [0.0, 6.0, 0.0])


@pytest.mark.parametrize(("centre_x_m", "seen"), [(0.0, True), (11.9, True), (12.1, False)])
def test_a_caster_beside_the_box_of_a_map_is_left_out(centre_x_m: float, seen: bool) -> None:
    """A sphere of 2 m reaches into a box of half 10 m up to 12 m from its middle."""
    clip = np.diag([0.1, 0.1, -0.1, 1.0])
    # However far towards the sun, it casts into the box.
    assert reaches(clip, np.array([centre_x_m, 0.0, 500.0]), 2.0) is seen
