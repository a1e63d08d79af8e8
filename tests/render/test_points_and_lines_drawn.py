"""Points and lines show their colours, one pixel wide, and shade nothing."""

import msgspec
import numpy as np
import pytest
from scene_stage import light, look, square, surface
from stateful_backend import opened
from term_stage import ALBEDO, GROUND

from vrut_lite.array import Array
from vrut_lite.messages.points_and_lines import PointsAndLines

pytestmark = pytest.mark.gl
RED = np.array([1, 0, 0, 1], np.float32)


@pytest.fixture
def backend(shared_gl_backend):
    return shared_gl_backend(size_px=(32, 32))


def strokes(points, lines):
    points, lines = np.reshape(points, (-1, 3)), np.reshape(lines, (-1, 2, 3))
    return PointsAndLines(
        points_m=Array(points.astype(float)),
        point_rgba=Array(np.tile(RED, (len(points), 1))),
        lines_m=Array(lines.astype(float)),
        line_rgba=Array(np.tile(RED, (len(lines), 2, 1))),
    )


def seen(backend, folder, drawn):
    """Radiance (32, 32, 3) of white ground of a square from above, with these strokes."""
    scene = opened(square(folder, surface(0.0, 1.0)), GROUND)
    scene = msgspec.structs.replace(scene, points_and_lines=drawn)
    backend.change(scene=scene, ground_albedo_rgb=(ALBEDO,) * 3)
    sun = {"sun_direction": (0.0, 1.0, 1e-6), "sun_irradiance": (np.pi,) * 3}
    light(backend, np.zeros((6, 8, 8, 3)), **sun)
    return look(backend, (0.0, 3.0, 1e-6), (0.0, 0.0, 0.0), 0.3).radiance


def test_a_line_is_seen_in_its_colour_and_casts_no_shadow(backend, tmp_path):
    """Red along its column, as bright as open ground; beside it nothing changes."""
    bare = seen(backend, tmp_path, None)
    # A quarter of a pixel beside the boundary of two columns.
    x = 0.2 / 32
    shown = seen(backend, tmp_path, strokes([], [[x, 0.5, 0.4], [x, 0.5, -0.4]]))
    column = shown[16, 14:19]
    red = column[:, 0] - column[:, 1]
    assert red.sum() == pytest.approx(1.0, abs=0.05)
    assert np.sum(red > 0.05) <= 2
    np.testing.assert_allclose(shown[:, :13], bare[:, :13], rtol=1e-6)
    np.testing.assert_allclose(shown[:, 20:], bare[:, 20:], rtol=1e-6)


def test_points_are_seen_and_hidden_like_all_else(backend, tmp_path):
    """One above the square is seen, one below it is not."""
    bare = seen(backend, tmp_path, None)
    above = seen(backend, tmp_path, strokes([[0.01, 0.5, 0.01]], []))
    below = seen(backend, tmp_path, strokes([[0.01, -0.5, 0.01]], []))
    assert np.abs(above - bare).max() > 0.5
    np.testing.assert_allclose(below, bare, rtol=1e-6)
