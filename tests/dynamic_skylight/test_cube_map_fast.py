"""The fast cube map against the float64 model, and its orientation."""

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from exact_cube import assert_texels_agree, twin_cube, world_sun
from hypothesis import example, given
from hypothesis import strategies as st

from vrut_lite.geometry.cube_map import texel_directions


@given(
    st.floats(1, 10), st.floats(0, 1), st.floats(0, np.pi / 2), st.floats(-7, 7), st.integers(2, 40)
)
@example(1.0, 0.0, 0.0, 0.0, 32)
@example(10.0, 1.0, np.pi / 2, 0.0, 31)
@example(2.5, 0.1, 0.0, 3.0, 32)
def test_fast_texels_are_the_models(turbidity, albedo, elevation, azimuth, size):
    """Tables in single precision may cost 1e-5 of max(value, 1 % of the maximum)."""
    sky = HosekWilkieSky(turbidity, albedo, elevation)
    assert_texels_agree(sky.cube_map(size, azimuth), twin_cube(sky, size, azimuth))


@pytest.mark.parametrize("turbidity", [1.0, 3.0, 10.0])
def test_a_sun_in_the_middle_of_a_texel_is_not_blurred(turbidity):
    """Where gamma = 0 a cosine would lose the angle; the chord keeps the aureole to 1e-5."""
    directions = texel_directions(16).reshape(-1, 3)
    for x, y, z in directions[directions[:, 1] > 0][::23]:
        sky = HosekWilkieSky(turbidity, 0.1, float(np.arcsin(y)))
        azimuth = float(np.arctan2(x, -z))
        assert_texels_agree(sky.cube_map(16, azimuth), twin_cube(sky, 16, azimuth))


@pytest.mark.parametrize(
    ("azimuth_deg", "face"), [(0.0, 5), (90.0, 0), (180.0, 4), (270.0, 1)], ids=list("NESW")
)
def test_the_brightest_texel_looks_at_the_sun(azimuth_deg, face):
    """North is -Z, east +X (DESIGN conventions): in thick haze the sun's place is brightest."""
    azimuth, elevation = np.radians(azimuth_deg), np.radians(40.0)
    cube = HosekWilkieSky(10.0, 0.1, elevation).cube_map(64, azimuth)
    brightest = np.unravel_index(np.argmax(cube[..., 1]), cube.shape[:3])
    assert brightest[0] == face
    texel = 2.0 / 64
    offset = texel_directions(64)[brightest] - world_sun(azimuth, elevation)
    assert np.linalg.norm(offset) < texel


def test_a_given_buffer_is_written_in_place_and_below_the_horizon_cleared():
    """`out` saves the allocation; nothing old may shine through from below."""
    sky = HosekWilkieSky(3.0, 0.1, 0.8)
    out = np.full((6, 16, 16, 3), 7.0, np.float32)
    assert sky.cube_map(16, 1.0, out=out) is out
    np.testing.assert_array_equal(out, sky.cube_map(16, 1.0))
    assert not out[3].any()
    assert not out[[0, 1, 4, 5], 8:].any()


def test_only_the_faces_asked_for_are_computed():
    """A scene that sees two faces pays for two; they are the same texels."""
    sky = HosekWilkieSky(3.0, 0.1, 0.8)
    whole = sky.cube_map(16, 1.0)
    out = np.full_like(whole, 7.0)
    sky.cube_map(16, 1.0, out=out, faces=(2, 5))
    np.testing.assert_array_equal(out[[2, 5]], whole[[2, 5]])
    assert np.all(out[[0, 1, 3, 4]] == 7.0)


@pytest.mark.parametrize(
    "out",
    [
        np.empty((6, 8, 8, 3), np.float32),
        np.empty((6, 16, 16, 3)),
        np.empty((6, 16, 16, 6), np.float32)[..., ::2],
    ],
)
def test_an_unfit_buffer_is_refused(out):
    """A wrong size, type or stride would be written as nonsense."""
    with pytest.raises(ValueError, match="out must be"):
        HosekWilkieSky(3.0, 0.1, 0.8).cube_map(16, out=out)


def test_an_unknown_face_is_refused():
    """Faces are 0 to 5."""
    with pytest.raises(ValueError, match="faces"):
        HosekWilkieSky(3.0, 0.1, 0.8).cube_map(16, faces=(0, 6))
