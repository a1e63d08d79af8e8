"""Fisheye pictures and their scales of colour."""

import numpy as np
import pytest

from vrut_lite_lab.study.framework import colour_scales, fisheye


def test_north_is_at_the_bottom_and_east_on_the_right():
    """The outermost pixels are there; the zenith is in the middle."""
    at = fisheye.pixels(256)
    azimuth = np.full((256, 256), np.nan)
    azimuth[at.rows, at.columns] = np.degrees(at.azimuth_rad)
    # Half a pixel beside the axis, 1 / 255 of the radius.
    assert min(azimuth[255, 128], 360.0 - azimuth[255, 128]) < 0.3
    assert abs(azimuth[128, 255] - 90.0) < 0.3
    assert abs(azimuth[0, 128] - 180.0) < 0.3
    assert abs(azimuth[128, 0] - 270.0) < 0.3


def test_zenith_angle_grows_evenly():
    """The pixel's distance from the middle, in radii, is its zenith angle in right angles."""
    at = fisheye.pixels(64)
    distance = np.hypot(at.columns - 31.5, at.rows - 31.5) / 32.0
    np.testing.assert_allclose(at.zenith_rad, distance * np.pi / 2, rtol=1e-12)
    assert at.zenith_rad.max() < np.pi / 2
    assert abs(at.rows.size - np.pi * 32.0**2) < 0.01 * np.pi * 32.0**2


@pytest.mark.parametrize("size", [64, 256])
def test_a_direction_is_found_in_its_pixel(size):
    """`position` goes back from angles to the pixel, to one beside it: it cuts, as published."""
    at = fisheye.pixels(size)
    for k in range(0, at.rows.size, 97):
        row, column = fisheye.position(size, at.zenith_rad[k], at.azimuth_rad[k])
        assert abs(row - at.rows[k]) <= 1
        assert abs(column - at.columns[k]) <= 1


def test_pictures_show_colours_and_marks():
    """Fractions are cut to bytes; the sun is a red cross, each direction a dot of 25 % black."""
    at = fisheye.pixels(64)
    painted = fisheye.picture(at, np.full((at.rows.size, 3), 0.5))
    assert painted.dtype == np.uint8
    assert tuple(painted[32, 32]) == (127, 127, 127)
    assert tuple(painted[0, 0]) == (255, 255, 255)
    fisheye.mark(painted, np.pi / 4, np.pi / 2)
    row, column = fisheye.position(64, np.pi / 4, np.pi / 2)
    red = (painted == [255, 0, 0]).all(axis=-1)
    assert red[row, column - 5 : column + 6].all()
    assert red.sum() <= 21
    assert (painted == int(127 * (1 - 64 / 255))).all(axis=-1).any()


@pytest.mark.parametrize(("zenith_rad", "is_drawn"), [(np.pi / 2, True), (1.7, False)])
def test_the_sun_is_drawn_down_to_the_horizon(zenith_rad, is_drawn):
    """Whatever its azimuth; below the horizon there is none to draw."""
    at = fisheye.pixels(64)
    for azimuth in np.linspace(0.0, 6.0, 9):
        painted = fisheye.picture(at, np.zeros((at.rows.size, 3)))
        fisheye.mark(painted, zenith_rad, azimuth)
        assert (painted == [255, 0, 0]).all(axis=-1).any() == is_drawn


def test_luminance_has_nine_steps_per_decade():
    """A step holds from one multiple of a power of ten to the next; the ends are marked."""
    scale = colour_scales.luminance_scale()
    assert scale.shape == (54, 3)
    assert len(np.unique(scale, axis=0)) == 54
    for decade in range(6):
        for step in range(1, 10):
            value = step * 10.0**decade
            inside = colour_scales.luminance_colours([value, 0.999 * (value + 10.0**decade)])
            np.testing.assert_array_equal(inside, [scale[9 * decade + step - 1]] * 2)
    assert tuple(colour_scales.luminance_colours(0.99)) == (255, 0, 0)
    assert tuple(colour_scales.luminance_colours(np.nan)) == (255, 0, 0)
    assert tuple(colour_scales.luminance_colours(1e6)) == (255, 255, 0)


def test_decades_grow_paler():
    """Within each decade every step is lighter than the one before."""
    lightness = colour_scales.luminance_scale().astype(float) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(lightness.reshape(6, 9), axis=1) > 0).all()


def test_errors_have_steps_of_ten_percent_around_white():
    """Blue below, red above, the middle the lightest; held beyond 200 %."""
    scale = colour_scales.error_scale()
    assert scale.shape == (41, 3)
    for step in range(-20, 21):
        both = colour_scales.error_colours([step / 10.0, step / 10.0 + 0.09])
        np.testing.assert_array_equal(both, [scale[step + 20]] * 2)
    np.testing.assert_array_equal(colour_scales.error_colours([-9.0, 9.0]), scale[[0, -1]])
    assert scale[20].min() > 240
    assert scale[0, 2] > scale[0, 0]
    assert scale[-1, 0] > scale[-1, 2]
