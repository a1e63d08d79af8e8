"""The light meter and the picture's own luminance, against light worked out on paper."""

import numpy as np
import pytest
import trimesh
from light_messages import light_messages
from scene_stage import light, look
from stateful_backend import opened

from vrut_lite.messages.camera import MoveCamera, look_at, pixel_rays
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.render.light_meter import illuminance
from vrut_lite.render.rays import SceneRays

LUX_PER_WATT = 683.0
GROUND = GroundDisc((0.0, 0.0), 0.0, 200.0)
UP = (0.0, 1.0, 0.0)
# 30 degrees high in the east.
SUN = (np.sqrt(0.75), 0.5, 0.0)


@pytest.fixture(scope="module")
def box(tmp_path_factory):
    """A cube of 2 m with its base at height 0."""
    path = tmp_path_factory.mktemp("scene") / "box.glb"
    trimesh.creation.box((2, 2, 2)).apply_translation((0, 1, 0)).export(path)
    return opened(path, GROUND)


@pytest.fixture(scope="module")
def rays(box):
    return SceneRays(box)


def sky_and_sun(radiance, irradiance=100.0):
    cube = np.full((6, 16, 16, 3), radiance)
    _, sun, ambient = light_messages(cube, sun_direction=SUN, sun_irradiance=(irradiance,) * 3)
    return sun, ambient


def test_a_uniform_sky_gives_pi_times_its_luminance(rays):
    """E = pi L on any plane under a uniform sphere: to 0.1 %."""
    for normal in (UP, (1, 0, 0), (-0.5, -1.0, 2.0)):
        measured = illuminance(rays, *sky_and_sun(3.0, 0.0), (30.0, 0.0, 0.0), normal)
        assert measured.lux == pytest.approx(np.pi * 3.0 * LUX_PER_WATT, rel=1e-3)


def test_the_sun_counts_by_the_cosine_and_not_in_the_shade(rays):
    """30 degrees high: half of 100 W on level ground, nothing 2 m west of a box 2 m high."""
    lit = illuminance(rays, *sky_and_sun(0.0), (30.0, 0.0, 0.0), UP)
    assert lit.sun_lux == pytest.approx(0.5 * 100.0 * LUX_PER_WATT, rel=1e-6)
    assert lit.sky_lux == 0.0
    for west_m, sun in ((-2.0, False), (-4.4, False), (-4.5, True)):
        measured = illuminance(rays, *sky_and_sun(0.0), (west_m, 0.0, 0.0), UP)
        assert (measured.sun_lux > 0.0) is sun
    assert illuminance(rays, *sky_and_sun(0.0), (-1.0, 1.0, 0.0), (-1, 0, 0)).sun_lux == 0.0


def test_a_surface_does_not_shade_itself(rays):
    """All over the top of the box, from its own face: lit."""
    for x in np.linspace(-0.99, 0.99, 7):
        assert illuminance(rays, *sky_and_sun(0.0), (x, 2.0, 0.3), UP).sun_lux > 0.0


def test_a_pixel_is_what_a_ray_through_it_meets(rays):
    """The box's top, its side, the ground and the sky, from a camera south of it."""
    camera = MoveCamera(eye_m=(0.0, 3.0, 10.0), target_m=(0.0, 2.0, 0.0))

    def surface_at(x, y):
        return rays.first_hit(camera.eye_m, pixel_rays(camera, (81, 81), x, y))

    top = surface_at(40, 40)
    np.testing.assert_allclose(top.normal, UP, atol=1e-12)
    assert top.point_m[1] == pytest.approx(2.0)
    side = surface_at(40, 48)
    np.testing.assert_allclose(side.normal, (0, 0, 1), atol=1e-12)
    assert side.point_m[2] == pytest.approx(1.0)
    ground = surface_at(2, 60)
    # Four metres off its middle the ground has fallen by a micrometre.
    across_m = np.hypot(*ground.point_m[[0, 2]])
    assert ground.material == "ground"
    assert ground.point_m[1] == pytest.approx(-(across_m**2) / (2 * 6.36e6), abs=1e-12)
    assert surface_at(40, 5) is None


def test_the_middle_pixel_looks_at_the_target():
    """And the right edge of a wide picture lies at half the horizontal angle."""
    camera = MoveCamera(
        eye_m=(1.0, 2.0, 3.0), target_m=(4.0, 1.0, -2.0), vertical_field_of_view_rad=0.6
    )
    view = look_at(camera.eye_m, camera.target_m)[:3, :3]
    middle = view @ pixel_rays(camera, (31, 21), 15, 10)
    np.testing.assert_allclose(middle, [0, 0, -1], atol=1e-12)
    right = view @ pixel_rays(camera, (3000, 2000), 2999, 1000)
    assert right[0] / -right[2] == pytest.approx(1.5 * np.tan(0.3), rel=1e-3)


@pytest.mark.gl
@pytest.mark.parametrize("elevation_deg", [4.0, 25.0, 70.0])
def test_a_white_plane_has_the_luminance_that_follows(gl_backend, box, elevation_deg):
    """L = E / pi for a white Lambertian plane: the picture's pixel against the meter, to 2 %.

    Both ways: from the messages through the meter, and from the numbers put in.
    """
    backend = gl_backend(size_px=(64, 48), scene=box, ground_albedo_rgb=(1.0,) * 3)
    elevation = np.radians(elevation_deg)
    irradiance = np.array([110.0, 90.0, 60.0])
    light(
        backend,
        np.full((6, 16, 16, 3), [2.0, 3.0, 5.0]),
        sun_direction=(np.cos(elevation), np.sin(elevation), 0.0),
        sun_irradiance=irradiance,
    )
    picture = look(backend, (30.0, 5.0, 0.0), (40.0, 0.0, 0.0))
    hit = backend.backend.surface_at_pixel(backend.state, 32, 24)
    lux = backend.backend.illuminance(backend.state, hit.point_m, hit.normal).lux
    shown = picture.luminance_cd_m2(32, 24)
    assert shown == pytest.approx(lux / np.pi, rel=0.005)
    radiance = np.array([2.0, 3.0, 5.0]) + irradiance * np.sin(elevation) / np.pi
    weights = np.array([0.2126, 0.7152, 0.0722])
    assert shown == pytest.approx(radiance @ weights * LUX_PER_WATT, rel=0.005)
    with pytest.raises(ValueError, match="none at"):
        picture.luminance_cd_m2(64, 0)
