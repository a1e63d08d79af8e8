"""Coats and glass as light transport has them: what comes back, and what passes."""

import numpy as np
import pytest
from light_transport.surfaces.surfaces import surfaces_of
from scene_stage import square
from term_stage import material

from vrut_lite.geometry.reflection import reflectance_table
from vrut_lite.geometry.thin_film import film_reflectance
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed

# Of a smooth coat, over all directions: 0.086 by Schlick.
COAT, COAT_F0 = float(reflectance_table()[0, 0, 2]), 0.04


def surfaces(folder, paint, images=()):
    return surfaces_of(packed(load_scene(square(folder, paint, images))))


@pytest.mark.parametrize("colour", [1.0, 0.5])
def test_a_pane_lets_rays_through_and_sends_back_its_coat(tmp_path, colour):
    """What passes is tinted; reflectance times opacity is what the coat reflects."""
    pane = material((colour,) * 3, transmission={"transmissionFactor": 1.0})
    found = surfaces(tmp_path, pane)
    assert found.opacity[0] == pytest.approx(1.0 - (1.0 - COAT) * colour, abs=1e-5)
    np.testing.assert_allclose(found.reflectance_rgb[0] * found.opacity[0], COAT, atol=1e-5)


def test_a_map_says_which_part_is_glass(tmp_path):
    """White all over: as without a map; black: paint that hides what is behind."""
    glass = {"transmissionFactor": 1.0, "transmissionTexture": {"index": 0}}
    paint = material((0.5,) * 3, transmission=glass)
    found = surfaces(tmp_path, paint, [np.zeros((2, 2, 3), np.uint8)])
    assert found.opacity[0] == 1.0
    np.testing.assert_allclose(found.reflectance_rgb[0], COAT + (1.0 - COAT) * 0.5, atol=1e-5)


def test_two_sides_of_a_body_take_away_what_the_body_does(tmp_path):
    """A quarter is left after the body's thickness: a half after each side, less the coats."""
    volume = {"thicknessFactor": 2.0, "attenuationDistance": 2.0, "attenuationColor": [0.25] * 3}
    body = material(transmission={"transmissionFactor": 1.0}, volume=volume)
    passing = 1.0 - surfaces(tmp_path, body).opacity[0]
    assert passing == pytest.approx((1.0 - COAT) * 0.5, abs=1e-5)


def test_white_stays_white_whatever_coats_it(tmp_path):
    """Coats of any strength and index send back with the paint all that falls on them."""
    for extensions in ({"ior": {"ior": 2.0}}, {"clearcoat": {"clearcoatFactor": 1.0}}):
        found = surfaces(tmp_path, material(roughness=0.4, **extensions))
        np.testing.assert_allclose(found.reflectance_rgb[0], 1.0, atol=1e-5)


def test_no_specular_reflection_leaves_the_paint_alone(tmp_path):
    """A factor of 0 takes the coat away, at grazing angles too."""
    paint = material((0.5,) * 3, specular={"specularFactor": 0.0})
    np.testing.assert_allclose(surfaces(tmp_path, paint).reflectance_rgb[0], 0.5, atol=1e-5)


@pytest.mark.parametrize("metal", [True, False])
def test_a_thin_film_colours_what_is_sent_back(tmp_path, metal):
    """As the mean of its reflectance over the hemisphere; of a coat's channels the brightest, to
    which the others keep their proportion alone."""
    film = {"iridescenceFactor": 1.0, "iridescenceThicknessMaximum": 350.0}
    own = 0.5 if metal else COAT_F0
    paint = material((own if metal else 0.0,) * 3, 0.0, float(metal), iridescence=film)
    found = surfaces(tmp_path, paint).reflectance_rgb[0]
    mu = (np.arange(400) + 0.5) / 400
    expected = 2.0 * np.mean(film_reflectance(mu, own, 1.3, 350.0) * mu[:, None], axis=0)
    assert np.ptp(expected) > 0.01
    if metal:
        np.testing.assert_allclose(found, expected, rtol=0.03)
    else:
        assert found.max() == pytest.approx(expected.max(), rel=0.03)
        assert np.argmax(found) == np.argmax(expected)
