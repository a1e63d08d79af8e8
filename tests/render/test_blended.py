"""Blended surfaces: what lies behind them shows, wherever the alpha comes from."""

import numpy as np
import pytest
from long_parameters import mostly_long
from scene_stage import CORNERS, ORDER, light, look, square
from stateful_backend import opened

from vrut_lite.messages.ground_disc import GroundDisc

pytestmark = pytest.mark.gl
SKY = 1.0


@pytest.fixture
def backend(shared_gl_backend):
    return shared_gl_backend(size_px=(32, 32))


def seen(backend, path, eye=(0.0, 2.0, 1e-3)):
    """The middle of the picture from there, under an even sky of radiance 1."""
    backend.change(scene=opened(path))
    light(backend, np.full((6, 8, 8, 3), SKY))
    return look(backend, eye, (0.0, 0.0, 0.0), 0.2).radiance[16, 16]


def black_sheet(folder, alpha, mode="BLEND", **more):
    """A black metal of this alpha in its texture, on two squares a metre apart."""
    image = np.zeros((2, 2, 4), np.uint8)
    image[..., 3] = alpha
    pbr = {"metallicFactor": 1.0, "baseColorTexture": {"index": 0}}
    material = {"pbrMetallicRoughness": pbr, "alphaMode": mode, "doubleSided": True, **more}
    nodes = [{"mesh": 0}, {"mesh": 0, "translation": [0, -1, 0]}]
    return square(folder, material, [image], nodes=nodes)


@pytest.mark.parametrize("eye", [(0.0, 2.0, 1e-3), (0.0, -3.0, 1e-3)])
def test_alpha_in_a_texture_is_sorted_from_either_side(backend, tmp_path, eye):
    """Two sheets of alpha 102 / 255 leave 0.36 of the sky behind them, from above and below.

    Drawn as if solid, before the sky, the nearer one would show black instead.
    """
    shown = seen(backend, black_sheet(tmp_path, 102), eye)
    np.testing.assert_allclose(shown, 0.6**2 * SKY, rtol=0.01)


def test_texels_of_full_alpha_hide_what_is_behind(backend, tmp_path):
    """A blended material that lets nothing through is a solid one: both sheets are black."""
    assert seen(backend, black_sheet(tmp_path, 255)).max() < 0.01


def test_backs_of_a_closed_body_are_blended_before_its_fronts(backend, tmp_path):
    """A red sheet above a green one, as one body, red first in the file: red lies over green."""
    upper, lower = CORNERS, CORNERS[::-1] - [0, 0.5, 0]
    colours = np.repeat([[1, 0, 0, 0.4], [0, 1, 0, 0.4]], 4, axis=0)
    attributes = {"COLOR_0": colours, "TEXCOORD_0": np.zeros((8, 2))}
    pbr = {"metallicFactor": 1.0, "roughnessFactor": 0.0}
    path = square(
        tmp_path,
        {"pbrMetallicRoughness": pbr, "alphaMode": "BLEND", "doubleSided": True},
        attributes=attributes,
        corners=np.concatenate([upper, lower]),
        order=(*ORDER, *(4 + np.array(ORDER))),
    )
    shown = seen(backend, path)
    np.testing.assert_allclose(shown, [0.4 + 0.36, 0.24 + 0.36, 0.36], rtol=0.02)


@pytest.mark.parametrize("alpha", mostly_long([51, 204], (51).__eq__))
def test_a_blended_sheet_leaves_the_sun_what_it_lets_through(backend, tmp_path, alpha):
    """A texture's alpha of a leaves 1 - a of the sun to the ground below: not none, not all."""
    image = np.zeros((2, 2, 4), np.uint8)
    image[..., 3] = alpha
    pbr = {"metallicFactor": 1.0, "baseColorTexture": {"index": 0}}
    material = {"pbrMetallicRoughness": pbr, "alphaMode": "BLEND", "doubleSided": True}
    path = square(tmp_path, material, [image], corners=CORNERS * 4.0)
    backend.change(scene=opened(path, GroundDisc((0, 0), -1.0, 99)), ground_albedo_rgb=(0.5,) * 3)
    sun = {"sun_direction": (0.0, 1.0, 1e-6), "sun_irradiance": (np.pi,) * 3}
    light(backend, np.zeros((6, 8, 8, 3)), **sun)
    shown = look(backend, (0.0, -0.5, 1e-3), (0.0, -1.0, 0.0), 0.2).radiance[16, 16]
    np.testing.assert_allclose(shown, 0.5 * (1.0 - alpha / 255), rtol=0.02)
