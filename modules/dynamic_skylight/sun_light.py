"""The direct light of the sun: irradiance in colour, and limb darkening.

`sun_behind_air` is the sun behind the haze that is asked for. `sun_light` is the model's own:
`HosekWilkieSky.solar_radiance`, integrated over the disc that it was fitted with. Two properties:

* The eleven wavelengths end at 720 nm. For ASTM G-173 this loses 6e-4 of linear red and 8e-5 of
  luminance; sampling at 40 nm instead of 5 nm loses 1.4 % of luminance (red 0.4 %, green 1.7 %,
  blue 1.6 %).
* The undarkened radiance at 560 nm times the solid angle of the real disc (0.2666 deg) is ASTM
  G-173's irradiance behind clear air of optical depth 0.12, within 1 %. The model's smaller disc
  (0.255 deg) and its limb darkening (1 at the centre, 0.82 in the mean) reduce it by 25 %. The
  irradiance here follows the published model, disc and darkening included.
"""

from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dynamic_skylight.hosek_wilkie import coefficients
from dynamic_skylight.hosek_wilkie.coefficients import WAVELENGTHS_NM
from dynamic_skylight.hosek_wilkie.sky import SOLAR_DISC_RADIUS_RAD
from dynamic_skylight.twilight import sky_of_hour
from vrut_lite.geometry.colour import (
    LUMINANCE_WEIGHTS,
    integration_matrix,
    luminance,
    rgb_from_spectrum,
    solar_irradiance,
)
from vrut_lite.messages.haze import SetHaze
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.clear_sun import sun_irradiance_rgb

SunColour = Literal["air", "disc", "sky_formula", "white"]
Polynomial = tuple[float, ...]

_DISC_NODES = (6, 8)
# The mean over a disc of cos^j psi, where cos psi = sqrt(1 - (distance / radius)^2).
_MEAN_OF_POWERS = 2.0 / (np.arange(6) + 2.0)


class SunLight(NamedTuple):
    """The direct light.

    Attributes:
        irradiance_rgb: (3,) on a plane that faces the sun, W m^-2, linear sRGB.
        limb_darkening_rgb: per channel a polynomial in cos psi whose mean over the disc is 1.
    """

    irradiance_rgb: FloatArray
    limb_darkening_rgb: tuple[Polynomial, Polynomial, Polynomial]


def sun_light(
    turbidity: float,
    albedo: ArrayLike,
    apparent_elevation_rad: float,
    visible_disc_fraction: float,
    colour: SunColour = "disc",
) -> SunLight:
    """The sun's light at the ground, in proportion to the visible share of the disc.

    `colour` selects the hue; the luminance is always the disc's. "disc": the solar function
    itself; "sky_formula": the sky's formula at the sun (gamma = 0), as in the daylight thesis
    (section 3.3); "white".
    """
    visible = float(visible_disc_fraction)
    disc = in_gamut(
        rgb_from_spectrum(disc_irradiance(turbidity, apparent_elevation_rad), WAVELENGTHS_NM)
    )
    if colour == "disc":
        return SunLight(visible * disc, limb_darkening_rgb())
    if colour == "sky_formula":
        sky = sky_of_hour(turbidity, albedo, apparent_elevation_rad)
        hue = sky.radiance(np.pi / 2 - max(apparent_elevation_rad, 0.0), 0.0)
        return SunLight(visible * _with_luminance_of(disc, hue), limb_darkening_rgb())
    white = _with_luminance_of(disc, np.ones(3))
    return SunLight(visible * white, (_white_limb(),) * 3)


def sun_behind_air(
    haze: SetHaze, apparent_elevation_rad: float, visible_disc_fraction: float
) -> SunLight:
    """The sun behind the air that the sky has, not the model's own disc."""
    irradiance = in_gamut(sun_irradiance_rgb(haze, apparent_elevation_rad))
    return SunLight(float(visible_disc_fraction) * irradiance, limb_darkening_rgb())


def disc_irradiance(turbidity: float, apparent_elevation_rad: float) -> FloatArray:
    """Irradiance (11,) of the whole disc facing the sun, W m^-2 nm^-1, at `WAVELENGTHS_NM`.

    The integral of radiance times cosine, whose weight is constant in sin^2 gamma: Gauss-Legendre
    along it, uniform around the disc, each point with the air path at its elevation. Points
    below the horizon count as on it; the caller applies the visible share of the disc.
    """
    rings, spokes = _DISC_NODES
    x, weight = np.polynomial.legendre.leggauss(rings)
    mu = 0.5 + 0.5 * x
    around = (np.arange(spokes) + 0.5) * (2 * np.pi / spokes)
    offset = SOLAR_DISC_RADIUS_RAD * np.sqrt(1.0 - mu * mu)[:, None] * np.sin(around)
    elevation = np.clip(apparent_elevation_rad + offset, 0.0, np.pi / 2)
    centre = coefficients.sun_radiance(turbidity, elevation).mean(axis=1)
    darkening = mu[:, None] ** np.arange(6) @ coefficients.limb_darkening().T
    mean = np.einsum("i,iw,iw->w", weight * mu, centre, darkening)
    irradiance: FloatArray = np.pi * np.sin(SOLAR_DISC_RADIUS_RAD) ** 2 * np.maximum(mean, 0.0)
    return irradiance


def in_gamut(rgb: FloatArray) -> FloatArray:
    """Linear sRGB without negative channels and with the same luminance.

    The setting sun is redder than sRGB's red: its blue would be negative.
    """
    return _with_luminance_of(rgb, np.maximum(rgb, 0.0))


def _with_luminance_of(rgb: FloatArray, hue: FloatArray) -> FloatArray:
    of_hue = float(luminance(hue))
    return hue * (max(float(luminance(rgb)), 0.0) / of_hue) if of_hue > 0.0 else 0.0 * hue


@lru_cache(maxsize=1)
def limb_darkening_rgb() -> tuple[Polynomial, Polynomial, Polynomial]:
    """Polynomials in cos psi, constant first, whose mean over the disc is 1, per channel.

    Weighted with the extraterrestrial spectrum: with that of a low sun the blue channel would
    be divided by nearly zero.
    """
    weights = integration_matrix(tuple(WAVELENGTHS_NM)) * solar_irradiance(WAVELENGTHS_NM)[:, None]
    red, green, blue = (_normalised(weight) for weight in weights.T)
    return red, green, blue


@lru_cache(maxsize=1)
def _white_limb() -> Polynomial:
    """The darkening of luminance, for a disc without colour."""
    matrix = integration_matrix(tuple(WAVELENGTHS_NM)) @ LUMINANCE_WEIGHTS
    return _normalised(matrix * solar_irradiance(WAVELENGTHS_NM))


def _normalised(weight: FloatArray) -> Polynomial:
    polynomial = weight @ coefficients.limb_darkening()
    return tuple(float(v) for v in polynomial / (polynomial @ _MEAN_OF_POWERS))
