"""Half precision and bytes straight from the kernel, rows alone, and what they allocate."""

import tracemalloc

import numpy as np
import pytest
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.sky import half_scale
from hypothesis import example, given
from hypothesis import strategies as st

SKY = HosekWilkieSky(3.0, 0.1, 0.7)


@given(
    st.floats(1, 10),
    st.floats(0, 1),
    st.floats(0, np.pi / 2),
    st.integers(2, 40),
    st.floats(-30, 20),
)
@example(3.0, 0.1, 0.7, 31, 27.0)
def test_halves_are_the_float32_map_rounded(turbidity, albedo, elevation, size, exponent):
    """The nearest half, ties to even, as numpy rounds; subnormal halves too (large scales)."""
    sky = HosekWilkieSky(turbidity, albedo, elevation)
    scale = 2.0 ** np.round(exponent) * half_scale(sky.brightest)
    if sky.brightest / scale > 3e4:
        scale = half_scale(sky.brightest)
    expected = (sky.cube_map(size, 1.0) / np.float32(scale)).astype(np.float16)
    halves = sky.cube_map_float16(size, 1.0, scale)
    assert halves.dtype == np.float16
    np.testing.assert_array_equal(halves, expected)


def test_values_beyond_a_half_are_clipped():
    """A scale too small must not turn the aureole into infinity."""
    assert SKY.cube_map_float16(16, 0.0, 1e-4).max() == 65504.0


@given(st.floats(1, 10), st.floats(0, 1), st.floats(0, np.pi / 2))
@example(1.0, 0.0, 0.0)
@example(10.0, 1.0, np.pi / 2)
def test_the_brightest_guess_is_within_a_factor_of_two(turbidity, albedo, elevation):
    """half_scale leaves a factor of four: no map may need more, nor waste more than a bit."""
    sky = HosekWilkieSky(turbidity, albedo, elevation)
    largest = float(sky.cube_map(64).max())
    assert 0.5 * sky.brightest <= largest <= 2.0 * sky.brightest
    assert largest / half_scale(sky.brightest) < 65504.0


@pytest.mark.parametrize("exposure", [0.005, 0.05, 1.0])
def test_bytes_follow_the_tone_curve(exposure):
    """255 (1 - exp(-exposure L)), rounded: 0.5 off, and 1e-3 for single precision."""
    exact = 255.0 * -np.expm1(-exposure * SKY.cube_map(64, 1.0).astype(float))
    mapped = SKY.cube_map_u8(64, 1.0, exposure)
    assert mapped.dtype == np.uint8
    assert np.abs(mapped - exact).max() <= 0.501


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5, 15, 16, 17, 18])
def test_groups_of_texels_leave_no_gap(size):
    """Texels are computed four at a time; every size must come out whole."""
    np.testing.assert_array_equal(
        SKY.cube_map_float16(size, 1.0), SKY.cube_map(size, 1.0).astype(np.float16)
    )


@pytest.mark.parametrize("method", ["cube_map_float16", "cube_map_u8"])
def test_encoded_faces_on_demand_in_a_given_buffer(method):
    """Faces that were not requested keep their values."""
    make = getattr(SKY, method)
    whole = make(16, 1.0)
    out = np.full_like(whole, 7)
    assert make(16, 1.0, out=out, faces=(2, 3, 5)) is out
    np.testing.assert_array_equal(out[[2, 3, 5]], whole[[2, 3, 5]])
    assert np.all(out[[0, 1, 4]] == 7)
    with pytest.raises(ValueError, match="out must be"):
        make(8, 1.0, out=out)


@pytest.mark.parametrize("rows", [(0, 16), (0, 3), (5, 11), (8, 16), (12, 13), (4, 4)])
def test_rows_alone_are_the_same_texels(rows):
    """A slice of the map costs a slice of the time; the rest of the buffer stays as it was."""
    whole = SKY.cube_map(16, 1.0)
    out = np.full_like(whole, 7.0)
    SKY.cube_map(16, 1.0, out=out, faces=(0, 2, 3, 4), rows=rows)
    inside = np.zeros(16, dtype=bool)
    inside[slice(*rows)] = True
    asked = [0, 2, 3, 4]
    np.testing.assert_array_equal(out[asked][:, inside], whole[asked][:, inside])
    assert np.all(out[asked][:, ~inside] == 7.0)
    assert np.all(out[[1, 5]] == 7.0)


@pytest.mark.parametrize("rows", [(-1, 4), (4, 17), (9, 3)])
def test_rows_that_are_not_there_are_refused(rows):
    """Outside the face a kernel would write over someone else's memory."""
    with pytest.raises(ValueError, match="rows"):
        SKY.cube_map(16, rows=rows)


def test_a_map_into_a_given_buffer_allocates_next_to_nothing():
    """256 texels: 4.7 MB of map, and less than 2 % of it in temporaries."""
    out = np.empty((6, 256, 256, 3), np.float32)
    half = np.empty((6, 256, 256, 3), np.float16)
    SKY.cube_map(256, 1.0, out=out)
    SKY.cube_map_float16(256, 1.0, out=half)
    tracemalloc.start()
    SKY.cube_map(256, 1.1, out=out)
    SKY.cube_map_float16(256, 1.1, out=half)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # The largest are the tables that stand for the formula.
    assert peak < 0.02 * out.nbytes


def test_each_channel_may_have_its_own_albedo():
    """Grass is green: three albedos give each channel the map of its own albedo alone."""
    albedos = (0.05, 0.3, 0.9)
    sky = HosekWilkieSky(3.0, albedos, 0.7)
    maps = (sky.cube_map(16), sky.cube_map_float16(16, scale=half_scale(sky.brightest)))
    for channel, albedo in enumerate(albedos):
        alone = HosekWilkieSky(3.0, albedo, 0.7)
        pair = (alone.cube_map(16), alone.cube_map_float16(16, scale=half_scale(sky.brightest)))
        for coloured, grey in zip(maps, pair, strict=True):
            np.testing.assert_array_equal(coloured[..., channel], grey[..., channel])
