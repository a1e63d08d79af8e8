"""The fifteen skies of CIE S 011 and the traditional overcast, against the standard's formulas."""

import math

import numpy as np
import pytest
from weather_sky.hemisphere import horizontal

from vrut_lite.atmosphere.cie_skies import OVERCAST, TYPES, general_sky

# Gradation group and indicatrix group of each type, as the standard numbers them.
GROUPS = ["I1", "I2", "II1", "II2", "III1", "III2", "III3", "III4", "IV2", "IV3", "IV4", "V4",
          "V5", "VI5", "VI6"]  # fmt: skip
GRADATIONS = {"I": (4.0, -0.7), "II": (1.1, -0.8), "III": (0.0, -1.0), "IV": (-1.0, -0.55),
              "V": (-1.0, -0.32), "VI": (-1.0, -0.15)}  # fmt: skip
INDICATRICES = {"1": (0, -1.0, 0.0), "2": (2, -1.5, 0.15), "3": (5, -2.5, 0.3),
                "4": (10, -3.0, 0.45), "5": (16, -3.0, 0.3), "6": (24, -2.8, 0.15)}  # fmt: skip


def over_zenith(number, zenith, azimuth, sun_zenith):
    """Luminance over the zenith's by the standard's equations 1 to 7, one direction at a time."""
    group = GROUPS[number - 1]
    a, b = GRADATIONS[group[:-1]]
    c, d, e = INDICATRICES[group[-1]]

    def gradation(z):
        return 1.0 + a * math.exp(b / math.cos(z))

    def indicatrix(chi):
        scattered = math.exp(d * chi) - math.exp(d * math.pi / 2)
        return 1.0 + c * scattered + e * math.cos(chi) ** 2

    chi = math.acos(
        math.cos(sun_zenith) * math.cos(zenith)
        + math.sin(sun_zenith) * math.sin(zenith) * math.cos(azimuth)
    )
    return indicatrix(chi) * gradation(zenith) / (indicatrix(sun_zenith) * gradation(0.0))


@pytest.mark.parametrize("number", range(1, TYPES + 1))
def test_general_skies_are_the_standards(number):
    """Ratios to the zenith, over the sky and for three suns, to rounding."""
    sky = general_sky(number)
    for sun in (0.2, 0.8, 1.4):
        zenith = sky.relative_luminance(1.0, math.cos(sun))
        for z in (0.0, 0.5, 1.1, 1.5):
            for azimuth in (0.1, 1.2, 3.0):
                gamma = math.cos(sun) * math.cos(z) + math.sin(sun) * math.sin(z) * math.cos(
                    azimuth
                )
                ours = sky.relative_luminance(math.cos(z), gamma) / zenith
                assert ours == pytest.approx(over_zenith(number, z, azimuth, sun), rel=1e-9)


def test_published_ratios():
    """Of an overcast sky the horizon has a third of the zenith's luminance, a uniform one has all.

    Level ground below Moon and Spencer's sky gets 7 pi / 9 of the zenith's luminance.
    """
    assert OVERCAST.relative_luminance(0.0, 0.3) == pytest.approx(1 / 3)
    assert horizontal(OVERCAST, 1.0) == pytest.approx(7 * np.pi / 9, rel=1e-6)
    assert horizontal(general_sky(5), 1.0) == pytest.approx(np.pi, rel=1e-9)
    first = general_sky(1)
    ratio = first.relative_luminance(0.0, 0.3) / first.relative_luminance(1.0, 0.3)
    assert ratio == pytest.approx(1 / (1 + 4 * math.exp(-0.7)), rel=1e-6)
    # Near enough to the old sky that the standard puts it in the old one's place.
    assert ratio == pytest.approx(1 / 3, abs=0.01)
