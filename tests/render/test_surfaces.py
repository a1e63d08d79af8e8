"""Surfaces as files describe them: maps, masks, colours, odd matrices, odd places, in pixels.

One square of a metre lies level, facing up, under a uniform sky of radiance 1 and no sun, seen
from straight above: its radiance is its albedo plus what its gloss reflects.
"""

import numpy as np
import pytest
from scene_stage import light, look, square
from stateful_backend import opened

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.ground_disc import GroundDisc

pytestmark = pytest.mark.gl
ROUGH = {"metallicFactor": 0.0, "roughnessFactor": 1.0}


@pytest.fixture
def backend(shared_gl_backend):
    return shared_gl_backend(size_px=(64, 64))


def seen(backend, path, ground=None, sun=None, at=(0.0, 0.0, 0.0), sky=1.0):
    """Radiance (64, 64, 3) of what lies at a point, from 1 m above it, 0.8 m across."""
    backend.change(scene=opened(path, ground))
    backend.change(ground_albedo_rgb=(0.5,) * 3)
    light(backend, np.full((6, 16, 16, 3), sky), **(sun or {}))
    eye = (at[0], at[1] + 1.0, at[2])
    backend.change(
        moved_camera=MoveCamera(
            eye_m=eye, target_m=at, vertical_field_of_view_rad=2 * np.arctan(0.4)
        )
    )
    return backend.draw().radiance


def grey(value, shape=(2, 2), channels=3):
    return np.full((*shape, channels), value, np.uint8)


def test_the_base_colour_map_is_decoded_from_srgb(backend, tmp_path):
    """sRGB 188 is 0.503 linear (IEC 61966-2-1): so much of the way from black to white."""
    shown = {}
    for value in (0, 188, 255):
        pbr = {**ROUGH, "baseColorTexture": {"index": 0}}
        path = square(tmp_path, {"pbrMetallicRoughness": pbr}, [grey(value)])
        shown[value] = seen(backend, path)[32, 32]
    share = (shown[188] - shown[0]) / (shown[255] - shown[0])
    np.testing.assert_allclose(share, 0.503, rtol=5e-3)


def test_a_chequerboard_from_afar_is_as_bright_as_its_squares(backend, tmp_path):
    """Black and white by halves give half of white's light; sRGB's own mean would give 21 %."""
    chequered = np.indices((512, 512)).sum(axis=0) % 2 * 255
    maps = {"black": grey(0), "white": grey(255), "both": np.repeat(chequered[..., None], 3, -1)}
    shown = {}
    for name, texels in maps.items():
        pbr = {**ROUGH, "baseColorTexture": {"index": 0}}
        path = square(tmp_path, {"pbrMetallicRoughness": pbr}, [texels.astype(np.uint8)])
        shown[name] = seen(backend, path)[16:48, 16:48].mean()
    share = (shown["both"] - shown["black"]) / (shown["white"] - shown["black"])
    assert share == pytest.approx(0.5, abs=5e-3)


def test_a_map_is_not_mirrored(backend, tmp_path):
    """Red in the west and green in the north: u runs east, v runs south, as glTF has it."""
    image = np.zeros((2, 2, 3), np.uint8)
    image[:, 0, 0] = 255
    image[0, :, 1] = 255
    pbr = {**ROUGH, "baseColorTexture": {"index": 0}}
    picture = seen(backend, square(tmp_path, {"pbrMetallicRoughness": pbr}, [image]))
    assert picture[32, 5, 0] > picture[32, 58, 0] + 0.5
    assert picture[5, 32, 1] > picture[58, 32, 1] + 0.5


@pytest.mark.parametrize("shape", [(1, 1), (1, 4), (4, 1), (3, 5)])
def test_an_occlusion_map_of_any_shape_darkens_the_sky(backend, tmp_path, shape):
    """Half open: half of the sky's light, for pictures of one pixel and of odd widths too."""
    pbr = {**ROUGH, "baseColorFactor": [0.6, 0.6, 0.6, 1]}
    material = {"pbrMetallicRoughness": pbr, "occlusionTexture": {"index": 0}}
    half = seen(backend, square(tmp_path, material, [grey(128, shape)]))[32, 32]
    full = seen(backend, square(tmp_path, {"pbrMetallicRoughness": pbr}))[32, 32]
    np.testing.assert_allclose(half, full * 128 / 255, rtol=5e-3)


def test_each_map_is_looked_up_on_its_own_coordinates(backend, tmp_path):
    """A baked occlusion map on the second set: white there, black where the first set looks."""
    image = np.zeros((2, 2, 3), np.uint8)
    image[0, 0] = 255
    pbr = {**ROUGH, "baseColorFactor": [0.6, 0.6, 0.6, 1], "baseColorTexture": {"index": 1}}
    occlusion = {"index": 0, "texCoord": 1}
    attributes = {"TEXCOORD_1": np.full((4, 2), 0.25), "TEXCOORD_0": np.full((4, 2), 0.75)}
    images = [image, grey(255)]
    baked = {"pbrMetallicRoughness": pbr, "occlusionTexture": occlusion}
    lit = seen(backend, square(tmp_path, baked, images, attributes))[32, 32]
    bare = seen(backend, square(tmp_path, {"pbrMetallicRoughness": pbr}, images, attributes))[
        32, 32
    ]
    np.testing.assert_allclose(lit, bare, rtol=1e-3)
    occlusion["texCoord"] = 0
    assert seen(backend, square(tmp_path, baked, images, attributes)).max() < 0.05
    occlusion["strength"] = 0.25
    weaker = seen(backend, square(tmp_path, baked, images, attributes))[32, 32]
    np.testing.assert_allclose(weaker, 0.75 * bare, rtol=5e-3)


def test_vertex_colours_multiply_the_base_colour(backend, tmp_path):
    """COLOR_0 is linear (glTF 2.0, section 3.7.2.1)."""
    colour = np.tile([0.5, 0.25, 0.0, 1.0], (4, 1))
    pbr = {**ROUGH, "baseColorFactor": [0.8, 0.8, 0.8, 1]}
    path = square(tmp_path, {"pbrMetallicRoughness": pbr}, attributes={"COLOR_0": colour})
    black = {"pbrMetallicRoughness": {**ROUGH, "baseColorFactor": [0, 0, 0, 1]}}
    shown = seen(backend, path)[32, 32] - seen(backend, square(tmp_path, black))[32, 32]
    np.testing.assert_allclose(shown, [0.4, 0.2, 0.0], atol=0.02)
    np.testing.assert_allclose(shown[0], 2 * shown[1], rtol=3e-3)


def test_a_mask_cuts_out_and_casts_the_shadow_of_what_is_left(backend, tmp_path):
    """Half of a square a metre up is cut away: half of it shows, and half of its shadow falls."""
    image = np.zeros((16, 16, 4), np.uint8)
    image[:, 8:] = 255
    pbr = {**ROUGH, "baseColorTexture": {"index": 0}}
    material = {"pbrMetallicRoughness": pbr, "alphaMode": "MASK", "doubleSided": True}
    path = square(tmp_path, material, [image], nodes=[{"mesh": 0, "translation": [0, 1, 0]}])
    sun = {"sun_direction": (0.0, 1.0, 1e-6), "sun_irradiance": (np.pi,) * 3}
    ground = GroundDisc((0.0, 0.0), 0.0, 50.0)
    low = seen(backend, path, ground, sun, at=(0.0, -0.5, 0.0), sky=0.0)
    # From half a metre above the ground, under the square: its shadow in the east alone.
    assert low[32, 60].max() < 0.01
    np.testing.assert_allclose(low[32, 4], 0.5, rtol=0.02)
    high = seen(backend, path, ground, sun, at=(0.0, 1.0, 0.0), sky=0.0)
    assert high[32, 60].min() > 0.8
    np.testing.assert_allclose(high[32, 4], 0.5, rtol=0.02)


def test_a_blended_surface_shows_what_is_behind_it(backend, tmp_path):
    """Alpha 0.25 of a black square over ground of 0.5: three quarters of it remain."""
    pbr = {"baseColorFactor": [0, 0, 0, 0.25], "metallicFactor": 1.0, "roughnessFactor": 1.0}
    material = {"pbrMetallicRoughness": pbr, "alphaMode": "BLEND"}
    path = square(tmp_path, material, nodes=[{"mesh": 0, "translation": [0, 0.1, 0]}])
    shown = seen(backend, path, GroundDisc((0.0, 0.0), 0.0, 50.0))[32, 32]
    np.testing.assert_allclose(shown, 0.75 * 0.5, rtol=0.02)


def test_a_sheet_seen_from_behind_is_lit_from_its_own_side(backend, tmp_path):
    """A double-sided square upside down under sky 1 and ground 1 is as bright as upright."""
    pbr = {**ROUGH, "baseColorFactor": [0.7, 0.7, 0.7, 1]}
    material = {"pbrMetallicRoughness": pbr, "doubleSided": True}
    upright = seen(backend, square(tmp_path, material))[32, 32]
    turned = [{"mesh": 0, "rotation": [1, 0, 0, 0]}]
    np.testing.assert_allclose(
        seen(backend, square(tmp_path, material, nodes=turned))[32, 32], upright, rtol=1e-6
    )


def test_a_normal_map_tilts_the_light(backend, tmp_path):
    """Tilted east by 45 degrees the square gets sin(45 + 45) of a sun in the east at 45 degrees."""
    pbr = {**ROUGH, "baseColorFactor": [0.5, 0.5, 0.5, 1]}
    tilted = np.tile(np.uint8([218, 128, 218]), (2, 2, 1))
    material = {"pbrMetallicRoughness": pbr, "normalTexture": {"index": 0}}
    sun = {"sun_direction": (1.0, 1.0, 0.0), "sun_irradiance": (np.pi,) * 3}
    mapped = seen(backend, square(tmp_path, material, [tilted]), sun=sun, sky=0.0)[32, 32]
    flat = seen(backend, square(tmp_path, {"pbrMetallicRoughness": pbr}), sun=sun, sky=0.0)[32, 32]
    np.testing.assert_allclose(mapped / flat, np.sqrt(2.0), rtol=0.03)


def test_flanks_of_bumps_that_lean_away_from_the_eye_are_not_seen(backend, tmp_path):
    """From low in the west a map that leans east shows its western flanks, as mitsuba has it.

    MotionThreshold flanks would be looked at along their edge, and mirror all of the light.
    """
    shown = []
    for leaning in ([218, 128, 218], [38, 128, 218]):
        material = {"pbrMetallicRoughness": ROUGH, "normalTexture": {"index": 0}}
        texels = np.tile(np.uint8(leaning), (2, 2, 1))
        backend.change(scene=opened(square(tmp_path, material, [texels])))
        light(backend, clear_gradient(), sun_direction=(-1, 1, 0), sun_irradiance=(np.pi,) * 3)
        shown.append(look(backend, (-2.0, 0.5, 0.0), (0, 0, 0), 0.05).radiance[24, 24])
    np.testing.assert_allclose(shown[0], shown[1], rtol=0.03)


def clear_gradient():
    """A sky that is brighter in the east."""
    return (1.0 + 0.9 * texel_directions(16)[..., :1]) * np.ones(3)


@pytest.mark.parametrize("sun", [(0.3, 0.6, 0.7), (-0.9, 0.12, 0.4), (0.5, 0.5, -0.1)])
def test_the_point_opposite_the_sun_is_lit(backend, tmp_path, sun):
    """Around the eye's own shadow, cosines of half the angle round to more than 1: still a number.

    Matt and looked at along the light, the square has the radiance of one direction: 1 % apart.
    """
    towards = np.array(sun) / np.linalg.norm(sun)
    backend.change(scene=opened(square(tmp_path, {"pbrMetallicRoughness": ROUGH})))
    light(backend, np.zeros((6, 8, 8, 3)), sun_direction=towards, sun_irradiance=(10.0,) * 3)
    radiance = look(backend, 2.0 * towards, np.zeros(3), 1e-3).radiance
    assert radiance.min() > 0.1
    np.testing.assert_allclose(radiance, radiance.mean(), rtol=0.01)


@pytest.mark.parametrize("scale", [[1, 0, 1], [0, 0, 0], [1, 1e-20, 1]])
def test_a_flattened_node_does_no_harm(backend, tmp_path, scale):
    """Exporters flatten and hide things by a scale of 0: the rest must show, finite."""
    nodes = [{"mesh": 0}, {"mesh": 0, "scale": scale, "translation": [0, 0.2, 0]}]
    pbr = {**ROUGH, "baseColorFactor": [0.7, 0.7, 0.7, 1]}
    picture = seen(backend, square(tmp_path, {"pbrMetallicRoughness": pbr}, nodes=nodes))
    assert np.isfinite(picture).all()
    assert picture[32, 32].min() > 0.5


@pytest.mark.parametrize("far_m", [1e4, 1e6, 5e6])
def test_a_scene_far_from_the_origin_looks_the_same(backend, tmp_path, far_m):
    """A scene in map coordinates, thousands of kilometres out, shows what it shows at home."""
    pbr = {**ROUGH, "baseColorFactor": [0.7, 0.7, 0.7, 1], "baseColorTexture": {"index": 0}}
    chess = np.kron([[0, 255], [255, 0]], np.ones((2, 2)))[..., None] * np.ones(3)
    sun = {"sun_direction": (1.0, 2.0, 0.5), "sun_irradiance": (3.0,) * 3}
    post = {"mesh": 0, "translation": [0.1, 0.2, 0], "scale": [0.1, 1, 0.1]}
    material = {"pbrMetallicRoughness": pbr, "doubleSided": True}
    home = seen(backend, square(tmp_path, material, [chess], nodes=[{"mesh": 0}, post]), sun=sun)
    x, z = 2 ** round(np.log2(far_m)), -(2.0 ** round(np.log2(far_m)))
    moved = [
        {"mesh": 0, "translation": [x, 0, z]},
        {**post, "translation": [x + 0.1, 0.2, z]},
    ]
    path = square(tmp_path, material, [chess], nodes=moved)
    np.testing.assert_allclose(seen(backend, path, sun=sun, at=(x, 0.0, z)), home, atol=0.02)


def test_what_is_near_is_drawn_in_a_large_scene(backend, tmp_path):
    """A square of a metre, seen from a metre, in a scene that reaches two kilometres."""
    nodes = [
        {"mesh": 0},
        {"mesh": 0, "translation": [2000, 0, 0]},
        {"mesh": 0, "translation": [-2000, -1, 0], "scale": [10, 1, 10]},
    ]
    pbr = {**ROUGH, "baseColorFactor": [0.7, 0.7, 0.7, 1]}
    path = square(tmp_path, {"pbrMetallicRoughness": pbr}, nodes=nodes)
    alone = seen(backend, square(tmp_path, {"pbrMetallicRoughness": pbr}))
    path = square(tmp_path, {"pbrMetallicRoughness": pbr}, nodes=nodes)
    np.testing.assert_allclose(seen(backend, path), alone, rtol=1e-3)
