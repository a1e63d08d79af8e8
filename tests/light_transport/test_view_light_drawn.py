"""A finished still is lit by points of its own where they lie on what it shows."""

import numpy as np
import pytest
from light_map_stage import even, laid, lit
from scene_stage import CORNERS, light, look, square, surface
from stateful_backend import opened

from vrut_lite.array import Array
from vrut_lite.geometry.reflection import reflectance
from vrut_lite.messages.light_map import LightMapLaid
from vrut_lite.messages.view_light import ViewLightChanged

pytestmark = pytest.mark.gl
SIZE = 48
HALF_M = 0.3
ABOVE = ((0.0, 1.0, 1e-3), (0.0, 0.0, 0.0), 2 * np.arctan(HALF_M))
# Texels of the map along the square's edge of a metre.
TEXELS_A_METRE = 7.0
# From the eye 1 m below it, upwards.
LEVEL = (0.0, 1.0, 0.0, -1.0)


@pytest.fixture
def backend(gl_backend, tmp_path):
    """A white square under a map of 1 W m^-2 in every texel, seen from above."""
    backend = gl_backend(size_px=(SIZE, SIZE))
    light(backend, np.zeros((6, 16, 16, 3)))
    scene = opened(square(tmp_path, surface(0.0, 1.0)))
    layout = laid(scene, ((1, 2),))
    texels = even(layout, 1.0, 0.0)
    backend.change(scene=scene)
    backend.hear(layout, lit(layout, texels))
    backend.by_map = look(backend, *ABOVE).radiance.astype(float)
    return backend


def of_view(backend, irradiance, plane=LEVEL, edge_px=4, mirrored=None):
    """Irradiance (rows, columns) on a plane, for the present view.

    `mirrored`: the radiance of both parts of a lobe; unknown without it.
    """
    irradiance = np.asarray(irradiance, float)
    rgba = np.stack([irradiance] * 3 + [np.zeros_like(irradiance)], axis=-1)
    lobes = np.zeros((2, *rgba.shape))
    if mirrored is not None:
        lobes[..., :3], lobes[..., 3] = np.reshape(mirrored, (2, 1, 1, 1)) / 2.0, 1.0
    message = ViewLightChanged(
        layout_key=backend.state.shown(LightMapLaid).layout_key,
        camera=backend.state.camera,
        size_px=(SIZE, SIZE),
        edge_px=edge_px,
        light=Array((rgba / 2.0).astype(np.float16)),
        plane=Array(np.broadcast_to(np.float32(plane), rgba.shape).copy()),
        mirrored=Array(lobes.astype(np.float16)),
        radiance_scale=2.0,
        rays=64,
        source="test",
    )
    message.check()
    message.check_arrays()
    backend.hear(message)


def test_surfaces_have_the_light_of_points_on_them(backend):
    """Linearly between the points, in the middles of their squares."""
    across = np.linspace(1.0, 2.0, 12)
    of_view(backend, np.broadcast_to(across, (12, 12)))
    found = look(backend, *ABOVE).radiance / backend.by_map
    at = (np.arange(SIZE) + 0.5) / 4.0 - 0.5
    expected = np.interp(at, np.arange(12), across)
    # Beyond the last points the two nearest weigh alike.
    np.testing.assert_allclose(found[24, 4:-4, 0], expected[4:-4], rtol=5e-3)


def test_rows_count_from_the_top_also_where_squares_pass_the_border(backend):
    """Squares of 5 pixels on 48: the last row of them is cut."""
    down = np.linspace(1.0, 2.0, 10)
    of_view(backend, np.broadcast_to(down[:, None], (10, 10)), edge_px=5)
    found = look(backend, *ABOVE).radiance / backend.by_map
    expected = np.interp((np.arange(SIZE) + 0.5) / 5.0 - 0.5, np.arange(10), down)
    np.testing.assert_allclose(found[5:-8, 24, 0], expected[5:-8], rtol=5e-3)


@pytest.mark.parametrize("plane", [(0, 1, 0, -0.9), (0, 0.8, 0.6, -0.8), (0, 0, 0, 0)])
def test_points_on_other_planes_light_nothing(backend, plane):
    """Farther away, turned, or in the sky: the map lights the surface."""
    of_view(backend, np.full((12, 12), 3.0), plane)
    found = look(backend, *ABOVE).radiance
    np.testing.assert_allclose(found, backend.by_map, rtol=1e-3)


def test_points_further_off_light_what_the_four_about_it_do_not(backend):
    """Every third column of points lies on the surface: between them those beyond are asked."""
    plane = np.zeros((12, 12, 4))
    plane[:, ::3] = LEVEL
    across = np.broadcast_to(np.linspace(1.0, 2.0, 12), (12, 12))
    of_view(backend, across, plane)
    found = (look(backend, *ABOVE).radiance / backend.by_map)[24, :, 0]
    # Between the columns 1 and 2 those of 0 and 3 weigh alike.
    np.testing.assert_allclose(found[7:9], across[0, [0, 3]].mean(), rtol=5e-3)
    np.testing.assert_allclose(found[13], across[0, 3], rtol=5e-3)


@pytest.mark.parametrize(("metallic", "mapped"), [(0.0, False), (1.0, False), (1.0, True)])
def test_coats_and_metals_mirror_what_points_tell(backend, tmp_path, metallic, mapped):
    """Each part of Schlick's term its own radiance, in place of the mean of all things; a flat
    normal map changes nothing, under a black sky too."""
    flat = np.full((4, 4, 3), (128, 128, 255), np.uint8)
    material = surface(metallic, 0.6, 0.5 * metallic)
    material |= {"normalTexture": {"index": 0}} if mapped else {}
    backend.change(scene=opened(square(tmp_path, material, [flat] if mapped else [])))
    layout = laid(backend.state.scene, ((1, 2),))
    backend.hear(layout, lit(layout, even(layout, 0.0, 0.0)))
    slanted = ((0.0, 1.0, 1.0), (0.0, 0.0, 0.0), 0.3)
    look(backend, *slanted)
    found = []
    for mirrored in ((3.0, 0.0), (0.0, 5.0)):
        of_view(backend, np.zeros((12, 12)), (0.0, 1.0, 0.0, -1.0), mirrored=mirrored)
        found.append(look(backend, *slanted).radiance[24, 24, 1].astype(float))
    a, b = (share[0] for share in reflectance(np.array([np.sqrt(0.5)]), 0.6))
    f0 = 0.5 if metallic else 0.04
    more = 1.0 + f0 * (1.0 / (a + b) - 1.0)
    assert found[0] == pytest.approx(3.0 * f0 * a * more, rel=0.02)
    assert found[1] == pytest.approx(5.0 * b * more, rel=0.02)


@pytest.mark.parametrize("edge_px", [4, 5, 6, 8, 10, 12, 16])
def test_points_farther_apart_than_texels_leave_the_light_to_the_map(backend, edge_px):
    """They leap over what the map shows: from half a texel on it mixes in, from a whole one it is
    alone."""
    count = -(-SIZE // edge_px)
    of_view(backend, np.full((count, count), 3.0), edge_px=edge_px)
    found = look(backend, *ABOVE).radiance / backend.by_map
    apart = edge_px * 2.0 * HALF_M * TEXELS_A_METRE / SIZE
    x = np.clip((apart - 0.5) / 0.5, 0.0, 1.0)
    of_map = x * x * (3.0 - 2.0 * x)
    np.testing.assert_allclose(found, 3.0 - 2.0 * of_map, rtol=1e-2)


def test_slanted_surfaces_have_the_map_where_points_lie_far_apart_along_the_view(backend):
    """As dense across as before, four times as far apart away from the eye."""
    slanted = ((0.0, 0.25, 1.0), (0.0, 0.0, 0.0), 2 * np.arctan(HALF_M / 2.0))
    for edge_px, most_of_points in ((2, True), (12, False)):
        look(backend, *slanted)
        by_map = look(backend, *slanted, still=False).radiance[24, 24, 1]
        count = -(-SIZE // edge_px)
        of_view(backend, np.full((count, count), 3.0), (0.0, 1.0, 0.0, -0.25), edge_px)
        times = look(backend, *slanted).radiance[24, 24, 1] / by_map
        assert times == pytest.approx(3.0 if most_of_points else 1.0, rel=0.02)


def test_light_of_another_view_is_not_shown(backend):
    """A camera that moved on is lit by the map, and so is a moving frame."""
    of_view(backend, np.full((12, 12), 3.0))
    finished = look(backend, *ABOVE).radiance
    assert finished.mean() == pytest.approx(3.0 * backend.by_map.mean(), rel=1e-2)
    moving = look(backend, *ABOVE, still=False).radiance
    moved = look(backend, (0.01, 1.0, 1e-3), *ABOVE[1:]).radiance
    for other in (moving, moved):
        assert other.mean() == pytest.approx(backend.by_map.mean(), rel=1e-2)


def test_a_finished_still_is_the_mean_of_eight_pictures(backend):
    """Pixels stay where they are; each row and column of an edge's pixel is sampled once."""
    before = backend.counters.done["picture"]
    of_view(backend, np.ones((12, 12)))
    finished = look(backend, *ABOVE).radiance
    assert backend.counters.done["picture"] - before == 8
    np.testing.assert_allclose(finished, backend.by_map, rtol=1e-2, atol=1e-4)


def test_what_is_cut_out_is_even_in_a_finished_still(gl_backend, tmp_path):
    """Wires that cover a quarter of each pixel: eight samples of it leave an eighth of noise.

    Had all pictures the same threshold, a pixel would be all wire or none.
    """
    backend = gl_backend(size_px=(SIZE, SIZE))
    light(backend, np.ones((6, 16, 16, 3)))
    texels = np.full((4, 1024, 4), 255, np.uint8)
    texels[..., 3] = 255 * (np.arange(1024) % 4 == 0)
    pbr = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 1.0, "baseColorTexture": {"index": 0}}
    wires = {"pbrMetallicRoughness": pbr, "alphaMode": "MASK", "doubleSided": True}
    scene = opened(square(tmp_path, wires, [texels], corners=CORNERS * 16.0))
    layout = laid(scene, ((1, 2),))
    backend.change(scene=scene)
    backend.hear(layout, lit(layout, even(layout, 1.0, 0.0)))
    above = ((0.0, 16.0, 1e-3), (0.0, 0.0, 0.0), 2 * np.arctan(0.25))
    look(backend, *above)
    of_view(backend, np.ones((12, 12)))
    finished = look(backend, *above).radiance[8:-8, 8:-8, 1]
    assert finished.mean() == pytest.approx(0.75, abs=0.03)
    assert np.abs(finished - 0.75).max() < 0.2
