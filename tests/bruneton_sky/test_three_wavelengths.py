"""Colour from three and four wavelengths against the CIE integral over forty.

Three cannot know what ozone takes between them; four with a fitted matrix can.

The error of a channel is its difference over the luminance of the same direction, in percent:
in twilight blue passes through zero, and an error of its own value would say nothing. Means
are over the sky's solid angle from the zenith down to 2.5 degrees above the horizon. Forty
wavelengths themselves differ from the whole spectrum by up to 1.2 %.
"""

from collections.abc import Callable

import numpy as np
import pytest
from bruneton_sky import Atmosphere, single_scattering
from bruneton_sky.presets import COLOUR_NM, RGB_NM, earth_spectral, earth_standard
from numpy.typing import NDArray

from vrut_lite.geometry.colour import SKYLIGHT_NM, luminance, rgb_from_spectrum

FORTY_NM = np.linspace(360.0, 720.0, 40)
ELEVATIONS_DEG = (60.0, 30.0, 10.0, 3.0, 0.0)
# Per elevation the mean of red, green, blue, luminance, then the largest of each, in percent.
CLEAR_AT_RGB_NM = [
    [2.8, 1.0, 2.9, 0.7, 15.5, 1.5, 4.9, 3.8],
    [5.0, 1.3, 3.6, 0.8, 19.7, 1.9, 5.6, 4.5],
    [14.0, 2.2, 5.9, 1.2, 49.1, 3.5, 8.0, 12.7],
    [36.0, 2.5, 7.8, 6.1, 121.5, 8.2, 9.4, 31.7],
    [77.9, 2.3, 7.3, 16.3, 265.7, 14.8, 8.4, 65.6],
]
CLEAR_AT_COLOUR_NM = [
    [2.4, 1.0, 1.2, 0.7, 3.3, 3.4, 4.0, 2.8],
    [3.0, 1.4, 1.5, 0.8, 4.3, 3.8, 4.7, 3.3],
    [4.9, 2.6, 3.1, 0.8, 7.5, 4.3, 5.8, 4.2],
    [7.1, 3.3, 3.7, 0.8, 10.1, 4.3, 6.3, 3.9],
    [8.7, 3.0, 3.9, 0.7, 13.0, 3.8, 8.4, 3.1],
]
CLEAR_AT_SKYLIGHT_NM = [
    [0.7, 0.1, 1.0, 0.1, 1.0, 0.2, 1.5, 0.2],
    [0.8, 0.1, 0.7, 0.1, 1.0, 0.3, 1.2, 0.2],
    [0.9, 0.3, 0.3, 0.0, 1.0, 0.6, 0.6, 0.2],
    [0.7, 0.3, 0.4, 0.1, 1.2, 0.6, 0.6, 0.4],
    [0.7, 0.4, 0.4, 0.2, 2.1, 1.1, 1.0, 0.5],
]


def sky_rgb(air: Atmosphere, elevation_deg: float) -> tuple[NDArray[np.float64], ...]:
    """Linear sRGB (18, 13, 3) seen from the ground, and the directions' solid angle weights."""
    zenith, azimuth = np.meshgrid(
        np.radians(np.arange(2.5, 90.0, 5.0)),
        np.radians(np.arange(0.0, 181.0, 15.0)),
        indexing="ij",
    )
    mu, mu_s = np.cos(zenith), np.sin(np.radians(elevation_deg))
    nu = mu * mu_s + np.sin(zenith) * np.sqrt(1.0 - mu_s**2) * np.cos(azimuth)
    spectral = single_scattering(air, 0.0, mu, mu_s, np.clip(nu, -1.0, 1.0))
    weight = np.sin(zenith)
    return rgb_from_spectrum(spectral, air.wavelength_nm), weight / weight.sum()


def errors_percent(few: Atmosphere, many: Atmosphere, elevation_deg: float) -> list[float]:
    """Means of red, green, blue and luminance, then their largest."""
    truth, weight = sky_rgb(many, elevation_deg)
    difference = sky_rgb(few, elevation_deg)[0] - truth
    with_luminance = np.concatenate([difference, luminance(difference)[..., None]], axis=-1)
    error = 100.0 * np.abs(with_luminance) / luminance(truth)[..., None]
    mean = (weight[..., None] * error).sum(axis=(0, 1))
    return [*mean.tolist(), *error.max(axis=(0, 1)).tolist()]


def air_for(wavelength_nm: tuple[float, ...]) -> Callable[..., Atmosphere]:
    """The air that the wavelengths are for: four are fitted to the standard air."""
    return earth_standard if wavelength_nm == SKYLIGHT_NM else earth_spectral


@pytest.mark.parametrize(
    ("wavelength_nm", "stated"),
    [
        (RGB_NM, CLEAR_AT_RGB_NM),
        (COLOUR_NM, CLEAR_AT_COLOUR_NM),
        (SKYLIGHT_NM, CLEAR_AT_SKYLIGHT_NM),
    ],
    ids=["680-550-440", "630-540-450", "635-570-520-445"],
)
def test_stated_errors_are_the_measured_ones(
    wavelength_nm: tuple[float, ...], stated: list[list[float]]
) -> None:
    """The documented table, clear air with ozone, single scattering, at five sun elevations."""
    air = air_for(wavelength_nm)
    few, many = air(wavelength_nm), air(FORTY_NM)
    measured = [errors_percent(few, many, elevation) for elevation in ELEVATIONS_DEG]
    assert np.array(measured) == pytest.approx(np.array(stated), abs=0.06)


@pytest.mark.parametrize(
    ("wavelength_nm", "most", "of_luminance"), [(COLOUR_NM, 14.5, 5.0), (SKYLIGHT_NM, 6.3, 1.5)]
)
def test_wavelengths_serve_in_haze_too(
    wavelength_nm: tuple[float, ...], most: float, of_luminance: float
) -> None:
    """At aerosol optical depth 0.2: the largest errors (%) of a channel and of luminance."""
    air = air_for(wavelength_nm)
    few, many = (air(nm).with_aerosol(0.2) for nm in (wavelength_nm, FORTY_NM))
    measured = np.array([errors_percent(few, many, elevation) for elevation in ELEVATIONS_DEG])
    assert measured.max() < most
    assert measured[:, 7].max() < of_luminance


def test_ozone_is_what_680_nm_cannot_see() -> None:
    """Without ozone the red of a sun 3 degrees up errs by 3.0 % in the mean, with it by 36 %."""
    without = [earth_spectral(nm, ozone=False) for nm in (RGB_NM, FORTY_NM)]
    assert errors_percent(*without, 3.0)[0] == pytest.approx(3.0, abs=0.06)


def test_forty_wavelengths_are_enough() -> None:
    """Twice as many wavelengths change a channel by 1.2 % of the luminance at most."""
    eighty = earth_spectral(np.linspace(360.0, 720.0, 80))
    for elevation in (60.0, 0.0):
        assert max(errors_percent(earth_spectral(FORTY_NM), eighty, elevation)) < 1.2


def test_sky_falls_steeper_than_the_sun() -> None:
    """The spectrum between three samples: with the sun's own slope red errs by 11 %, not 4 %."""
    few, many = earth_spectral(RGB_NM), earth_spectral(FORTY_NM)
    truth, weight = sky_rgb(many, 60.0)
    blue_sky, _ = sky_rgb(few, 60.0)
    ratio = rgb_from_spectrum(np.ones(3), RGB_NM, 0.0) / rgb_from_spectrum(np.ones(3), RGB_NM, 3.0)
    white_sky = blue_sky * ratio

    def red_error(rgb: NDArray[np.float64]) -> float:
        return float((weight * np.abs(rgb / truth - 1.0)[..., 0]).sum())

    assert red_error(white_sky) == pytest.approx(0.111, abs=2e-3)
    assert red_error(blue_sky) == pytest.approx(0.038, abs=2e-3)
