"""The stars: their light above the air, and where they stand.

The catalogue is d3-celestial's of 41,411 stars to magnitude 8.5 (J2000, V, B-V); 238 bright stars
have proper motions of the Bright Star Catalogue.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from night_sky.data_files import night_data
from night_sky.sky_axes import Watch, aberrated, unit
from vrut_lite.geometry.colour import LUMENS_PER_WATT, colour_table, luminance, rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray

# Illuminance of V = 0 above the air (Bessell 1998: 3.63e-11 W m^-2 nm^-1 at 548 nm).
LUX_OF_MAGNITUDE_0 = 2.63e-6
_ARCSEC_RAD = np.pi / 648_000.0
_DAYS_PER_YEAR = 365.25
_SECOND_RADIATION_NM_K = 1.438_777e7
# Range in which a catalogue's colour is one of a star.
_BLUEST, _REDDEST = -0.4, 2.5
_COLOUR_STEPS = 64


class Stars(NamedTuple):
    """Directions (n, 3) and irradiances (n, 3), linear sRGB, W m^-2, brightest first."""

    direction: FloatArray
    irradiance_rgb: FloatArray


def colour_of(b_minus_v: FloatArray) -> FloatArray:
    """Linear sRGB (..., 3) of luminance 1 of stars with these B - V.

    Planck's spectrum at Ballesteros' temperature (2012, EPL 97, 34008).
    """
    nodes, colours = _colours()
    at = np.clip(np.asarray(b_minus_v, dtype=float), _BLUEST, _REDDEST)
    return np.stack([np.interp(at, nodes, colours[:, c]) for c in range(3)], axis=-1)


def planck_colour(kelvin: FloatArray) -> FloatArray:
    """Linear sRGB (..., 3) of luminance 1 of black bodies."""
    wavelength = colour_table()[:, 0]
    power = _SECOND_RADIATION_NM_K / (wavelength * np.asarray(kelvin, dtype=float)[..., None])
    spectrum = (wavelength / 550.0) ** -5.0 / np.expm1(power)
    rgb = np.maximum(rgb_from_spectrum(spectrum, wavelength), 0.0)
    return np.asarray(rgb / luminance(rgb)[..., None])


def irradiance_of(magnitude: FloatArray, b_minus_v: FloatArray) -> FloatArray:
    """Irradiance (..., 3) above the air, linear sRGB, W m^-2."""
    watts = LUX_OF_MAGNITUDE_0 / LUMENS_PER_WATT * 10.0 ** (-0.4 * np.asarray(magnitude))
    return np.asarray(watts[..., None] * colour_of(b_minus_v))


def stars_at(at: Watch) -> Stars:
    """All stars in world axes, without refraction and above the air."""
    seen = aberrated(_places(at.time.tt / _DAYS_PER_YEAR), at)
    return Stars(seen @ at.world.T, _light())


def _places(years: float) -> FloatArray:
    """Directions (n, 3), J2000, so many years after 2000."""
    data = night_data()
    direction = _directions()
    moving = data["moving"].astype(int)
    ra = np.radians(data["ra_deg"][moving])
    east = np.stack([-np.sin(ra), np.cos(ra), np.zeros(ra.size)], axis=-1)
    north = np.cross(direction[moving], east)
    angle = data["motion_arcsec"] * (years * _ARCSEC_RAD)
    moved = direction[moving] + angle[:, :1] * east + angle[:, 1:] * north
    placed = direction.copy()
    placed[moving] = moved / np.linalg.norm(moved, axis=1, keepdims=True)
    return placed


@lru_cache(maxsize=1)
def _directions() -> FloatArray:
    data = night_data()
    return unit(data["ra_deg"], data["dec_deg"])


@lru_cache(maxsize=1)
def _light() -> FloatArray:
    data = night_data()
    return irradiance_of(data["v_mag"], data["b_minus_v"])


@lru_cache(maxsize=1)
def _colours() -> tuple[FloatArray, FloatArray]:
    bv = np.linspace(_BLUEST, _REDDEST, _COLOUR_STEPS)
    kelvin = 4600.0 * (1.0 / (0.92 * bv + 1.7) + 1.0 / (0.92 * bv + 0.62))
    return bv, planck_colour(kelvin)
