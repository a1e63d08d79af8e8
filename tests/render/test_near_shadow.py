"""Shadows of small things in a large scene: a second, finer map around the eye."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from scene_stage import light, look, look_finished, square
from stateful_backend import opened

from vrut_lite.render.passes.light_axes import light_matrix
from vrut_lite.render.passes.shadow_map import NEAR_RADIUS_M, near_centre_m

SUN = np.array([0.6, 0.7, 0.2]) / np.linalg.norm([0.6, 0.7, 0.2])
HALF_M = 2e4
metres = st.floats(-2e4, 2e4)


@pytest.fixture
def backend(gl_backend):
    return gl_backend(size_px=(96, 64))


def show_land(backend, folder, *boxes):
    """A white plain of 40 km with boxes on it, each (middle, extents); only the sun shines."""
    land = trimesh.creation.box((2 * HALF_M, 1.0, 2 * HALF_M)).apply_translation((0, -0.5, 0))
    things = [trimesh.creation.box(size).apply_translation(at) for at, size in boxes]
    path = folder / "land.glb"
    trimesh.Scene([land, *things]).export(path)
    backend.change(scene=opened(path))
    black = np.zeros((6, 8, 8, 3))
    light(backend, black, sun_direction=SUN, sun_irradiance=(10.0,) * 3)


@given(st.tuples(metres, metres, metres), st.tuples(metres, metres, metres))
def test_the_near_map_holds_what_is_around_the_eye(eye, centre):
    """The eye is within a 64th of the half width of its middle, right and up as the sun sees."""
    middle = near_centre_m(eye, SUN, np.array(centre), 1e5)
    at = light_matrix(SUN, NEAR_RADIUS_M, 1e5)[:2, :3] @ (np.array(eye) - middle)
    assert np.abs(at).max() <= 0.5 / 64 * (1 + 1e-6)


def test_scenes_of_a_street_and_eyes_far_away_have_one_map():
    """Below four of its radii the scene's own map is fine enough; from space none is."""
    assert near_centre_m((0, 2, 0), SUN, np.zeros(3), 4.0 * NEAR_RADIUS_M) is None
    assert near_centre_m((0, 2, 0), SUN, np.zeros(3), 4.1 * NEAR_RADIUS_M) is not None
    assert near_centre_m((0, 4e5, 0), SUN, np.zeros(3), 3e4) is None


@pytest.mark.gl
def test_a_hut_on_a_plain_of_40_km_casts_a_shadow(backend, tmp_path):
    """Its map's texels are 14 m wide: black ground behind a box of 4 m, lit ground before it."""
    show_land(backend, tmp_path, ((0.0, 2.0, 0.0), (4.0, 4.0, 4.0)))
    away = -SUN / SUN[1]
    shown = []
    for side in (3.0, -3.0, -60.0):
        at = np.array([side * away[0], 0.0, side * away[2]])
        shown.append(look(backend, at + np.array([0.0, 30.0, 0.1]), at, 0.01).radiance[..., 1])
    np.testing.assert_array_equal(shown[0], 0.0)
    np.testing.assert_allclose(shown[1], shown[2], rtol=1e-2)
    assert backend.counters.done["near shadow map"] >= 1


@pytest.mark.gl
@pytest.mark.parametrize("height_m", [1.7, 300.0, 5000.0])
@pytest.mark.parametrize("shot", [look, look_finished])
def test_no_line_where_a_map_ends(backend, tmp_path, shot, height_m):
    """A lit plain, from the near map through its rim to the other, or over a still's squares: no
    pixel differs by more than 0.2 % from the next, nor by more than its sheen, 4 %, from any.
    """
    show_land(backend, tmp_path)
    eye = np.array([3.0, height_m, 5.0])
    picture = shot(backend, eye, eye + np.array([1.0, -0.9, 0.3]), 0.7).radiance[..., 1]
    assert np.ptp(picture) < 0.04 * picture.min()
    for axis in (0, 1):
        assert np.abs(np.diff(picture, axis=axis)).max() < 2e-3 * picture.min()


@pytest.mark.gl
def test_a_mountain_casts_from_outside_the_near_map(backend, tmp_path):
    """A tower 2 km high, 1.5 km towards the sun, shades the eye's place: it is beyond the map."""
    towards = 1500.0 * np.array([SUN[0], 0.0, SUN[2]]) / np.hypot(SUN[0], SUN[2])
    show_land(backend, tmp_path, ((towards[0], 1000.0, towards[2]), (600.0, 2000.0, 600.0)))
    for shot in (look, look_finished):
        picture = shot(backend, (0.0, 50.0, 0.1), (0.0, 0.0, 0.0), 0.5).radiance
        np.testing.assert_array_equal(picture, 0.0)


@pytest.mark.gl
def test_the_near_map_is_kept_while_the_eye_stays(backend, tmp_path):
    """Turning redraws nothing; a walk of 1 m seldom does, one of 100 m does."""
    show_land(backend, tmp_path)
    look(backend, (0, 2, 0), (1, 2, 0))
    look(backend, (0, 2, 0), (0, 2, 1))
    assert backend.counters.done["near shadow map"] == 1
    assert backend.counters.skipped["near shadow map: same scene, same sun"] == 1
    look(backend, (100, 2, 0), (200, 2, 0))
    assert backend.counters.done["near shadow map"] == 2
    assert backend.counters.done["shadow map"] == 1


@pytest.mark.gl
def test_no_vertex_colour_is_taken_from_beyond_its_triangle(backend, tmp_path):
    """A sliver at the pixel grid, white at its tip and black at its base: no pixel is negative.

    At a pixel's centre outside the triangle the colour's plane would be below 0 or above 1.
    """
    corners = np.array([[-0.5, 0, 0.5], [0.5, 0, 0.5], [0.5, 0, 0.48], [-0.5, 0, 0.48]])
    colours = np.array([[0, 0, 0, 1], [0, 0, 0, 1], [1, 1, 1, 1], [1, 1, 1, 1]], float)
    pbr = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}}
    path = square(tmp_path, pbr, attributes={"COLOR_0": colours}, corners=corners)
    backend.change(scene=opened(path))
    light(backend, np.zeros((6, 8, 8, 3)), sun_direction=(0, 1, 1e-3), sun_irradiance=(10.0,) * 3)
    for azimuth in np.linspace(0.1, 3.0, 8):
        eye = (2.0 * np.sin(azimuth), 1.0, 2.0 * np.cos(azimuth))
        picture = look(backend, eye, (0.0, 0.0, 0.49)).radiance
        assert picture.max() > 0.1
        assert picture.min() >= 0.0
