"""The sun's irradiance at an altitude, through the clear air above it.

`KeyLightChanged` has the irradiance at the ground. A cloud has less air and hardly any haze above
it, and sees the sun before sunrise and after sunset at the ground. Its sunlight is computed from
the sun's spectrum and the molecules and ozone of a clear atmosphere (the coefficients of Bruneton
2017's demo) along a straight ray.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.geometry.colour import rgb_from_spectrum, solar_irradiance
from vrut_lite.numeric_types import FloatArray

PLANET_RADIUS_M = 6.36e6
_WAVELENGTH_NM = (680.0, 550.0, 440.0)
_RAYLEIGH_PER_M = np.array([5.80234e-6, 1.355776e-5, 3.310001e-5])
_RAYLEIGH_SCALE_M = 8000.0
_OZONE_PER_M = np.array([6.497e-7, 1.8809e-6, 8.502e-8])
# Ozone's density is a tent: zero at the ends, one in the middle.
_OZONE_M = (10_000.0, 25_000.0, 40_000.0)
_TOP_M = 80_000.0
_STEPS = 96
_SUN_RADIUS_RAD = 0.004675


def sun_aloft(altitude_m: ArrayLike, sine: ArrayLike) -> FloatArray:
    """Irradiance (..., 3) of a plane that faces the sun, linear sRGB in W m^-2.

    Args:
        altitude_m: (...,) of the plane, 0 or more; it may lie above the air.
        sine: (...,) of the sun's elevation there. The horizon, which dips with the altitude,
            cuts the disc off.
    """
    altitude, mu = np.broadcast_arrays(
        np.asarray(altitude_m, dtype=float), np.asarray(sine, dtype=float)
    )
    # The arc cosine of nearly 1 would lose half of its digits.
    dip = np.arctan2(np.sqrt(altitude * (2.0 * PLANET_RADIUS_M + altitude)), PLANET_RADIUS_M)
    over_horizon = np.arcsin(np.clip(mu, -1.0, 1.0)) + dip
    shown = _shown_share(over_horizon / _SUN_RADIUS_RAD)
    # The visible part of a setting disc is seen along the horizon.
    lowest = np.sin(-dip)
    depth = _optical_depth(altitude, np.maximum(mu, lowest))
    spectral = solar_irradiance(_WAVELENGTH_NM) * np.exp(-depth)
    rgb = rgb_from_spectrum(spectral, _WAVELENGTH_NM, solar_exponent=0.0)
    return np.maximum(rgb, 0.0) * shown[..., None]


def _shown_share(over_horizon: FloatArray) -> FloatArray:
    """Visible share (...,) of a disc whose centre is `over_horizon` radii above the horizon."""
    h = np.clip(over_horizon, -1.0, 1.0)
    return 0.5 + (np.arcsin(h) + h * np.sqrt(1.0 - h * h)) / np.pi


def _optical_depth(altitude_m: FloatArray, mu: FloatArray) -> FloatArray:
    """Optical depth (..., 3) of molecules and ozone to the top of the air; midpoint rule."""
    altitude_m, mu, misses = _inside(altitude_m, mu)
    radius = PLANET_RADIUS_M + altitude_m
    along = radius * mu
    rise = (_TOP_M - altitude_m) * (radius + PLANET_RADIUS_M + _TOP_M)
    whole = np.sqrt(along * along + rise) - along
    # Dense near the start, where the air is.
    u = (np.arange(_STEPS) + 0.5) / _STEPS
    t = whole[..., None] * u * u
    weight = whole[..., None] * 2.0 * u / _STEPS
    squares = t * (2.0 * along[..., None] + t)
    higher = squares / (radius[..., None] + np.sqrt(radius[..., None] ** 2 + squares))
    height = altitude_m[..., None] + higher
    air = (np.exp(-height / _RAYLEIGH_SCALE_M) * weight).sum(axis=-1)
    ozone = (np.interp(height, _OZONE_M, (0.0, 1.0, 0.0)) * weight).sum(axis=-1)
    depth = air[..., None] * _RAYLEIGH_PER_M + ozone[..., None] * _OZONE_PER_M
    return np.where(misses[..., None], 0.0, depth)


def _inside(
    altitude_m: FloatArray, mu: FloatArray
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Altitude and mu (...,) where rays from above the air enter it, and whether they miss it."""
    above, top = altitude_m > _TOP_M, PLANET_RADIUS_M + _TOP_M
    perigee = (PLANET_RADIUS_M + altitude_m) * np.sqrt((1.0 - mu) * (1.0 + mu))
    squares = (top - perigee) * (top + perigee)
    misses = above & ((mu >= 0.0) | (squares <= 0.0))
    entering = np.where(misses, 1.0, -np.sqrt(np.maximum(squares, 0.0)) / top)
    return np.minimum(altitude_m, _TOP_M), np.where(above, entering, mu), misses
