"""Rows of large maps, whose texels take pieces of the tables in blocks of eight."""

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.cube_rows import fill_cube
from dynamic_skylight.hosek_wilkie.formula import extended_perez
from dynamic_skylight.hosek_wilkie.sky import half_scale
from exact_cube import angles_to, assert_texels_agree, twin_cube, world_sun

from vrut_lite.geometry.cube_map import texel_directions

# Blocks come in pairs of 16 texels; the last one of a row ends with it.
SIZES = (256, 257, 264, 271)
SKY = HosekWilkieSky(3.0, 0.1, 0.7)


@pytest.mark.parametrize("size", SIZES)
def test_rows_of_every_length_are_whole(size):
    """No block may leave a gap, or write into the next row."""
    assert_texels_agree(SKY.cube_map(size, 2.0), twin_cube(SKY, size, 2.0))


@pytest.mark.parametrize("turbidity", [1.0, 4.3, 10.0])
@pytest.mark.parametrize("albedo", [0.0, 1.0])
@pytest.mark.parametrize("elevation", [0.0, 0.02, 0.6, np.pi / 2])
def test_texels_of_blocks_are_the_models(turbidity, albedo, elevation):
    """The glow is steepest where a block lies about the sun; a low sun has a point opposite too."""
    sky = HosekWilkieSky(turbidity, albedo, elevation)
    assert_texels_agree(sky.cube_map(256, 0.0), twin_cube(sky, 256, 0.0))


@pytest.mark.parametrize("step", range(0, 8, 2))
def test_the_sun_may_stand_anywhere_in_a_block(step):
    """The texels around the middle of a face span the widest angles."""
    x, y, z = texel_directions(256)[5, 90, 120 + step]
    sky = HosekWilkieSky(10.0, 0.0, float(np.arcsin(y)))
    azimuth = float(np.arctan2(x, -z))
    assert_texels_agree(sky.cube_map(256, azimuth), twin_cube(sky, 256, azimuth))


@pytest.mark.parametrize("elevation", [-0.01, -0.2, -np.pi / 2])
def test_a_sun_below_the_horizon_has_its_point_opposite_in_the_sky(elevation):
    """At twilight the glow's kink opposite the sun is in the map."""
    numbers = SKY.rgb_distribution, SKY.rgb_mean_radiance
    cube = fill_cube(*numbers, 0.4, elevation, 256, None, tuple(range(6)))
    direction = texel_directions(256)
    _, gamma = angles_to(direction, world_sun(0.4, elevation))
    up = direction[..., 1]
    exact = extended_perez(np.maximum(up, 0.0), gamma, numbers[0]) * numbers[1]
    assert_texels_agree(cube, np.where(up[..., None] > 0.0, np.maximum(exact, 0.0), 0.0))


@pytest.mark.parametrize(
    "sky", [SKY, HosekWilkieSky(1.0, 0.0, 0.0), HosekWilkieSky(10.0, 0.0, 0.0)]
)
def test_no_light_of_blocks_is_negative(sky):
    """The fit dips below zero; light cannot."""
    cube = sky.cube_map(256, 1.0)
    assert np.isfinite(cube).all()
    assert cube.min() >= 0.0


@pytest.mark.parametrize("size", [256, 263])
def test_encoded_blocks_are_the_float32_map(size):
    """Halves are rounded as numpy does, bytes follow the tone curve."""
    cube, scale = SKY.cube_map(size, 1.0), half_scale(SKY.brightest)
    expected = (cube / np.float32(scale)).astype(np.float16)
    np.testing.assert_array_equal(SKY.cube_map_float16(size, 1.0, scale), expected)
    exact = 255.0 * -np.expm1(-0.05 * cube.astype(float))
    assert np.abs(SKY.cube_map_u8(size, 1.0) - exact).max() <= 0.501


@pytest.mark.parametrize("rows", [(0, 257), (3, 5), (100, 140), (128, 129), (200, 257)])
def test_faces_and_rows_alone_are_the_same_texels(rows):
    """No texel may depend on what else is computed, nor touch what is not asked for."""
    whole = SKY.cube_map(257, 1.0)
    out = np.full_like(whole, 7.0)
    SKY.cube_map(257, 1.0, out=out, faces=(0, 2, 3, 4), rows=rows)
    inside = np.zeros(257, dtype=bool)
    inside[slice(*rows)] = True
    asked = [0, 2, 3, 4]
    np.testing.assert_array_equal(out[asked][:, inside], whole[asked][:, inside])
    assert np.all(out[asked][:, ~inside] == 7.0)
    assert np.all(out[[1, 5]] == 7.0)


def test_no_seam_between_faces():
    """Along an edge the two faces' texels differ as much as neighbours within a face."""
    cube = HosekWilkieSky(6.0, 0.2, 0.5).cube_map(256, 0.785).astype(float)
    # The columns of +X and +Z at their common edge, above the horizon, and those next to them.
    edge = np.stack([cube[4, :120, -2:], cube[0, :120, 1::-1]])
    across = np.abs(edge[0, :, 1] - edge[1, :, 1])
    within = np.abs(edge[:, :, 1] - edge[:, :, 0]).max()
    assert across.max() <= 1.5 * within
