"""Projections of eyes whose view is not symmetric."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vrut_lite.messages.camera import off_axis_perspective, perspective

TANGENTS = st.tuples(
    st.floats(-3.0, -0.1), st.floats(0.1, 3.0), st.floats(-3.0, -0.1), st.floats(0.1, 3.0)
)


def projected(matrix, point):
    clip = matrix @ np.append(point, 1.0)
    return clip[:3] / clip[3]


@given(TANGENTS, st.floats(0.1, 1e4))
def test_edges_of_the_view_are_edges_of_the_picture(tangents, distance_m):
    """A point whose slope is an edge's tangent is projected onto that edge, at any distance."""
    left, right, lower, upper = tangents
    matrix = off_axis_perspective(tangents, near_m=0.02)
    low = projected(matrix, np.array([left, lower, -1.0]) * distance_m)
    high = projected(matrix, np.array([right, upper, -1.0]) * distance_m)
    np.testing.assert_allclose(low, [-1.0, -1.0, 0.02 / distance_m], atol=1e-12)
    np.testing.assert_allclose(high, [1.0, 1.0, 0.02 / distance_m], atol=1e-12)


@pytest.mark.parametrize("aspect", [0.9, 1.0, 1.78])
def test_a_symmetric_one_is_the_cameras(aspect):
    """As `perspective` has it, for a headset with equal halves."""
    high = np.tan(0.4)
    tangents = (-aspect * high, aspect * high, -high, high)
    np.testing.assert_allclose(
        off_axis_perspective(tangents, 0.02), perspective(0.8, aspect, 0.02), atol=1e-15
    )
