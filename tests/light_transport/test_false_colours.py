"""The light map in false colours: what is brighter, wider or noisier has the brighter colour."""

import msgspec
import numpy as np
import pytest
from light_stage import COARSE, WANT, LightStage, Shine, Show, box_file, layouts, lights
from light_transport.false_colours import density_picture, error_picture, light_picture

from vrut_lite.array import Array
from vrut_lite.geometry.colour import LUMENS_PER_WATT
from vrut_lite.geometry.false_colours import UNUSED, coloured, scale_of
from vrut_lite.messages.scene import SceneOpened


def test_a_scale_from_0_has_even_steps_and_a_colour_of_0():
    """Hours of sun: a room without any is not coloured as the least that others have."""
    hours = np.array([0.0, 2.0, 4.0, np.nan])
    scale = scale_of(hours, from_zero=True)
    assert [scale.at(share) for share in (0.0, 0.5, 1.0)] == [0.0, 2.0, 4.0]
    none, middle, most, unknown = coloured(hours, scale)
    ends = coloured(np.array([1.0, 10.0]), scale_of(np.array([1.0, 10.0])))
    np.testing.assert_array_equal([none, most], ends)
    assert none[1] < middle[1] < most[1]
    np.testing.assert_array_equal(unknown, UNUSED)


@pytest.fixture
def lit(tmp_path):
    """The layout, the light of each round, and the scene: a cube of 2 m under a sky of 1."""
    stage = LightStage()
    said = stage.tell(*COARSE, Shine(radiance=1.0), WANT, Show(path=str(box_file(tmp_path))))
    yield layouts(said)[0], lights(said), stage.kernel.last(SceneOpened)
    stage.kernel.close()


def test_light_is_shown_in_lux(lit):
    """The top of a box under a white sky has pi times its radiance, and is the brightest."""
    laid, rounds, _ = lit
    shown = light_picture(rounds[-1])
    assert shown.pixels.shape == (*laid.size_px[::-1], 3)
    assert shown.high == pytest.approx(np.pi * LUMENS_PER_WATT, rel=0.02)
    values = rounds[-1].texels.values[..., 1].astype(float)
    assert shown.pixels[values > 0.95 * values.max()].astype(int).sum(axis=-1).min() > 400
    assert np.all(shown.pixels[values == 0.0] == 24)


def test_texels_are_as_wide_as_the_setting_says(lit):
    """Half a metre was asked for; every used texel of the box has about that."""
    laid, _, scene = lit
    shown = density_picture(laid, scene)
    assert 0.35 < shown.low <= shown.high < 0.51
    assert np.count_nonzero((shown.pixels != 24).any(axis=-1)) >= 6 * 16


def test_the_error_is_the_noise_that_the_rays_leave(lit):
    """Equal light has none; a tenth less by half the rays has a tenth, by a fifth half of it."""
    _, rounds, _ = lit
    last = rounds[-1]
    darker = Array((last.texels.values.astype(np.float32) * 0.9).astype(np.float16))
    for share, texels, noise in (
        (2, last.texels, 0.0),
        (2, darker, 0.1),
        (5, darker, 0.05),
    ):
        fewer = msgspec.structs.replace(last, texels=texels, rays=last.rays // share)
        assert error_picture(last, fewer).high == pytest.approx(noise, rel=0.05)


def test_a_map_without_light_has_a_picture_too(lit):
    """Night is no error."""
    last = lit[1][-1]
    dark = msgspec.structs.replace(last, texels=Array(np.zeros_like(last.texels.values)))
    assert light_picture(dark).high == 0.0
