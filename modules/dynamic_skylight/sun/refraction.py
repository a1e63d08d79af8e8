"""Atmospheric refraction of the sun: one standard formula, continuous from nadir to zenith."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

STANDARD_PRESSURE_PA = 101_325.0
STANDARD_TEMPERATURE_C = 10.0
# Lower end of the formula's fit, and elevation below which refraction is set to zero.
_FITTED_DOWN_TO_DEG = -1.0
_GONE_AT_DEG = -6.0
_INVERSION_STEPS = 24


def pressure_at_altitude_pa(altitude_m: float) -> float:
    """Pressure of the standard atmosphere (ISO 2533), its second layer going on to space."""
    if altitude_m <= 11_000.0:
        return float(STANDARD_PRESSURE_PA * (1.0 - 2.25577e-5 * altitude_m) ** 5.25588)
    return 22_632.0 * math.exp((11_000.0 - altitude_m) / 6_341.6)


def refraction_rad(
    elevation_rad: ArrayLike,
    pressure_pa: float = STANDARD_PRESSURE_PA,
    temperature_c: float = STANDARD_TEMPERATURE_C,
) -> NDArray[np.float64]:
    """Refraction (...,): apparent minus geometric elevation, at geometric elevations (...,).

    Saemundsson 1986 ("Atmospheric Refraction", Sky and Telescope 72, 70), scaled with
    pressure and temperature as in Meeus, Astronomical Algorithms, chapter 16. To avoid its pole
    at -5.1 deg, the value at -1 deg holds below and fades smoothly to 0 at -6 deg, the end of
    civil twilight.
    """
    h = np.degrees(np.asarray(elevation_rad, dtype=float))
    held = np.maximum(h, _FITTED_DOWN_TO_DEG)
    arcminutes = 1.02 / np.tan(np.radians(held + 10.3 / (held + 5.11)))
    air = (pressure_pa / 101_000.0) * (283.0 / (273.0 + temperature_c))
    x = np.clip((h - _GONE_AT_DEG) / (_FITTED_DOWN_TO_DEG - _GONE_AT_DEG), 0.0, 1.0)
    fade = x * x * (3.0 - 2.0 * x)
    # At the zenith the fit is -0.002 arc minutes.
    return np.radians(np.maximum(arcminutes, 0.0) * air * fade / 60.0)


def geometric_elevation(apparent_elevation_rad: ArrayLike) -> NDArray[np.float64]:
    """Geometric elevation (...,) of an apparent one, with standard refraction, to 1e-12 rad.

    Fixed-point iteration: the slope of refraction is below 0.2, so a step gains 0.7 of a digit.
    """
    apparent = np.asarray(apparent_elevation_rad, dtype=float)
    geometric = apparent
    for _ in range(_INVERSION_STEPS):
        geometric = apparent - refraction_rad(geometric)
    return geometric
