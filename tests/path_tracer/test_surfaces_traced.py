"""Materials, textures and places: what the path tracer makes of a scene's meshes."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest
from light_messages import light_messages
from long_parameters import mostly_long
from path_tracer.backend import PathTracedBackend
from path_tracer.settings import PathTracerSettings
from path_tracer.textures import scaled_normals
from path_tracer_here import mitsuba_or_skip
from scene_stage import square, surface
from stateful_backend import StatefulBackend, opened

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.scene.loading import load_scene

mitsuba_or_skip()
# From straight above the square of 1 m in the plane y = 0.
ABOVE = ((0.0, 3.0, 0.0), (0.0, 0.0, 0.0))
CORNER_COLOURS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
# Of the way from north to south, of which 3 tan 0.15 of a metre are seen either side of half:
# the middles of four bands.
SOUTH = (0.5 + 3.0 * np.tan(0.15) * np.array([-0.75, -0.25, 0.25, 0.75]))[:, None, None]
GREY_SHADE = np.repeat([[1.0], [1.0], [0.5], [0.5]], 3, axis=1)
# White in the west, red in the east.
WHITE_AND_RED = np.full((32, 32, 3), 255, np.uint8)
WHITE_AND_RED[:, 16:, 1:] = 0


@pytest.fixture
def backend():
    traced = PathTracedBackend(PathTracerSettings(spp=32, max_bounces=1))
    return StatefulBackend(traced, size_px=(48, 48))


def picture(backend, path, radiance=1.0, eye_target=ABOVE, angle_rad=0.3, **sun):
    """The radiance of a file's square under a uniform sky and a sun."""
    backend.change(scene=opened(path))
    background, key_light, ambient = light_messages(np.full((6, 8, 8, 3), radiance), **sun)
    backend.change(background=background, key_light=key_light, ambient=ambient)
    eye, target = eye_target
    backend.change(
        moved_camera=MoveCamera(eye_m=eye, target_m=target, vertical_field_of_view_rad=angle_rad)
    )
    return backend.draw().radiance


def bands_and_halves(found):
    """Means (4, 2, 3) of a picture's bands from the north, west and east of its middle."""
    return found.reshape(4, 12, 2, 24, 3)[:, :, :, 2:-2].mean(axis=(1, 3))


@pytest.mark.parametrize("roughness", [0.05, 0.2])
def test_a_smooth_metal_reflects_the_share_that_is_its_colour(backend, tmp_path, roughness):
    """Seen from straight above, F0 of a uniform sky: 1 % (one bounce loses little when smooth)."""
    metal = surface(1.0, roughness, 0.7)
    found = picture(backend, square(tmp_path, metal)).mean(axis=(0, 1))
    np.testing.assert_allclose(found, 0.7, rtol=0.01)


def test_a_dielectric_reflects_four_percent(backend, tmp_path):
    """Black and smooth: glTF's F0 of 0.04 from straight above, 2 % of it."""
    found = picture(backend, square(tmp_path, surface(0.0, 0.05, 0.0))).mean(axis=(0, 1))
    np.testing.assert_allclose(found, 0.04, rtol=0.02)


@pytest.mark.parametrize("roughness", [0.3, 0.9])
def test_a_white_dielectric_keeps_all_light(backend, tmp_path, roughness):
    """Coat and paint together return what falls on them, from above: 4 % (the coat's mean)."""
    found = picture(backend, square(tmp_path, surface(0.0, roughness, 1.0))).mean(axis=(0, 1))
    np.testing.assert_allclose(found, 1.0, atol=0.04)


def test_a_coated_surface_is_lamberts_below_and_a_principled_one_is_not(backend, tmp_path):
    """Grey of 0.5 in a sun 20 degrees high, from above: 6 % of a / pi E sin, or 10 % and more.

    Without its coat it is Lambert's own.
    """
    path = square(tmp_path, surface(0.0, 0.9, 0.5))
    sun = {"sun_direction": sun_at(40.0, 20.0), "sun_irradiance": (9.0,) * 3}
    lambert = 0.5 / np.pi * 9.0 * np.sin(np.radians(20.0))
    coated = picture(backend, path, radiance=0.0, **sun).mean()
    np.testing.assert_allclose(coated, lambert, rtol=0.06)
    backend.backend.settings = PathTracerSettings(spp=32, max_bounces=1, surfaces="principled")
    assert picture(backend, path, radiance=0.0, **sun).mean() > 1.1 * lambert
    backend.backend.settings = PathTracerSettings(spp=32, max_bounces=1, surfaces="bare")
    bare = picture(backend, path, radiance=0.0, **sun).mean()
    np.testing.assert_allclose(bare, lambert, rtol=2e-3)


def test_a_back_side_is_lit_like_a_front_side(backend, tmp_path):
    """Walls of one sheet are seen from inside too."""
    path = square(tmp_path, {**surface(1.0, 0.1, 0.7), "doubleSided": True})
    below = ((0.0, -3.0, 0.0), (0.0, 0.0, 0.0))
    np.testing.assert_allclose(picture(backend, path, eye_target=below).mean(), 0.7, rtol=0.01)


def test_a_texture_lies_as_in_the_file(backend, tmp_path):
    """Red, green, blue and white quarters: first row of the image at v = 0, the square's north.

    From above, north is at the picture's top and east on its right.
    """
    image = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)
    image = image.repeat(32, 0).repeat(32, 1)
    paint = surface(1.0, 0.1)
    paint["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    found = picture(backend, square(tmp_path, paint, [image]))
    for (row, column), colour in {
        (12, 12): (1, 0, 0),
        (12, 36): (0, 1, 0),
        (36, 12): (0, 0, 1),
        (36, 36): (1, 1, 1),
    }.items():
        np.testing.assert_allclose(found[row, column], colour, atol=0.08)


def test_factors_multiply_maps(backend, tmp_path):
    """sRGB 188 is linear 0.503; times a factor of 0.6: 0.302 of the sky, on a metal, to 1 %."""
    paint = surface(1.0, 0.1, 0.6)
    paint["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    image = np.full((4, 4, 3), 188, np.uint8)
    found = picture(backend, square(tmp_path, paint, [image])).mean()
    np.testing.assert_allclose(found, 0.6 * 0.5029, rtol=0.01)


def test_vertex_colours_multiply_the_base_colour(backend, tmp_path):
    """Corners of four colours, on a metal of 0.5: halfway between them in the middle."""
    path = square(tmp_path, surface(1.0, 0.1, 0.5), attributes={"COLOR_0": CORNER_COLOURS})
    found = picture(backend, path)
    # South-west is red, south-east green, north-east blue, north-west white.
    assert found[44, 3].argmax() == 0
    assert found[44, 44].argmax() == 1
    assert found[3, 44].argmax() == 2
    np.testing.assert_allclose(found.max(), 0.5, atol=0.05)


@pytest.mark.parametrize(
    ("model", "metallic"),
    [
        pytest.param("bare", 0.0, marks=pytest.mark.long),
        ("principled", 1.0),
        pytest.param("bare", 1.0, marks=pytest.mark.long),
        pytest.param("principled", 0.0, marks=pytest.mark.long),
    ],
)
def test_vertex_colours_and_a_map_multiply(backend, tmp_path, model, metallic):
    """Colours from 1 in the south to 0 in the north, over a map of two greys and an orange factor.

    What is reflected is affine in the base colour: at a share t of the way it is the map's alone
    times t and that of black times the rest, 2 % of the brightest.
    """
    image = np.full((32, 32, 3), 255, np.uint8)
    image[:, 16:] = 128
    paint = surface(metallic, 0.4)
    paint["pbrMetallicRoughness"]["baseColorFactor"] = [1.0, 0.5, 0.1, 1.0]
    paint["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    backend.backend.settings = PathTracerSettings(spp=64, max_bounces=1, surfaces=model)

    def seen(corners):
        colours = {"COLOR_0": np.repeat(np.array(corners, float)[:, None], 3, axis=1)}
        path = square(tmp_path, paint, [image], attributes=colours)
        return bands_and_halves(picture(backend, path))

    white, black = seen([1, 1, 1, 1]), seen([0, 0, 0, 0])
    expected = SOUTH * white + (1.0 - SOUTH) * black
    np.testing.assert_allclose(seen([1, 1, 0, 0]), expected, atol=0.02 * white.max())


@pytest.mark.parametrize("model", mostly_long(["bare", "gltf"], "gltf".__eq__))
def test_shades_of_vertices_keep_a_maps_hues(backend, tmp_path, model):
    """White and red halves under baked grey, 1 in the south to 0.5 in the north, in a furnace.

    Without coat each half is the map's colour times the shade; with it, so is what a white
    surface has more than a black one. 2 % of white.
    """
    backend.backend.settings = PathTracerSettings(spp=64, max_bounces=1, surfaces=model)
    black, white = 0.0, 1.0
    if model == "gltf":
        plain = (square(tmp_path, surface(0.0, 0.6, albedo)) for albedo in (0.0, 1.0))
        black, white = (bands_and_halves(picture(backend, path)) for path in plain)
    found = bands_and_halves(traced_map(backend, tmp_path, GREY_SHADE))
    colour = np.array([[1, 1, 1], [1, 0, 0]]) * (0.5 + 0.5 * SOUTH)
    np.testing.assert_allclose(found, black + (white - black) * colour, atol=0.02)


def test_nothing_reflects_more_than_it_gets(backend, tmp_path):
    """White and red under vertex colours of many hues, bare in a furnace of 1: noise of 5 %.

    The map's mean hue would make the white half's red 1.5.
    """
    backend.backend.settings = PathTracerSettings(spp=64, max_bounces=1, surfaces="bare")
    assert traced_map(backend, tmp_path, CORNER_COLOURS).max() < 1.05


def test_a_rounding_of_vertex_colours_changes_nothing(backend, tmp_path):
    """Colours that differ by 1e-6 are one: sample for sample the picture without them, to 1e-5."""
    alone = traced_map(backend, tmp_path, np.ones((4, 3)))
    rounded = traced_map(backend, tmp_path, 1.0 - 1e-6 * CORNER_COLOURS)
    np.testing.assert_allclose(rounded, alone, atol=1e-5)


def traced_map(backend, folder, colours):
    """The picture of white and red under these colours (4, 3) of the corners."""
    paint = surface(0.0, 0.6)
    paint["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    return picture(backend, square(folder, paint, [WHITE_AND_RED], attributes={"COLOR_0": colours}))


def test_what_is_cut_out_shows_the_sky_and_what_is_blended_its_share(backend, tmp_path):
    """Alpha 0.25 over a sky of 1, on a black square: 0.75 through it; masked at 0.5, a hole."""
    for mode, expected in (("BLEND", 0.75 + 0.25 * 0.04), ("MASK", 1.0), ("OPAQUE", 0.04)):
        paint = {**surface(0.0, 0.05, 0.0), "alphaMode": mode, "alphaCutoff": 0.5}
        paint["pbrMetallicRoughness"]["baseColorFactor"] = [0, 0, 0, 0.25]
        backend.backend.settings = PathTracerSettings(spp=64, max_bounces=2)
        found = picture(backend, square(tmp_path, paint)).mean()
        np.testing.assert_allclose(found, expected, rtol=0.02)


def test_what_glows_has_its_luminance(backend, tmp_path):
    """glTF gives cd m^-2: 683 of them are 1 W m^-2 sr^-1 of white, in the dark, to 1e-5."""
    paint = {**surface(0.0, 1.0, 0.0), "emissiveFactor": [1.0, 0.5, 0.25]}
    found = picture(backend, square(tmp_path, paint), radiance=0.0)
    np.testing.assert_allclose(
        found, np.broadcast_to(np.array([1, 0.5, 0.25]) / 683.0, found.shape), rtol=1e-5
    )


def test_a_glow_lights_what_stands_near(backend, tmp_path):
    """A square that faces a glowing one is brighter than by its own emission."""
    paint = {**surface(0.0, 1.0, 0.5), "emissiveFactor": [1.0, 1.0, 1.0]}
    turned = {"mesh": 0, "translation": [0, 1, 0], "rotation": [1, 0, 0, 0]}
    path = square(tmp_path, paint, nodes=[{"mesh": 0}, turned])
    backend.backend.settings = PathTracerSettings(spp=32)
    eye_target = ((0.9, 0.5, 0.0), (0.2, 0.0, 0.0))
    found = picture(backend, path, radiance=0.0, eye_target=eye_target)
    assert found[24, 24].min() > 1.02 / 683.0


def test_a_normal_map_leans_the_mirror(backend, tmp_path):
    """Slopes along +u (east) and along v upwards (north): the reflection goes where they lean."""
    paint = {**surface(1.0, 0.05), "normalTexture": {"index": 0}}
    for encoded, axis, sign in (((180, 128, 240), 0, 1.0), ((128, 180, 240), 2, -1.0)):
        image = np.full((4, 4, 3), encoded, np.uint8)
        path = square(tmp_path, paint, [image])
        backend.change(scene=opened(path))
        background, sun, ambient = light_messages(2.0 + texel_directions(32))
        backend.change(background=background, key_light=sun, ambient=ambient)
        backend.change(
            moved_camera=MoveCamera(
                eye_m=(0, 3, 0), target_m=(0, 0, 0), vertical_field_of_view_rad=0.1
            )
        )
        normal = np.array(encoded) / 127.5 - 1.0
        normal /= np.linalg.norm(normal)
        seen = backend.draw().radiance.mean(axis=(0, 1)) - 2.0
        # Reflected from straight above: 2 n (n.v) - v.
        np.testing.assert_allclose(seen[axis], sign * 2 * normal[:2].max() * normal[2], atol=0.03)


def test_scaled_normals_stay_unit_vectors():
    """Slopes are scaled, a missing normal points up: twice (0.6, 0, 0.8) leans as (1.2, 0, 0.8)."""
    encoded = np.array([[[0.8, 0.5, 0.9], [0.5, 0.5, 0.5]]], np.float32)
    normal = 2.0 * scaled_normals(encoded, 2.0) - 1.0
    expected = np.array([1.2, 0.0, 0.8]) / np.hypot(1.2, 0.8)
    np.testing.assert_allclose(normal[0, 0], expected, atol=1e-6)
    np.testing.assert_allclose(normal[0, 1], [0, 0, 1], atol=1e-6)


def test_instances_stand_where_single_meshes_would(backend, tmp_path):
    """Two squares of one mesh, turned and scaled unevenly, against the same as two files."""
    places = [
        {"mesh": 0, "translation": [0.6, 0, 0], "rotation": [0, 0, 0.259, 0.966]},
        {"mesh": 0, "translation": [-0.6, 0.2, 0], "scale": [0.5, 1.0, 2.0]},
    ]
    metal = surface(1.0, 0.3, 0.7)
    sun = {"sun_direction": sun_at(40.0, 50.0), "sun_irradiance": (9.0,) * 3}
    view = {"eye_target": ((0.0, 3.0, 2.0), (0.0, 0.0, 0.0)), "angle_rad": 0.8, **sun}
    both = square(tmp_path, metal, nodes=places)
    shared = load_scene(both).meshes
    assert shared[0].mesh is shared[1].mesh
    together = picture(backend, both, **view)
    scene = load_scene(both)
    other = load_scene(both).meshes[1]
    backend.change(scene=opened(replace(scene, meshes=(scene.meshes[0], other))))
    np.testing.assert_allclose(backend.draw().radiance, together, atol=2e-3)


def test_vertex_colours_stay_on_a_mesh_in_several_places(backend, tmp_path):
    """A second square 5 m away changes no colour of the first, to 2 %: both have their own.

    An instance would look its colours up by its place in the world, far off the mesh.
    """
    colours = {"COLOR_0": CORNER_COLOURS}
    backend.backend.settings = PathTracerSettings(spp=64, max_bounces=1, surfaces="bare")
    alone = picture(backend, square(tmp_path, surface(0.0, 0.6), attributes=colours))
    nodes = [{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}]
    path = square(tmp_path, surface(0.0, 0.6), attributes=colours, nodes=nodes)
    both = picture(backend, path)
    np.testing.assert_allclose(bands_and_halves(both), bands_and_halves(alone), atol=0.02)


def sun_at(azimuth_deg, elevation_deg):
    angles = np.radians([azimuth_deg, elevation_deg])
    return tuple(world_from_enu(direction_from_angles(*angles)))


@pytest.mark.parametrize(
    ("scale", "offset_m"),
    [
        pytest.param(1e-3, 0.0, marks=pytest.mark.long),
        pytest.param(2e3, 0.0, marks=pytest.mark.long),
        (1.0, 2e6),
    ],
)
def test_watches_cities_and_far_places_are_traced_alike(backend, tmp_path, scale, offset_m):
    """The same picture at any scale, and 2,000 km from the origin: same samples, to 1 %.

    An overhang's shadow would move if rays started at a distance that does not scale.
    """
    nodes = [
        {"mesh": 0, "translation": [offset_m, 0, 0], "scale": [scale] * 3},
        {"mesh": 0, "translation": [offset_m, 0.3 * scale, 0], "scale": [0.5 * scale] * 3},
    ]
    path = square(tmp_path, surface(0.0, 1.0, 0.5), nodes=nodes)
    sun = {"sun_direction": sun_at(40.0, 50.0), "sun_irradiance": (9.0,) * 3}
    eye = (offset_m, 3.0 * scale, 1.0 * scale)
    view = (eye, (offset_m, 0.0, 0.0))
    found = picture(backend, path, eye_target=view, **sun)
    reference_nodes = [{"mesh": 0}, {"mesh": 0, "translation": [0, 0.3, 0], "scale": [0.5] * 3}]
    path = square(tmp_path, surface(0.0, 1.0, 0.5), nodes=reference_nodes)
    reference = picture(backend, path, eye_target=((0.0, 3.0, 1.0), (0.0, 0.0, 0.0)), **sun)
    assert np.ptp(reference) > 0.5
    wrong = np.abs(found - reference).max(axis=-1) > 0.05 * reference.max()
    assert wrong.mean() < 0.01


def test_emission_and_darkness_without_any_light(backend, tmp_path):
    """A night without lamps is black, and no error."""
    assert picture(backend, square(tmp_path, surface(0.0, 1.0)), radiance=0.0).max() == 0.0


def test_a_sky_that_stayed_on_the_gpu_is_refused(backend, tmp_path):
    """It cannot be read: a sentence, not a crash in numpy."""
    from vrut_lite.messages.gpu_texture import GpuTexture

    background, sun, ambient = light_messages(np.ones((6, 4, 4, 3)))
    texture = GpuTexture(size=4, format="rgba16f", recipe="")
    backend.change(scene=opened(square(tmp_path, surface(0.0, 1.0))))
    backend.change(background=msgspec.structs.replace(background, cube=texture))
    backend.change(key_light=sun, ambient=ambient)
    backend.change(moved_camera=MoveCamera(eye_m=(0, 3, 0), target_m=(0, 0, 0)))
    with pytest.raises(ValueError, match="demand it as float16"):
        backend.draw()
