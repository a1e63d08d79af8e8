"""One test for all scene backends: each shows the same scene under the same light alike.

OpenGL's frame, and the path tracer with direct light alone.
"""

import msgspec
import numpy as np
import pytest
from box_stage import SIZE, show_box, sun_at, uniform_sky
from light_messages import light_messages
from long_parameters import mostly_long
from path_tracer.backend import PathTracedBackend
from path_tracer.settings import PathTracerSettings
from path_tracer_here import mitsuba_or_skip
from scene_stage import CORNERS, light, look, square
from stateful_backend import StatefulBackend, opened

from vrut_lite.geometry.cube_map import FACE_NORMALS, texel_directions
from vrut_lite.messages.camera import look_at, perspective
from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures.display import display_picture

WIDTH, HEIGHT = 160, 120
DRAWING = [pytest.param("opengl", marks=pytest.mark.gl), "path tracer"]


@pytest.fixture(params=DRAWING)
def any_backend(request):
    """A backend that draws; pictures of 160 x 120 pixels."""
    yield from made(request.param, request)


def made(kind, request):
    if kind == "opengl":
        from vrut_lite.render.pyrender_backend import PyrenderBackend

        backend = PyrenderBackend(request.getfixturevalue("gl_owner"))
    else:
        mitsuba_or_skip()
        backend = PathTracedBackend(PathTracerSettings(spp=8, max_bounces=1))
    yield StatefulBackend(backend, size_px=(WIDTH, HEIGHT))
    if kind == "opengl":
        backend.close()


def is_gl(backend):
    return not isinstance(backend.backend, PathTracedBackend)


def even(backend, region, expected, rtol):
    """Every pixel of a region (h, w, 3) is as expected; of a picture with noise, their mean."""
    values = region if is_gl(backend) else region.mean(axis=(0, 1))
    np.testing.assert_allclose(values, np.broadcast_to(expected, values.shape), rtol=rtol)


def test_a_matte_plane_under_a_uniform_sky_has_albedo_times_its_radiance(any_backend, box_file):
    """E = pi L under a uniform sky, so a Lambertian plane of albedo a shows a L, within 0.5 %."""
    show_box(any_backend, box_file, albedo=0.4)
    light(any_backend, uniform_sky(3.0))
    picture = look(any_backend, (30.0, 5.0, 0.0), (40.0, 0.0, 0.0))
    even(any_backend, picture.radiance[80:], 0.4 * 3.0, rtol=5e-3)


def test_by_night_the_eye_sees_less_detail_in_every_picture(any_backend, box_file):
    """Under 3e-5 cd/m2 the eye parts 0.7 cycles a degree: an edge is soft, by a pixel's angle."""
    show_box(any_backend, box_file, albedo=0.1)
    light(any_backend, uniform_sky(5e-8))
    eye = SetExposure(mode="manual", ev100=-15.0)
    any_backend.change(exposure=eye)
    picture = look(any_backend, (30.0, 5.0, 0.0), (40.0, 5.0, 0.0), field_of_view_rad=0.3)
    angle = 2.0 * np.tan(0.15) / HEIGHT
    assert picture.pixel_rad == pytest.approx(angle)
    sharp = display_picture(picture.radiance, -15.0, eye)

    def steepest(display):
        rows = display.astype(float).mean(axis=(1, 2))
        return np.abs(np.diff(rows)).max() / np.ptp(rows)

    assert steepest(sharp) > 0.5
    assert steepest(picture.display) < 0.4


@pytest.mark.parametrize(
    "elevation_deg", mostly_long([2.0, 15.0, 50.0, 89.0], (2.0, 50.0).__contains__)
)
def test_a_sunlit_plane_shows_the_sun_irradiance(any_backend, box_file, elevation_deg):
    """L = a / pi E sin(elevation) for the sun alone, within 0.5 %, for any channel."""
    show_box(any_backend, box_file, albedo=0.3)
    irradiance = np.array([100.0, 80.0, 50.0])
    direction = sun_at(90.0, elevation_deg)
    light(any_backend, uniform_sky(0.0), sun_direction=direction, sun_irradiance=irradiance)
    picture = look(any_backend, (30.0, 5.0, 0.0), (40.0, 0.0, 0.0))
    expected = 0.3 / np.pi * irradiance * np.sin(np.radians(elevation_deg))
    even(any_backend, picture.radiance[80:], expected, rtol=5e-3)


@pytest.mark.parametrize(
    ("azimuth_deg", "side"),
    [
        (0, (0, 3)),
        pytest.param(90, (-3, 0), marks=pytest.mark.long),
        pytest.param(180, (0, -3), marks=pytest.mark.long),
        pytest.param(270, (3, 0), marks=pytest.mark.long),
    ],
)
def test_the_shadow_falls_away_from_the_sun(any_backend, box_file, azimuth_deg, side):
    """A box of 2 m under a sun 30 degrees high shades the ground 3.46 m behind it."""
    show_box(any_backend, box_file)
    light(
        any_backend,
        uniform_sky(0.0),
        sun_direction=sun_at(azimuth_deg, 30.0),
        sun_irradiance=(10.0,) * 3,
    )
    x, z = side
    shaded = look(any_backend, (x, 12.0, z), (x, 0.0, z), 0.02)
    lit = look(any_backend, (-x, 12.0, -z), (-x, 0.0, -z), 0.02)
    assert shaded.radiance.max() == 0.0
    even(any_backend, lit.radiance, 0.5 / np.pi * 10.0 * 0.5, rtol=5e-3)


@pytest.mark.parametrize("face", range(6))
def test_each_face_of_the_cube_is_seen_where_it_belongs(any_backend, box_file, face):
    """Looking along +X shows the face +X and so on: a turned or mirrored sky would not."""
    cube = np.zeros((6, SIZE, SIZE, 3))
    cube[:] = (np.arange(6) + 1.0)[:, None, None, None]
    show_box(any_backend, box_file)
    light(any_backend, cube)
    eye = np.array([0.0, 500.0, 0.0])
    # Downwards the ground disc would be in the way, so look from below it.
    if face == 3:
        eye[1] = -1.0
    picture = look(any_backend, tuple(eye), tuple(eye + FACE_NORMALS[face]), 0.3)
    np.testing.assert_allclose(picture.radiance, face + 1.0, rtol=1e-3)


def test_the_sky_is_not_mirrored(any_backend, box_file):
    """A pixel shows the sky of its own direction: right of north is east, up is the zenith."""
    cube = 2.0 + texel_directions(64)
    show_box(any_backend, box_file)
    light(any_backend, cube)
    picture = look(any_backend, (0.0, 50.0, 0.0), (0.0, 70.0, -20.0), 1.0)
    rows, columns = picture.radiance.shape[:2]
    middle = picture.radiance[rows // 2, columns // 2]
    np.testing.assert_allclose(middle, [2.0, 2.0 + 0.7071, 2.0 - 0.7071], atol=0.01)
    assert np.all(np.diff(picture.radiance[rows // 2, ::8, 0]) > 0)
    assert np.all(np.diff(picture.radiance[::8, columns // 2, 1]) < 0)


def test_the_horizon_is_one_sharp_line(any_backend, box_file):
    """Sky and ground meet within a pixel: cube-map filtering must not make a grey band.

    The path tracer's map has a row for a quarter of a texel: it meets within that.
    """
    size = 128
    directions = texel_directions(size)
    cube = np.where(directions[..., 1:2] > 0.0, 4.0, 1.0) * np.ones(3)
    show_box(any_backend, box_file)
    light(any_backend, cube)
    # From far above the disc's rim the cube's own ground is seen out to the horizon.
    picture = look(any_backend, (0.0, 5000.0, 0.0), (0.0, 5000.0, -1.0), 0.1)
    column = picture.radiance[:, 80, 0]
    between = (column > 1.01) & (column < 3.99)
    row_px = 0.0 if is_gl(any_backend) else np.pi / (4 * size) * 120 / 0.1
    assert between.sum() <= 1 + np.ceil(row_px)
    assert column[0] == pytest.approx(4.0)
    assert column[-1] == pytest.approx(1.0)


def test_the_disc_carries_the_suns_irradiance(any_backend, box_file):
    """Radiance times solid angle over the disc's pixels gives back the irradiance, within 1 %."""
    show_box(any_backend, box_file)
    direction = sun_at(140.0, 35.0)
    light(
        any_backend, uniform_sky(0.0), sun_direction=direction, sun_irradiance=(120.0, 100.0, 70.0)
    )
    eye = np.array([0.0, 10.0, 0.0])
    picture = look(any_backend, tuple(eye), tuple(eye + direction), 0.02)
    pixel_sr = (2 * np.tan(0.01) / picture.radiance.shape[0]) ** 2
    np.testing.assert_allclose(
        picture.radiance.sum(axis=(0, 1)) * pixel_sr, [120.0, 100.0, 70.0], rtol=0.01
    )


def test_the_disc_darkens_towards_its_limb(any_backend, box_file):
    """Radiance E / solid angle times 0.4 + 0.9 cos psi (mean 1): 1.3 amid, 0.94 at 0.8 radii."""
    show_box(any_backend, box_file)
    direction = sun_at(140.0, 35.0)
    light(any_backend, uniform_sky(0.0), sun_direction=direction, sun_irradiance=(100.0,) * 3)
    _, sun, _ = light_messages(uniform_sky(0.0), direction, (100.0,) * 3)
    any_backend.change(key_light=msgspec.structs.replace(sun, limb_darkening_rgb=((0.4, 0.9),) * 3))
    picture = look(any_backend, (0, 10, 0), np.add((0, 10, 0), direction), 0.02)
    mean = 100.0 / (4 * np.pi * np.sin(0.5 * 0.00465) ** 2)
    pixels_a_radius = 60 * np.tan(0.00465) / np.tan(0.01)
    row = picture.radiance[60, :, 0] / mean
    away = np.abs(np.arange(160) + 0.5 - 80) / pixels_a_radius
    cosine = np.sqrt(1.0 - np.minimum(away, 1.0) ** 2)
    inside = away < 0.9
    np.testing.assert_allclose(row[inside], (0.4 + 0.9 * cosine)[inside], rtol=0.02)
    assert row[away > 1.1].max() == 0.0


def test_a_sun_below_the_horizon_draws_no_disc(any_backend, box_file):
    """What lies under the horizon is ground, also where the sun is behind it."""
    show_box(any_backend, box_file)
    light(
        any_backend, uniform_sky(0.0), sun_direction=sun_at(140.0, -0.5), sun_irradiance=(1.0,) * 3
    )
    eye = np.array([0.0, 5000.0, 0.0])
    picture = look(any_backend, tuple(eye), tuple(eye + sun_at(140.0, -0.5)), 0.01)
    assert picture.radiance.max() == 0.0


def test_manual_exposure_is_kept_and_one_stop_is_a_factor_of_two(any_backend, box_file):
    """EV100 is what was asked for; compensation brightens, by lowering it."""
    show_box(any_backend, box_file)
    light(any_backend, uniform_sky(3.0))
    any_backend.change(exposure=SetExposure(mode="manual", ev100=12.0))
    assert look(any_backend, (30.0, 5.0, 0.0), (40.0, 0.0, 0.0)).ev100 == 12.0
    any_backend.change(exposure=SetExposure(mode="auto"))
    metered = any_backend.draw().ev100
    any_backend.change(exposure=SetExposure(mode="auto", compensation_ev=1.5))
    assert any_backend.draw().ev100 == pytest.approx(metered - 1.5)


def test_drawing_before_anything_is_known_says_what_is_missing(any_backend):
    """A host that draws too early must learn what it forgot."""
    with pytest.raises(RuntimeError, match="no scene, no background, no key light"):
        any_backend.draw()


@pytest.mark.parametrize("eye", [(0.9, 1.6, 1.2), (-1.5, 0.9, 0.3)])
def test_the_camera_is_one_camera_to_the_pixel(any_backend, tmp_path, eye):
    """A square's corners, projected by hand, bound what is seen: its middle to 0.1 px, area to 1 %.

    A camera that is shifted by half a pixel, mirrored or measures its angle across would not.
    """
    target, angle_rad = np.array([0.15, 0.1, -0.1]), 0.9
    any_backend.change(scene=opened(square(tmp_path)))
    light(any_backend, uniform_sky(1.0))
    seen = look(any_backend, eye, tuple(target), angle_rad).radiance[..., 1].astype(float)
    # Black glass before a white sky: what it covers of a pixel is missing there, but for 4 % up.
    glass = np.quantile(seen, 0.05)
    covered = (1.0 - seen) / (1.0 - glass)
    covered = np.clip(covered, 0.0, 1.0)
    projection = perspective(angle_rad, WIDTH / HEIGHT, 0.01)
    clip = np.c_[CORNERS, np.ones(4)] @ (projection @ look_at(eye, target)).T
    x = (clip[:, 0] / clip[:, 3] + 1.0) * WIDTH / 2.0
    y = (1.0 - clip[:, 1] / clip[:, 3]) * HEIGHT / 2.0
    # The polygon's area and centroid by its corners (the shoelace formula).
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area = cross.sum() / 2.0
    centre = [((v + np.roll(v, -1)) * cross).sum() / (6.0 * area) for v in (x, y)]
    columns, rows = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    found = [(covered * v).sum() / covered.sum() for v in (columns, rows)]
    np.testing.assert_allclose(found, centre, atol=0.1)
    assert covered.sum() == pytest.approx(abs(area), rel=0.01)
