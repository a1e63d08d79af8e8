"""Penumbras of the sun's disc, against the disc's own integral: width, light, leaks and acne."""

import numpy as np
import pytest
import trimesh
from half_shadow import DISC_WIDTH, half_shadow
from scene_stage import light, look, look_finished, square
from scipy.integrate import quad
from stateful_backend import StatefulBackend, opened
from sun_stage import BLACK, IRRADIANCE, RADIUS_RAD, SUN, box, show

from vrut_lite.messages.camera import pixel_rays
from vrut_lite.messages.sun import KeyLightChanged

SIZE = (48, 40)
# An edge that climbs over level ground, and the sheet that it ends.
LOW, HIGH = np.array([0.0, 1.8, -8.0]), np.array([0.0, 10.2, 8.0])


@pytest.fixture(scope="module")
def backend(gl_owner):
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    made = PyrenderBackend(gl_owner)
    yield StatefulBackend(made, size_px=SIZE)
    made.close()


def ground(half_m=8.0):
    return box((-half_m, -1.0, -half_m), (half_m, 0.0, half_m))


def sheet(*corners):
    return trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], process=False)


def seen_points(backend):
    """Where each pixel (h, w, 3) sees the ground."""
    camera = backend.state.camera
    y, x = np.indices(SIZE[::-1])
    rays = pixel_rays(camera, SIZE, x, y)
    return np.array(camera.eye_m) + rays * (-camera.eye_m[1] / rays[..., 1:2])


def share_of_disc(t):
    """Of an even disc, on one side of a line that is t of its radius from its middle."""
    t = np.clip(t, -1.0, 1.0)
    return 0.5 + (np.arcsin(t) + t * np.sqrt(1.0 - t * t)) / np.pi


@pytest.fixture
def climb(backend, tmp_path):
    """The sheet above the ground, whatever the test before has shown."""
    corners = LOW, HIGH, np.add(HIGH, (-6.0, 0.0, 0.0)), np.add(LOW, (-6.0, 0.0, 0.0))
    show(backend, tmp_path, ground(), sheet(*corners))
    return backend


@pytest.mark.gl
@pytest.mark.parametrize("height_m", [2.4, 3.5, 5.0, 6.5, 8.0])
def test_a_penumbra_is_as_wide_as_the_sun_makes_it(climb, height_m):
    """Below an edge that climbs: width from 10 to 90 % to 6 %, light to 1 %, and no step in it.

    A texel is 6 mm wide, half a penumbra 13 mm where the edge is lowest: its true width, from a
    sheet 2.4 m above the ground to one of 8 m. The light is the mean over three half widths.
    """
    on_edge = LOW + (HIGH - LOW) * (height_m - LOW[1]) / (HIGH[1] - LOW[1])
    foot = on_edge - SUN * (height_m / SUN[1])
    half_width_m = RADIUS_RAD * height_m / SUN[1]
    picture = look(climb, np.add(foot, (0.3, 0.6, 0.2)), foot, 8.0 * half_width_m).radiance[..., 1]
    across = np.cross(HIGH - LOW, on_edge - seen_points(climb))
    t = across @ SUN / (np.linalg.norm(across, axis=-1) * RADIUS_RAD)
    share, width = half_shadow(picture, t, 0.05)
    assert width == pytest.approx(DISC_WIDTH, rel=0.06)
    assert share.mean() == pytest.approx(0.5, abs=0.01)
    # The disc's own steepest slope is 2 / pi.
    assert -1e-3 <= np.diff(share).min() <= np.diff(share).max() <= 1.3 * 0.1 * 2.0 / np.pi


@pytest.mark.gl
@pytest.mark.parametrize("elevation_deg", [4.0, 20.0, 70.0])
@pytest.mark.parametrize("shot", [look, look_finished])
def test_what_no_shadow_falls_on_shades_itself_nowhere(backend, tmp_path, shot, elevation_deg):
    """Ground, and the side of a pyramid, beside a tower that only nearly hides the sun.

    Its depth makes all of them look for wide penumbras; each is evenly lit to 0.4 %.
    """
    elevation = np.radians(elevation_deg)
    sun = np.array([np.cos(elevation), np.sin(elevation), 0.0])
    tower = box((0.0, 0.0, 0.5), (0.4, 6.0, 0.9))
    side = sheet((-2.0, 0.0, 0.0), (-2.0, 0.0, -2.0), (-3.0, 1.0, -1.5), (-3.0, 1.0, -0.5))
    show(backend, tmp_path, ground(), tower, side, sun=sun)
    for at in ((-1.0, 0.0, -0.2), (-2.5, 0.5, -1.0)):
        picture = shot(backend, np.add(at, (0.1, 2.0, 0.1)), at, 0.2).radiance[..., 1]
        assert picture.min() > 0.0
        assert np.ptp(picture) < 4e-3 * picture.mean()


@pytest.mark.gl
@pytest.mark.parametrize("far_caster", [False, True])
@pytest.mark.parametrize("shot", [look, look_finished])
def test_no_light_falls_through_where_a_roof_meets_a_wall(backend, tmp_path, shot, far_caster):
    """The corner under a roof is black, also where the wide penumbra of a beam far above falls.

    But for its contact, there on the wall, by as much as the wall rises over that penumbra.
    """
    wall = box((-1.0, 0.0, -2.0), (-0.8, 2.0, 2.0))
    roof = box((-1.0, 2.0, -2.0), (1.5, 2.05, 2.0))
    above = [box((-6.0, 7.0, -0.1), (6.0, 7.2, 0.1))] if far_caster else []
    show(backend, tmp_path, ground(), wall, roof, *above, sun=(0.3, 0.9, 0.05))
    for at in ((-0.8, 1.85, 0.0), (-0.8, 1.0, 0.0), (-0.8, 0.01, 0.0)):
        picture = shot(backend, np.add(at, (0.5, 0.0, 0.4)), at, 0.2).radiance
        np.testing.assert_array_equal(picture, 0.0)


@pytest.mark.long
@pytest.mark.gl
def test_leaves_cast_soft_shadows_of_their_cut_out_shape(backend, tmp_path):
    """Half a square, 6 m up: below the edge of its hole light changes over the sun's width."""
    alpha = np.full((64, 64, 4), 255, np.uint8)
    alpha[:, 32:, 3] = 0
    material = {
        "alphaMode": "MASK", "doubleSided": True,
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.0},
    }  # fmt: skip
    below = {"mesh": 0, "translation": [3, 0, 0], "scale": [8, 1, 8]}
    nodes = [{"mesh": 0, "translation": [0, 6, 0]}, below]
    backend.change(scene=opened(square(tmp_path, material, [alpha], nodes=nodes)))
    light(backend, BLACK, sun_direction=(0.0, 1.0, 1e-3), sun_irradiance=(IRRADIANCE,) * 3)
    picture = look(backend, (0.0, 1.0, 0.01), (0.0, 0.0, 0.0), 0.1).radiance[..., 1]
    share = picture.mean(0) / picture.max()
    share = share if share[0] < share[-1] else share[::-1]
    x = (np.arange(SIZE[0]) - 0.5 * (SIZE[0] - 1)) * 2.0 * np.tan(0.05) / SIZE[1]
    true_m = 2.0 * 0.687 * 6.0 * RADIUS_RAD
    assert np.ptp(np.interp([0.1, 0.9], share, x)) == pytest.approx(true_m, rel=0.15)


def test_a_darker_limb_narrows_penumbras():
    """The even disc in a sun's place has the mean square of its profile, by quadrature."""
    terms = (0.4, 0.9, -0.3)

    def mean(weight):
        def of_ring(x):
            psi = np.sqrt(1.0 - x * x)
            return 2.0 * x * weight(x) * sum(a * psi**n for n, a in enumerate(terms))

        return quad(of_ring, 0.0, 1.0)[0]

    sun = KeyLightChanged(
        direction=(0.0, 1.0, 0.0), irradiance_rgb=(1.0,) * 3, angular_radius_rad=RADIUS_RAD,
        limb_darkening_rgb=(terms,) * 3, source="test",
    )  # fmt: skip
    even = np.sqrt(2.0 * mean(np.square) / mean(np.ones_like))
    assert even < 1.0
    assert sun.even_radius_rad == pytest.approx(RADIUS_RAD * even)


@pytest.mark.gl
@pytest.mark.parametrize("shot", [look, look_finished])
def test_nothing_is_left_of_the_shadows_of_another_sun(backend, gl_owner, tmp_path, shot):
    """A long, low wall covers other texels by each sun: the last picture is that of a new map."""
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    suns = [(0.1, 0.3, -0.9), (0.9, 0.2, 0.1), (0.0, 1.0, 1e-3)]
    meshes = [ground(), box((-0.1, 0.0, -7.0), (0.1, 0.8, 7.0))]
    view = (4.0, 6.0, 3.0), (0.0, 0.0, 0.0), 1.2
    for sun in suns:
        show(backend, tmp_path, *meshes, sun=sun)
        moved = shot(backend, *view).radiance
    fresh = PyrenderBackend(gl_owner)
    alone = StatefulBackend(fresh, size_px=SIZE)
    show(alone, tmp_path, *meshes, sun=suns[-1])
    np.testing.assert_array_equal(moved, shot(alone, *view).radiance)
    fresh.close()
