"""Perez's all-weather sky and efficacies against Radiance's gendaylit, another implementation."""

import subprocess
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from weather_sky.hemisphere import horizontal, nodes
from weather_sky.perez import all_weather

# Direct normal and diffuse horizontal irradiance, W m^-2, and the sun's elevation: one for each of
# the eight kinds of sky, and a low sun.
WEATHERS = [(5, 150, 40), (30, 200, 40), (90, 240, 45), (200, 280, 50), (300, 200, 35),
            (450, 150, 40), (600, 110, 40), (850, 80, 55), (300, 60, 12)]  # fmt: skip
# gendaylit takes a sun that is given by its angles for that of the first of January.
DAY = 1
# Solid angle of gendaylit's sun.
SUN_SR = 2 * np.pi * (1 - np.cos(np.radians(0.2665)))


def gendaylit(direct, diffuse, elevation_deg):
    """Its sun's luminance, and the ten arguments of perezlum.cal, in lumens."""
    if (found := find_spec("pyradiance")) is None:
        pytest.skip("gendaylit (the wheel pyradiance) is not installed")
    program = Path(found.origin).parent / "bin" / "gendaylit"
    asked = [str(v) for v in ("-ang", elevation_deg, 0, "-W", direct, diffuse, "-O", 2)]
    said = subprocess.run([program, *asked], capture_output=True, text=True, check=True).stdout
    numbers = [line.split() for line in said.splitlines() if not line.startswith("#")]
    sun = next(float(line[1]) for line in numbers if line[:1] == ["3"])
    (sky,) = ([float(n) for n in line[1:]] for line in numbers if line[:1] == ["10"])
    return sun, sky


@pytest.mark.parametrize(("direct", "diffuse", "elevation_deg"), WEATHERS)
def test_shape_is_that_of_gendaylit(direct, diffuse, elevation_deg):
    """Above 15 degrees: 1e-4 of its luminance at most, also beside the sun, each over its sum."""
    zenith = np.radians(90 - elevation_deg)
    _, (_, _, a, b, c, d, e, *_) = gendaylit(direct, diffuse, elevation_deg)
    at = nodes(48)
    cosine = at.cos_gamma(zenith)
    gamma = np.arccos(cosine)
    theirs = (1 + a * np.exp(b / at.cos_zenith)) * (1 + c * np.exp(d * gamma) + e * cosine**2)
    sky = all_weather(direct, diffuse, zenith, DAY).distribution()
    ours = sky.relative_luminance(at.cos_zenith, cosine)
    seen = at.cos_zenith > np.sin(np.radians(15))
    ratio = (ours / (ours @ at.weight))[seen] / (theirs / (theirs @ at.weight))[seen]
    assert np.abs(ratio - 1).max() < 1e-4


@pytest.mark.parametrize(("direct", "diffuse", "elevation_deg"), WEATHERS)
def test_lumens_are_those_of_gendaylit(direct, diffuse, elevation_deg):
    """The sun's to 0.5 %; the sky's to 3 %, since its sum over 145 patches is that far off."""
    zenith = np.radians(90 - elevation_deg)
    state = all_weather(direct, diffuse, zenith, DAY)
    sun, (scale, _, a, b, c, d, e, *_) = gendaylit(direct, diffuse, elevation_deg)
    if state.clearness > 1.065:
        assert direct * state.direct_efficacy(2.0) == pytest.approx(sun * SUN_SR, rel=5e-3)
    at = nodes(48)
    cosine = at.cos_gamma(zenith)
    theirs = (1 + a * np.exp(b / at.cos_zenith)) * (
        1 + c * np.exp(d * np.arccos(cosine)) + e * cosine**2
    )
    total = scale * float(theirs @ at.weight)
    assert diffuse * state.diffuse_efficacy(2.0) == pytest.approx(total, rel=0.03)


def test_efficacies_agree_with_each_other():
    """What sun and sky give level ground is what Perez fitted to their sum, within 6 %."""
    for direct, diffuse, elevation_deg in WEATHERS[:-1]:
        zenith = np.radians(90 - elevation_deg)
        state = all_weather(direct, diffuse, zenith)
        level = direct * np.cos(zenith)
        parts = level * state.direct_efficacy(2.0) + diffuse * state.diffuse_efficacy(2.0)
        whole = (level + diffuse) * state.global_efficacy(2.0)
        assert parts == pytest.approx(whole, rel=0.06)


def test_luminance_is_never_negative():
    """Over the whole range of weather, also where Perez's fit was never meant to go."""
    direct, diffuse, zenith = np.meshgrid(
        [0.0, 20.0, 200.0, 600.0, 1000.0],
        [1.0, 30.0, 200.0, 500.0],
        np.radians([0, 20, 60, 85, 95]),
    )
    sums = horizontal(all_weather(direct, diffuse, zenith).distribution(), zenith, 16)
    assert np.isfinite(sums).all()
    assert (sums > 0.0).all()
