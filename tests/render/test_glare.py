"""Glare around what is bright: CIE's function, the light kept, and none where none is asked for."""

import numpy as np
import pytest

from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures.display import developed
from vrut_lite.pictures.glare import scattered, with_glare

PIXEL = np.radians(0.08)


def lamp(height=61, width=91, radiance=1e4):
    """A picture, dark but for one pixel in its middle."""
    picture = np.zeros((height, width, 3), np.float32)
    picture[height // 2, width // 2] = radiance
    return picture


def test_the_veil_is_cies():
    """Beside a lamp of a pixel the veil is its illuminance times CIE's function, written out here
    for an age of 25 years and p = 0.5, at 0.4 to 3.2 degrees to 1 %."""
    veil = with_glare(lamp(), 1.0, PIXEL)[30, 45:, 0]
    illuminance = 1e4 * PIXEL**2
    for pixels in (5, 10, 20, 40):
        theta = 0.08 * pixels
        cie = 10 / theta**3 + (5 / theta**2 + 0.05 / theta) * 1.0256 + 0.00125
        assert veil[pixels] == pytest.approx(illuminance * cie, rel=0.01)


def test_light_is_neither_made_nor_lost():
    """The sum stays, wherever the light is; what lies at an edge loses no more than it scatters to
    pixels of the picture."""
    random = np.random.default_rng(2)
    picture = np.exp(random.uniform(-8.0, 8.0, (40, 64, 3)))
    shown = with_glare(picture, 0.7, PIXEL)
    assert shown.sum() == pytest.approx(picture.sum(), rel=1e-9)
    assert shown.min() > 0.0


def test_an_even_picture_has_no_glare():
    """Not at its edges either."""
    picture = np.full((40, 64, 3), 7.0)
    np.testing.assert_allclose(with_glare(picture, 1.0, PIXEL), picture, rtol=1e-9)


def test_the_sum_by_transforms_is_the_sum_over_pixels():
    """The quick way against the plain one, a sun a million times as bright as the sky included."""
    random = np.random.default_rng(3)
    picture = np.exp(random.uniform(-1.0, 1.0, (12, 17, 3)))
    picture[3, 4] = 1e7
    y, x = np.indices((12, 17))
    within = (np.arange(9) + 0.5) / 9 - 0.5
    plain = picture.copy()
    for i, j in np.ndindex(12, 17):
        down, across = (
            np.abs(offset)[..., None, None] + part
            for offset, part in zip((y - i, x - j), np.meshgrid(within, within), strict=True)
        )
        angle = np.degrees(np.hypot(down, across) * PIXEL)
        fine = scattered(angle).mean(axis=(-2, -1)) * PIXEL**2
        centre = scattered(np.degrees(np.hypot(y - i, x - j) * PIXEL)) * PIXEL**2
        share = np.where(np.maximum(abs(y - i), abs(x - j)) <= 2, fine, centre)
        share[i, j] = 0.0
        plain += share[..., None] * picture[i, j]
        plain[i, j] -= share.sum() * picture[i, j]
    np.testing.assert_allclose(with_glare(picture, 1.0, PIXEL), plain, rtol=1e-6)


def test_glare_changes_what_is_shown_and_no_number():
    """A picture's radiance, by which EXR and cd/m2 go, and its exposure are those without glare."""
    plain, veiled = (
        developed(lamp() + np.float32(1e-3), SetExposure(glare=glare), PIXEL) for glare in (0, 1)
    )
    np.testing.assert_array_equal(plain.radiance, veiled.radiance)
    assert plain.ev100 == veiled.ev100
    assert veiled.display[30, 50].mean() > plain.display[30, 50].mean() + 20
