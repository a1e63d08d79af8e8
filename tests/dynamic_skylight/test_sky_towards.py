"""The fast sky in any directions against the float64 model and the cube map."""

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from exact_cube import angles_to, assert_texels_agree, world_sun
from hypothesis import example, given
from hypothesis import strategies as st

from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.panorama import lat_long_directions

SKY = HosekWilkieSky(3.0, 0.1, 0.7)


@given(
    st.floats(1, 10),
    st.floats(0, 1),
    st.floats(0, np.pi / 2),
    st.floats(-7, 7),
    st.integers(0, 2**32 - 1),
)
@example(1.0, 0.0, 0.0, 0.0, 1)
@example(10.0, 1.0, np.pi / 2, 0.0, 2)
def test_directions_have_the_models_radiance(turbidity, albedo, elevation, azimuth, seed):
    """A panorama's pixels may err by no more than a cube map's texels, also about the sun."""
    sky = HosekWilkieSky(turbidity, albedo, elevation)
    sun = world_sun(azimuth, elevation)
    random = np.random.default_rng(seed)
    # Half of them within some degrees of the sun and of the point opposite.
    towards = random.normal(size=(600, 3))
    towards[:200] = sun + 0.05 * towards[:200]
    towards[200:300] = -sun + 0.05 * towards[200:300]
    towards /= np.linalg.norm(towards, axis=-1, keepdims=True)
    exact = np.where(towards[:, 1:2] >= 0.0, sky.radiance(*angles_to(towards, sun)), 0.0)
    lengths = random.uniform(1e-3, 1e3, (600, 1))
    assert_texels_agree(sky.radiance_towards(lengths * towards, azimuth), exact)


def test_texels_are_those_of_the_cube_map():
    """One sky, whichever way it is asked for: a cube's texels are directions too."""
    cube = SKY.cube_map(32, 1.0)
    found = SKY.radiance_towards(texel_directions(32), 1.0)
    np.testing.assert_allclose(found, cube, rtol=2e-5, atol=1e-6 * cube.max())


@pytest.mark.parametrize("height", [1, 2, 9, 16])
def test_a_panorama_keeps_its_shape_and_is_dark_below(height):
    """Blocks of directions and groups of four leave no gap at any number of pixels."""
    whole = SKY.radiance_towards(lat_long_directions(height), 1.0)
    assert whole.shape == (height, 2 * height, 3)
    assert not whole[(height + 1) // 2 :].any()
    one_by_one = [SKY.radiance_towards(d, 1.0) for d in lat_long_directions(height).reshape(-1, 3)]
    np.testing.assert_array_equal(whole.reshape(-1, 3), one_by_one)


@pytest.mark.parametrize(
    "directions", [[[0, 1, 0], [0, 0, 0]], [[0, np.nan, 0]], [0, 1], [1e30] * 3]
)
def test_what_is_no_direction_is_refused(directions):
    """It would come out as a colour of nowhere."""
    with pytest.raises(ValueError, match="directions"):
        SKY.radiance_towards(directions)
