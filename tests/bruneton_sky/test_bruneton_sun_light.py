"""The sun as a light: transmittance, colour, horizon, limb."""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky import Atmosphere
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.sun_light import (
    limb_darkening,
    limb_darkening_rgb,
    seen_irradiance_rgb,
    sun_irradiance,
    sun_irradiance_rgb,
)

from vrut_lite.geometry.colour import rgb_from_spectrum


def test_above_the_air_the_sun_is_whole() -> None:
    """At the top of the atmosphere the solar spectrum itself arrives, with the sun's exponent."""
    earth = Atmosphere.earth()
    outside = sun_irradiance_rgb(earth, earth.top_altitude_m, 0.5, 1.0)
    expected = rgb_from_spectrum(earth.solar_irradiance, earth.wavelength_nm, 0.0)
    assert outside == pytest.approx(expected, rel=1e-12)


def test_overhead_sun_passes_one_column() -> None:
    """Bouguer's law with the vertical optical depth of Earth's numbers, written out here."""
    column_r, column_m = 8000.0 * -np.expm1(-7.5), 1200.0 * -np.expm1(-50.0)
    depth = (
        np.array([5.80234e-6, 1.355776e-5, 3.310001e-5]) * column_r
        + 4.44e-6 * column_m
        + np.array([6.497e-7, 1.8809e-6, 8.502e-8]) * 15_000.0
    )
    expected = np.array([1.474, 1.8504, 1.91198]) * np.exp(-depth)
    assert sun_irradiance(Atmosphere.earth(), 0.0, 1.0) == pytest.approx(expected, rel=1e-8)


def test_sun_fades_through_the_horizon_without_a_jump() -> None:
    """Below the horizon the horizon's transmittance holds; the disc fraction takes it to zero."""
    earth = Atmosphere.earth()
    mu_s = np.array([1e-6, 0.0, -1e-6, -0.004])
    light = np.array([sun_irradiance(earth, 0.0, float(m)) for m in mu_s])
    assert light[1] == pytest.approx(light[0], rel=1e-3)
    assert np.array_equal(light[1], light[3])
    assert not sun_irradiance_rgb(earth, 0.0, -0.01, 0.0).any()


@pytest.mark.parametrize("polynomial", limb_darkening_rgb())
def test_limb_darkening_averages_to_one(polynomial: tuple[float, ...]) -> None:
    """The mean over the disc is 1, integrated numerically; the limb is darker and not negative."""
    radius = (np.arange(20_000) + 0.5) / 20_000
    profile = np.polynomial.polynomial.polyval(np.sqrt(1.0 - radius**2), polynomial)
    assert (2.0 * radius * profile).mean() == pytest.approx(1.0, abs=1e-5)
    assert (np.diff(profile) < 0).all()
    assert 0.1 < profile[-1] / profile[0] < 0.5


@pytest.mark.parametrize(("nm", "disc_over_centre"), [(440, 0.76), (560, 0.81), (720, 0.85)])
def test_limb_darkening_strength(nm: float, disc_over_centre: float) -> None:
    """Disc mean over centre of Hosek and Wilkie's independent data set, to its two digits."""
    assert 1.0 / limb_darkening(nm).sum() == pytest.approx(disc_over_centre, abs=0.011)


@pytest.mark.parametrize("height_m", [3e6, 4e8])
def test_from_space_the_sun_is_whole_until_the_planet_hides_it(height_m: float) -> None:
    """Outside the air nothing is lost; behind the planet's middle nothing is left; when its limb
    cuts the disc, less than half, for the lower air takes its part."""
    air = Atmosphere.earth()
    whole = rgb_from_spectrum(np.asarray(air.solar_irradiance), air.wavelength_nm, 0.0)
    horizon = float(np.arccos(horizon_mu(air.ground_radius_m, height_m)))

    def seen(zenith_angle: float) -> np.ndarray:
        return seen_irradiance_rgb(air, height_m, float(np.cos(zenith_angle)))

    assert seen(0.3) == pytest.approx(whole, rel=1e-6)
    assert (seen(np.pi) == 0.0).all()
    cut = seen(horizon)
    assert (cut > 0.0).all()
    assert (cut < 0.5 * whole).all()


def test_without_air_the_sun_sets_evenly() -> None:
    """The light is the share of a round disc above the horizon, to 2e-3.

    A sun that lost 64 strips one by one would jump by up to 2 % of its light.
    """
    earth = Atmosphere.earth()
    none = dict.fromkeys(
        ("rayleigh_scattering", "mie_scattering", "mie_extinction", "absorption_extinction"), 0.0
    )
    air = replace(earth, **none)
    whole = rgb_from_spectrum(np.asarray(air.solar_irradiance), air.wavelength_nm, 0.0)
    t = np.linspace(-1.1, 1.1, 2001)
    seen = [seen_irradiance_rgb(air, 0.0, float(np.sin(h))) for h in t * air.sun_angular_radius_rad]
    inside = np.clip(t, -1.0, 1.0)
    share = 0.5 + (inside * np.sqrt(1.0 - inside**2) + np.arcsin(inside)) / np.pi
    assert seen / whole == pytest.approx(np.repeat(share[:, None], 3, axis=1), abs=2e-3)
    assert np.abs(np.diff(seen / whole, axis=0)).max() < 2.0 / np.pi * (t[1] - t[0]) * 1.05
