"""Maps beyond their edges, between texels, and in the distance, as the file's sampler says."""

import numpy as np
import pytest
from long_parameters import mostly_long
from scene_stage import CORNERS, UV, light, look, square
from stateful_backend import opened

pytestmark = pytest.mark.gl
REPEAT, CLAMP, MIRROR, NEAREST = 10497, 33071, 33648, 9728
ROUGH = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
# From black in the west to white in the east.
STEPS = np.repeat(np.uint8([[0, 80, 160, 255]]), 4, axis=0)[..., None].repeat(3, axis=-1)


@pytest.fixture
def backend(shared_gl_backend):
    return shared_gl_backend(size_px=(64, 64))


def from_above(backend, path, height=1.0, width=1.0):
    """Radiance (64, 64, 3) of so many metres around the origin, under an even sky of 1."""
    backend.change(scene=opened(path))
    light(backend, np.ones((6, 8, 8, 3)))
    angle = 2 * np.arctan(0.5 * width / height)
    return look(backend, (0.0, height, 1e-6), (0.0, 0.0, 0.0), angle).radiance


def tiled(folder, texels, tiles, **sampler):
    """The square with its map from -tiles to 1 + tiles, along u and along v."""
    pbr = {**ROUGH, "baseColorTexture": {"index": 0}}
    coordinates = UV * (1 + 2 * tiles) - tiles
    material = {"pbrMetallicRoughness": pbr, "doubleSided": True}
    attributes = {"TEXCOORD_0": coordinates}
    return square(folder, material, [texels], attributes=attributes, sampler=sampler)


@pytest.mark.parametrize(
    ("wrap", "expected"),
    [(REPEAT, [0, 3, 0, 3, 0, 3]), (CLAMP, [0, 0, 0, 3, 3, 3]), (MIRROR, [3, 0, 0, 3, 3, 0])],
)
def test_a_map_goes_on_as_its_sampler_says(backend, tmp_path, wrap, expected):
    """West and east edges of three tiles: the texel of the file that is seen there."""
    path = tiled(tmp_path, STEPS, 1, wrapS=wrap, wrapT=REPEAT, magFilter=NEAREST)
    row = from_above(backend, path)[32, :, 0]
    shown = row[[1, 19, 23, 40, 45, 62]]
    dark, bright = row.min(), row.max()
    np.testing.assert_allclose(shown, np.where(np.array(expected) == 3, bright, dark), atol=0.02)


def test_both_axes_have_their_own_wrap(backend, tmp_path):
    """Clamped along u and repeated along v: stripes from east to west in three rows of tiles."""
    texels = STEPS.transpose(1, 0, 2)
    path = tiled(tmp_path, texels, 1, wrapS=CLAMP, wrapT=REPEAT, magFilter=NEAREST)
    picture = from_above(backend, path)[..., 0]
    assert np.ptp(picture[[2, 23, 44], :]) < 0.02
    assert (picture[[19, 40, 62], 32] > 0.5).all()


def test_nearest_texels_show_as_squares(backend, tmp_path):
    """Four texels enlarged: four values and no others, where a linear filter has all between."""
    path = tiled(tmp_path, STEPS, 0, magFilter=NEAREST)
    squares = from_above(backend, path)[32, 2:-2, 0]
    assert len(np.unique(squares.round(2))) == 4
    smooth = from_above(backend, tiled(tmp_path, STEPS, 0))[32, 2:-2, 0]
    assert len(np.unique(smooth.round(2))) > 20


def wires(share, size=256):
    """White texels (size, size, 4) of which columns a texel wide cover this share."""
    texels = np.full((size, size, 4), 255, np.uint8)
    texels[..., 3] = 255 * (np.arange(size) % round(1 / share) == 0)
    return texels


@pytest.mark.parametrize("share", mostly_long([0.5, 0.25, 0.125], lambda share: share < 0.5))
@pytest.mark.parametrize("distance_m", mostly_long([1.0, 8.0, 40.0], lambda far: far > 1.0))
def test_thin_wires_cover_as_much_from_afar(backend, tmp_path, share, distance_m):
    """Black wires before an even sky take away the share that they cover: 0.02 of the sky.

    Alpha that is averaged and then cut would leave all wires or none.
    """
    pbr = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 1.0, "baseColorTexture": {"index": 0}}
    material = {"pbrMetallicRoughness": pbr, "alphaMode": "MASK", "doubleSided": True}
    path = square(tmp_path, material, [wires(share)], corners=CORNERS * 16.0)
    picture = from_above(backend, path, distance_m, width=min(distance_m, 8.0))[8:-8, 8:-8]
    # The map repeats once over 16 m: from 8 m on many texels lie in a pixel.
    assert picture.mean() == pytest.approx(1.0 - share, abs=0.02 if distance_m > 1 else 0.15)


def test_the_shadow_of_wires_is_as_light_as_they_are_thin(backend, tmp_path):
    """Wires that cover a quarter leave three quarters of the sun to the ground: 0.05."""
    from vrut_lite.messages.ground_disc import GroundDisc

    pbr = {**ROUGH, "baseColorTexture": {"index": 0}}
    material = {"pbrMetallicRoughness": pbr, "alphaMode": "MASK", "doubleSided": True}
    texels = wires(0.25, 4096)[:4]
    nodes = [{"mesh": 0, "translation": [0, 2, 0], "scale": [20, 1, 20]}]
    path = square(tmp_path, material, [texels], nodes=nodes)
    backend.change(scene=opened(path, GroundDisc((0.0, 0.0), 0.0, 50.0)))
    backend.change(ground_albedo_rgb=(0.5,) * 3)
    light(backend, np.zeros((6, 8, 8, 3)), sun_direction=(0, 1, 1e-6), sun_irradiance=(np.pi,) * 3)
    picture = look(backend, (0.0, 1.0, 1e-3), (0.0, 0.0, 0.0), 1.0).radiance
    assert picture.mean() == pytest.approx(0.75 * 0.5, abs=0.05)
