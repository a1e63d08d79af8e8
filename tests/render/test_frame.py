"""The frame against scenes whose pixels can be worked out on paper."""

import numpy as np
import pytest
import trimesh
from box_stage import show_box, sun_at, uniform_sky
from scene_stage import light, look, square, surface
from stateful_backend import opened

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures.display import display_picture

pytestmark = pytest.mark.gl


@pytest.fixture
def backend(shared_gl_backend):
    return shared_gl_backend(size_px=(160, 120))


@pytest.mark.parametrize(
    "elevation_deg", [1.0, 20.0, *(pytest.param(e, marks=pytest.mark.long) for e in (4.0, 70.0))]
)
@pytest.mark.parametrize("scale", [0.01, 1.0, 3000.0])
def test_no_acne_on_a_lit_face_at_any_scale(backend, tmp_path, elevation_deg, scale):
    """A face that the sun sees is lit evenly: every pixel of the box's top within 0.5 %."""
    path = tmp_path / "box.glb"
    trimesh.creation.box((2 * scale,) * 3).apply_translation((0, scale, 0)).export(path)
    backend.change(scene=opened(path))
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
    backend.change(scene=opened(path))
    sun = {"sun_direction": sun_at(110.0, elevation_deg), "sun_irradiance": (10.0,) * 3}
    light(backend, uniform_sky(0.0), **sun)
    # From so far that the disc's middle looks the same from all of its pixels.
    picture = look(backend, (0.0, 12.0, 60.0), (0.0, 0.1, 0.0), 0.06)
    np.testing.assert_allclose(picture.radiance, np.median(picture.radiance), rtol=0.02)


@pytest.mark.parametrize("elevation_deg", [10.0, 30.0, 60.0])
def test_no_light_leaks_under_a_low_roof(backend, tmp_path, elevation_deg):
    """A roof just above the floor shades it, by the geometry of the taps along an axis of the map:
    what is nearer than half a texel towards the sun, and one of the floor's slope, counts as the
    floor itself, and the filter reaches one texel on.

    The roof is one-sided and looks down: from above the floor is seen through it.
    """
    from vrut_lite.render.passes.shadow_map import SHADOW_SIZE

    # Of the angle between the floor's normal and the sun.
    cosine, sine = np.sin(np.radians(elevation_deg)), np.cos(np.radians(elevation_deg))
    scale, texel_m = 40.0, 40.0 * np.sqrt(2.0) / SHADOW_SIZE
    roof = {"mesh": 0, "scale": [4.0, 1.0, 4.0], "rotation": [1.0, 0.0, 0.0, 0.0]}
    roof["translation"] = [0.0, (0.5 * cosine + 2.0 * sine + 0.2) * texel_m, 0.0]
    nodes = [{"mesh": 0, "scale": [scale, 1.0, scale]}, roof]
    backend.change(scene=opened(square(tmp_path, surface(0.0, 1.0), nodes=nodes)))
    # In the plane of x and y, in which one axis of the map then lies.
    sun = {"sun_direction": sun_at(90.0, elevation_deg), "sun_irradiance": (10.0,) * 3}
    light(backend, uniform_sky(0.0), **sun)
    under = look(backend, (0.0, 20.0, 0.1), (0.0, 0.0, 0.0), 0.05).radiance
    beside = look(backend, (0.0, 20.0, 8.1), (0.0, 0.0, 8.0), 0.05).radiance
    np.testing.assert_array_equal(under, 0.0)
    assert beside.min() > 0.0


def test_the_shadow_of_a_low_sheet_ends_where_the_sun_passes_it(backend, tmp_path):
    """Twelve texels above the floor and under a sun of 10 degrees a sheet's shadow lies 0.9 m off.

    Three texels inside its end, which are 0.08 m wide there, the floor is dark, as near outside it
    is lit: a floor that were lifted off itself would lose 0.2 m of the shadow.
    """
    from vrut_lite.render.passes.shadow_map import SHADOW_SIZE

    scale, texel_m, elevation = 40.0, 40.0 * np.sqrt(2.0) / SHADOW_SIZE, np.radians(10.0)
    sheet = {"mesh": 0, "scale": [4.0, 1.0, 4.0], "translation": [0.0, 12.0 * texel_m, 0.0]}
    nodes = [{"mesh": 0, "scale": [scale, 1.0, scale]}, sheet]
    backend.change(scene=opened(square(tmp_path, surface(0.0, 1.0), nodes=nodes)))
    sun = {"sun_direction": sun_at(90.0, 10.0), "sun_irradiance": (10.0,) * 3}
    light(backend, uniform_sky(0.0), **sun)
    end = -2.0 - 12.0 * texel_m / np.tan(elevation)
    inside, outside = (
        look(backend, (x, 20.0, 0.001), (x, 0.0, 0.0), 0.001).radiance[..., 1]
        for side in (1.0, -1.0)
        for x in [end + side * 3.2 * texel_m / np.sin(elevation)]
    )
    np.testing.assert_array_equal(inside, 0.0)
    assert outside.min() > 0.0


def test_a_pixel_on_an_edge_is_the_mean_of_what_it_shows(backend, box_file):
    """Three pictures, averaged in linear radiance: thirds of the way from a black disc to 3."""
    show_box(backend, box_file, albedo=0.0)
    light(backend, uniform_sky(3.0))
    picture = look(backend, (200.0, 20.0, 0.0), (200.0, 0.0, 0.0))
    assert set(np.unique(picture.radiance)) == {0.0, 1.0, 2.0, 3.0}


@pytest.mark.parametrize("curve", ["agx", "exponential", "none"])
@pytest.mark.parametrize(("dim", "glare"), [(1.0, 0.0), (1e-2, 0.0), (1e-5, 0.0), (1e-2, 0.5)])
@pytest.mark.parametrize("white", [(6504.0, 0.0), (3200.0, 0.01)])
def test_the_tone_map_on_the_gpu_is_its_numpy_twin(backend, box_file, curve, dim, glare, white):
    """The shader and pictures/display.py write one curve, one night, one glare and one dither:
    within one 8-bit step."""
    kelvin, duv = white
    wish = SetExposure(tone_map=curve, white_temperature_k=kelvin, white_duv=duv, glare=glare)
    backend.change(exposure=wish)
    show_box(backend, box_file)
    light(backend, dim * (0.02 + 3.0 * (1.0 + texel_directions(64)) ** 4))
    picture = look(backend, (0.0, 50.0, 0.0), (0.0, 70.0, -20.0), 1.4)
    # GL counts rows from below, and so does its dither.
    turned = picture.radiance[::-1]
    twin = display_picture(turned, picture.ev100, wish, pixel_rad=picture.pixel_rad)[::-1]
    assert np.abs(twin.astype(int) - picture.display.astype(int)).max() <= 1
    assert np.ptp(picture.display) > (100 if dim == 1.0 else 60)
