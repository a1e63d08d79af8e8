"""The frame against scenes whose pixels can be worked out on paper."""

import msgspec
import numpy as np
import pytest
import trimesh
from light_messages import light_messages

from vrut_lite.geometry.cube_map import FACE_NORMALS, texel_directions
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.kernel.messages import MoveCamera, SetExposure
from vrut_lite.scene.ground_disc import GroundDisc
from vrut_lite.scene.loading import load_scene

pytestmark = pytest.mark.gl
SIZE = 32


@pytest.fixture
def backend(gl_owner):
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    backend = PyrenderBackend(gl_owner)
    backend.set_size(160, 120)
    yield backend
    backend.close()


@pytest.fixture(scope="module")
def box_file(tmp_path_factory):
    """A cube of 2 m with its base at height 0."""
    path = tmp_path_factory.mktemp("scene") / "box.glb"
    trimesh.creation.box((2, 2, 2)).apply_translation((0, 1, 0)).export(path)
    return path


def uniform_sky(radiance):
    return np.full((6, SIZE, SIZE, 3), radiance, float)


def light(backend, cube, **sun):
    background, sun_light, ambient = light_messages(cube, **sun)
    backend.set_background(background)
    backend.set_sun_light(sun_light)
    backend.set_ambient(ambient)


def show_box(backend, path, albedo=0.5):
    backend.show_scene(load_scene(path), GroundDisc((0.0, 0.0), 0.0, 200.0))
    backend.set_ground_albedo(np.full(3, albedo))


def look(backend, eye, target, field_of_view_rad=0.6):
    backend.set_camera(
        MoveCamera(eye_m=eye, target_m=target, vertical_field_of_view_rad=field_of_view_rad)
    )
    return backend.draw()


def sun_at(azimuth_deg, elevation_deg):
    angles = np.radians([azimuth_deg, elevation_deg])
    return tuple(world_from_enu(direction_from_angles(*angles)))


def test_a_matte_plane_under_a_uniform_sky_has_albedo_times_its_radiance(backend, box_file):
    """E = pi L under a uniform sky, so a Lambertian plane of albedo a shows a L, within 0.5 %."""
    show_box(backend, box_file, albedo=0.4)
    light(backend, uniform_sky(3.0))
    picture = look(backend, (30.0, 5.0, 0.0), (40.0, 0.0, 0.0))
    np.testing.assert_allclose(picture.radiance[80:], 0.4 * 3.0, rtol=5e-3)


@pytest.mark.parametrize("elevation_deg", [2.0, 15.0, 50.0, 89.0])
def test_a_sunlit_plane_shows_the_sun_irradiance(backend, box_file, elevation_deg):
    """L = a / pi E sin(elevation) for the sun alone, within 0.5 %, for any channel."""
    show_box(backend, box_file, albedo=0.3)
    irradiance = np.array([100.0, 80.0, 50.0])
    direction = sun_at(90.0, elevation_deg)
    light(backend, uniform_sky(0.0), sun_direction=direction, sun_irradiance=irradiance)
    picture = look(backend, (30.0, 5.0, 0.0), (40.0, 0.0, 0.0))
    expected = 0.3 / np.pi * irradiance * np.sin(np.radians(elevation_deg))
    np.testing.assert_allclose(
        picture.radiance[80:], np.broadcast_to(expected, (40, 160, 3)), rtol=5e-3
    )


@pytest.mark.parametrize(
    ("azimuth_deg", "side"), [(0, (0, 3)), (90, (-3, 0)), (180, (0, -3)), (270, (3, 0))]
)
def test_the_shadow_falls_away_from_the_sun(backend, box_file, azimuth_deg, side):
    """A box of 2 m under a sun 30 degrees high shades the ground 3.46 m behind it."""
    show_box(backend, box_file)
    light(
        backend,
        uniform_sky(0.0),
        sun_direction=sun_at(azimuth_deg, 30.0),
        sun_irradiance=(10.0,) * 3,
    )
    x, z = side
    shaded = look(backend, (x, 12.0, z), (x, 0.0, z), 0.02)
    lit = look(backend, (-x, 12.0, -z), (-x, 0.0, -z), 0.02)
    assert shaded.radiance.max() == 0.0
    np.testing.assert_allclose(lit.radiance, 0.5 / np.pi * 10.0 * 0.5, rtol=5e-3)


@pytest.mark.parametrize("elevation_deg", [1.0, 4.0, 20.0, 70.0])
@pytest.mark.parametrize("scale", [0.01, 1.0, 3000.0])
def test_no_acne_on_a_lit_face_at_any_scale(backend, tmp_path, elevation_deg, scale):
    """A face that the sun sees is lit evenly: every pixel of the box's top within 0.5 %."""
    path = tmp_path / "box.glb"
    trimesh.creation.box((2 * scale,) * 3).apply_translation((0, scale, 0)).export(path)
    backend.show_scene(load_scene(path), None)
    light(
        backend,
        uniform_sky(0.0),
        sun_direction=sun_at(35.0, elevation_deg),
        sun_irradiance=(10.0,) * 3,
    )
    picture = look(backend, (0.0, 8.0 * scale, 0.0), (0.0, 2.0 * scale, 0.0), 0.2)
    top = picture.radiance[..., 1]
    assert top.min() > 0.0
    np.testing.assert_allclose(top, np.median(top), rtol=0.02)


@pytest.mark.parametrize("elevation_deg", [8.0, 36.0, 63.0])
def test_no_acne_between_narrow_triangles(backend, tmp_path, elevation_deg):
    """A disc of 360 sectors is lit evenly: at their edges a pixel is in part of each, to 2 %."""
    path = tmp_path / "disc.glb"
    disc = trimesh.creation.cylinder(radius=20.0, height=0.2, sections=360)
    disc.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    disc.export(path)
    backend.show_scene(load_scene(path), None)
    sun = {"sun_direction": sun_at(110.0, elevation_deg), "sun_irradiance": (10.0,) * 3}
    light(backend, uniform_sky(0.0), **sun)
    # From so far that the disc's middle looks the same from all of its pixels.
    picture = look(backend, (0.0, 12.0, 60.0), (0.0, 0.1, 0.0), 0.06)
    np.testing.assert_allclose(picture.radiance, np.median(picture.radiance), rtol=0.02)


@pytest.mark.parametrize("face", range(6))
def test_each_face_of_the_cube_is_seen_where_it_belongs(backend, box_file, face):
    """Looking along +X shows the face +X and so on: a turned or mirrored sky would not."""
    cube = np.zeros((6, SIZE, SIZE, 3))
    cube[:] = (np.arange(6) + 1.0)[:, None, None, None]
    show_box(backend, box_file)
    light(backend, cube)
    eye = np.array([0.0, 500.0, 0.0])
    # Downwards the ground disc would be in the way, so look from below it.
    if face == 3:
        eye[1] = -1.0
    picture = look(backend, tuple(eye), tuple(eye + FACE_NORMALS[face]), 0.3)
    np.testing.assert_allclose(picture.radiance, face + 1.0, rtol=1e-3)


def test_the_sky_is_not_mirrored(backend, box_file):
    """A pixel shows the sky of its own direction: right of north is east, up is the zenith."""
    cube = 2.0 + texel_directions(256)
    show_box(backend, box_file)
    light(backend, cube)
    picture = look(backend, (0.0, 50.0, 0.0), (0.0, 70.0, -20.0), 1.0)
    rows, columns = picture.radiance.shape[:2]
    middle = picture.radiance[rows // 2, columns // 2]
    np.testing.assert_allclose(middle, [2.0, 2.0 + 0.7071, 2.0 - 0.7071], atol=0.01)
    assert np.all(np.diff(picture.radiance[rows // 2, ::8, 0]) > 0)
    assert np.all(np.diff(picture.radiance[::8, columns // 2, 1]) < 0)


def test_the_horizon_is_one_sharp_line(backend, box_file):
    """Sky and ground meet within a pixel: cube-map filtering must not make a grey band."""
    directions = texel_directions(256)
    cube = np.where(directions[..., 1:2] > 0.0, 4.0, 1.0) * np.ones(3)
    show_box(backend, box_file)
    light(backend, cube)
    # From far above the disc's rim the cube's own ground is seen out to the horizon.
    picture = look(backend, (0.0, 5000.0, 0.0), (0.0, 5000.0, -1.0), 0.1)
    column = picture.radiance[:, 80, 0]
    between = (column > 1.01) & (column < 3.99)
    assert between.sum() <= 1
    assert column[0] == pytest.approx(4.0)
    assert column[-1] == pytest.approx(1.0)


def test_the_disc_carries_the_suns_irradiance(backend, box_file):
    """Radiance times solid angle over the disc's pixels gives back the irradiance, within 1 %."""
    show_box(backend, box_file)
    direction = sun_at(140.0, 35.0)
    light(backend, uniform_sky(0.0), sun_direction=direction, sun_irradiance=(120.0, 100.0, 70.0))
    eye = np.array([0.0, 10.0, 0.0])
    picture = look(backend, tuple(eye), tuple(eye + direction), 0.02)
    pixel_sr = (2 * np.tan(0.01) / picture.radiance.shape[0]) ** 2
    np.testing.assert_allclose(
        picture.radiance.sum(axis=(0, 1)) * pixel_sr, [120.0, 100.0, 70.0], rtol=0.01
    )


def test_the_disc_darkens_towards_its_limb(backend, box_file):
    """Radiance E / solid angle times 0.4 + 0.9 cos psi (mean 1): 1.3 amid, 0.94 at 0.8 radii."""
    show_box(backend, box_file)
    direction = sun_at(140.0, 35.0)
    light(backend, uniform_sky(0.0), sun_direction=direction, sun_irradiance=(100.0,) * 3)
    _, sun, _ = light_messages(uniform_sky(0.0), direction, (100.0,) * 3)
    backend.set_sun_light(msgspec.structs.replace(sun, limb_darkening_rgb=((0.4, 0.9),) * 3))
    picture = look(backend, (0, 10, 0), np.add((0, 10, 0), direction), 0.02)
    mean = 100.0 / (4 * np.pi * np.sin(0.5 * 0.00465) ** 2)
    pixels_a_radius = 60 * np.tan(0.00465) / np.tan(0.01)
    row = picture.radiance[60, :, 0] / mean
    away = np.abs(np.arange(160) + 0.5 - 80) / pixels_a_radius
    cosine = np.sqrt(1.0 - np.minimum(away, 1.0) ** 2)
    inside = away < 0.9
    np.testing.assert_allclose(row[inside], (0.4 + 0.9 * cosine)[inside], rtol=0.02)
    assert row[away > 1.1].max() == 0.0


def test_a_pixel_on_an_edge_is_the_mean_of_what_it_shows(backend, box_file):
    """Four samples, averaged in linear radiance: quarters of the way from a black disc to 4."""
    show_box(backend, box_file, albedo=0.0)
    light(backend, uniform_sky(4.0))
    picture = look(backend, (200.0, 20.0, 0.0), (200.0, 0.0, 0.0))
    assert set(np.unique(picture.radiance)) == {0.0, 1.0, 2.0, 3.0, 4.0}


def test_a_sun_below_the_horizon_draws_no_disc(backend, box_file):
    """What lies under the horizon is ground, also where the sun is behind it."""
    show_box(backend, box_file)
    light(backend, uniform_sky(0.0), sun_direction=sun_at(140.0, -0.5), sun_irradiance=(1.0,) * 3)
    eye = np.array([0.0, 5000.0, 0.0])
    picture = look(backend, tuple(eye), tuple(eye + sun_at(140.0, -0.5)), 0.01)
    assert picture.radiance.max() == 0.0


@pytest.mark.parametrize("curve", ["agx", "exponential", "none"])
@pytest.mark.parametrize("white", [(6504.0, 0.0), (3200.0, 0.01)])
def test_the_tone_map_on_the_gpu_is_its_numpy_twin(backend, box_file, curve, white):
    """The shader and render/display.py write one curve and one dither: within one 8-bit step."""
    from vrut_lite.render.display import display_picture
    from vrut_lite.render.white_balance import white_balance_matrix

    kelvin, duv = white
    backend.set_exposure(SetExposure(tone_map=curve, white_temperature_k=kelvin, white_duv=duv))
    show_box(backend, box_file)
    light(backend, 0.02 + 3.0 * (1.0 + texel_directions(64)) ** 4)
    picture = look(backend, (0.0, 50.0, 0.0), (0.0, 70.0, -20.0), 1.4)
    # GL counts rows from below, and so does its dither.
    matrix = white_balance_matrix(*white)
    twin = display_picture(picture.radiance[::-1], picture.ev100, curve, matrix)[::-1]
    assert np.abs(twin.astype(int) - picture.display.astype(int)).max() <= 1
    assert np.ptp(picture.display) > 100


def test_manual_exposure_is_kept_and_one_stop_is_a_factor_of_two(backend, box_file):
    """EV100 is what was asked for; compensation brightens, by lowering it."""
    show_box(backend, box_file)
    light(backend, uniform_sky(3.0))
    backend.set_exposure(SetExposure(mode="manual", ev100=12.0))
    assert look(backend, (30.0, 5.0, 0.0), (40.0, 0.0, 0.0)).ev100 == 12.0
    backend.set_exposure(SetExposure(mode="auto"))
    metered = backend.draw().ev100
    backend.set_exposure(SetExposure(mode="auto", compensation_ev=1.5))
    assert backend.draw().ev100 == pytest.approx(metered - 1.5)


def test_drawing_before_anything_is_known_says_what_is_missing(backend):
    """A host that draws too early must learn what it forgot."""
    with pytest.raises(RuntimeError, match="no scene, no background, no sun"):
        backend.draw()
