"""Spectra of grounds against published albedos and colours."""

import numpy as np
import pytest

from vrut_lite.atmosphere.ground_reflectance import GREY, GROUNDS, GroundReflectance
from vrut_lite.geometry.colour import colour_table

# Luminous albedo: grass by Feister and Grewe 1995 at 550 nm and Bowker et al. 1985, dry soil and
# sand by Bowker et al. 1985, paving by Herold et al. 2004, fresh snow by Grenfell et al. 1994, the
# sea by Payne 1972 and Jin et al. 2004.
PUBLISHED = {
    "grass": (0.06, 0.10),
    "soil": (0.10, 0.25),
    "sand": (0.20, 0.35),
    "paving": (0.08, 0.20),
    "snow": (0.90, 0.99),
    "water": (0.03, 0.065),
}
# Channels by their albedo, the largest first.
HUES = {
    "grass": "grb", "soil": "rgb", "sand": "rgb", "paving": "rgb", "snow": "bgr", "water": "bgr",
}  # fmt: skip


@pytest.mark.parametrize("name", GROUNDS)
def test_grounds_are_as_bright_and_as_coloured_as_measured(name):
    """Luminous albedo lies in the published range, and the channels have the measured order."""
    ground = GroundReflectance.named(name)
    low, high = PUBLISHED[name]
    assert low <= ground.albedo <= high
    assert "".join("rgb"[c] for c in np.argsort(ground.rgb)[::-1]) == HUES[name]
    assert 0.0 < min(ground.values) <= max(ground.values) < 1.0


def test_grass_is_green_and_bright_beyond_red():
    """Chlorophyll leaves a peak at 550 nm and a steep edge at 700 nm."""
    nm = np.arange(450.0, 690.0)
    grass = GroundReflectance.named("grass")
    assert nm[np.argmax(grass.at(nm))] == pytest.approx(555.0, abs=10.0)
    assert grass.at(780.0) > 10.0 * grass.at(680.0)


@pytest.mark.parametrize("rgb", [(0.1, 0.2, 0.05), (0.4, 0.3, 0.2), (0.8, 0.75, 0.7), (0.02,) * 3])
def test_a_colour_has_a_spectrum_that_shows_it(rgb):
    """The disc then continues the scene's border without an edge."""
    ground = GroundReflectance.of_rgb(rgb)
    np.testing.assert_allclose(ground.rgb, rgb, rtol=1e-6)
    assert np.abs(np.diff(ground.values)).max() < 0.07 * max(rgb)


def test_a_grey_has_one_number_at_all_wavelengths():
    """So that a sky above grey ground is the same with a spectrum and without."""
    assert GREY.rgb == (0.1, 0.1, 0.1)
    assert set(GREY.at(colour_table()[:, 0])) == {0.1}
    assert GroundReflectance.of_rgb((0.3,) * 3).at(550.0) == pytest.approx(0.3)


def test_an_albedo_scales_the_spectrum():
    """The hue stays, and no wavelength reflects more than it receives."""
    grass = GroundReflectance.named("grass").with_albedo(0.15)
    # Infrared is cut off at 1, of which the eye sees a trace.
    assert grass.albedo == pytest.approx(0.15, rel=1e-3)
    np.testing.assert_allclose(
        np.divide(grass.rgb, GroundReflectance.named("grass").rgb), 0.15 / 0.0666, rtol=1e-2
    )
    assert max(GroundReflectance.named("snow").with_albedo(1.0).values) <= 1.0
    assert GroundReflectance.grey(0.0).with_albedo(0.2).albedo == pytest.approx(0.2)
