"""The ground beyond a shadow map is lit without look-ups, where none of it lies in the map."""

import numpy as np
import pytest
from box_stage import show_box, sun_at
from hypothesis import given
from hypothesis import strategies as st
from scene_stage import light, look
from stateful_backend import opened

from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.render.light import Shadow
from vrut_lite.render.passes import shadows_on_mesh
from vrut_lite.render.passes.light_axes import light_matrix
from vrut_lite.render.pyrender_scene import PyrenderScene

BLACK = np.zeros((6, 8, 8, 3))


@pytest.fixture(scope="module")
def outer(box_file):
    """The outer part of a disc of 200 m, which begins at 7.4 m."""
    return PyrenderScene(opened(box_file, GroundDisc((1.0, -2.0), 0.0, 200.0))).placed[-1]


@given(
    st.floats(0.0, 360.0),
    st.floats(1.0, 90.0),
    st.floats(0.5, 8.0),
    st.tuples(*3 * [st.floats(-2.0, 2.0)]),
)
def test_no_ground_of_the_map_is_beyond_its_hole(
    outer, azimuth_deg, altitude_deg, radius_m, away_m
):
    """Whichever way the sun stands: of places at the hole's rim none is in the map."""
    matrix = light_matrix(sun_at(azimuth_deg, altitude_deg), radius_m, 2.0 * radius_m)
    shadow = Shadow(None, matrix, 0.01, np.add(outer.centre_m, away_m))
    angle = np.linspace(0.0, 2.0 * np.pi, 720)
    rim = np.stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)], axis=-1)
    at = (outer.centre_m + outer.hole_m * rim - shadow.centre_m) @ matrix[:2, :3].T
    in_map = (np.abs(at) <= 1.0).all(axis=1)
    if shadows_on_mesh.lies_in_hole(shadow, outer):
        assert not in_map.any()
    else:
        # A hole of a fifth less would have places in the map, in a corner at least.
        assert (np.abs(0.8 * (at - at.mean(axis=0)) + at.mean(axis=0)) <= 1.0).all(axis=1).any()


@pytest.mark.gl
@pytest.mark.parametrize(("altitude_deg", "has_shadow"), [(60.0, False), (8.0, True)])
def test_the_far_ground_is_the_same_without_look_ups(gl_backend, box_file, monkeypatch,
                                                     altitude_deg, has_shadow):  # fmt: skip
    """Under a high sun nothing falls on it; under a low one the shadow of a box does."""
    backend = gl_backend(size_px=(64, 48))
    show_box(backend, box_file)
    sun = sun_at(90.0, altitude_deg)
    light(backend, BLACK, sun_direction=sun, sun_irradiance=(10.0,) * 3)
    away = -np.array([sun[0], 0.0, sun[2]]) / np.hypot(sun[0], sun[2])
    view = (12.0 * away + np.array([0.0, 5.0, 0.0]), 12.0 * away + np.array([0.01, 0.0, 0.0]), 0.9)
    found = look(backend, *view).radiance
    assert (found.max(axis=-1).min() < 0.1 * found.max()) == has_shadow
    monkeypatch.setattr(shadows_on_mesh, "lies_in_hole", lambda *_: False)
    np.testing.assert_allclose(look(backend, *view).radiance, found, rtol=1e-6)
