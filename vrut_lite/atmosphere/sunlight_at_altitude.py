"""The sun's irradiance at an altitude, through the air above it.

`KeyLightChanged` has the irradiance at the ground. A cloud has less air and less haze above it, and
sees the sun before sunrise and after sunset at the ground. Its sunlight is computed from the sun's
spectrum, the molecules and ozone of a clear atmosphere (`clear_air`) and the haze that the key
light names, along a straight ray.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.atmosphere.clear_air import (
    SCALE_HEIGHT_M,
    molecules_per_m,
    ozone_density,
    ozone_per_m,
)
from vrut_lite.atmosphere.haze_layer import HAZE_NM, HazeLayer
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.geometry.colour import colour_table, rgb_from_spectrum, solar_irradiance
from vrut_lite.numeric_types import FloatArray

_TOP_M = 80_000.0
_STEPS = 96
_SUN_RADIUS_RAD = 0.004675
_LEAST_DEPTH = 1e-12


def sunlight_at_altitude(
    altitude_m: ArrayLike, sine: ArrayLike, haze: tuple[HazeLayer, ...] = ()
) -> FloatArray:
    """Irradiance (..., 3) of a plane that faces the sun, linear sRGB in W m^-2.

    Args:
        altitude_m: (...,) of the plane over the ground, 0 or more; it may lie above the air.
        sine: (...,) of the sun's elevation there. The horizon, which dips with the altitude,
            cuts the disc off.
        haze: between the ground and the sun.
    """
    altitude, mu = np.broadcast_arrays(
        np.asarray(altitude_m, dtype=float), np.asarray(sine, dtype=float)
    )
    # The arc cosine of nearly 1 would lose half of its digits.
    dip = np.arctan2(np.sqrt(altitude * (2.0 * GROUND_RADIUS_M + altitude)), GROUND_RADIUS_M)
    over_horizon = np.arcsin(np.clip(mu, -1.0, 1.0)) + dip
    shown = _shown_share(over_horizon / _SUN_RADIUS_RAD)
    # The visible part of a setting disc is seen along the horizon.
    lowest = np.sin(-dip)
    depth = _optical_depth(altitude, np.maximum(mu, lowest), haze)
    wavelength_nm = colour_table()[:, 0]
    spectral = solar_irradiance(wavelength_nm) * np.exp(-depth)
    rgb = rgb_from_spectrum(spectral, wavelength_nm, solar_exponent=0.0)
    return np.maximum(rgb, 0.0) * shown[..., None]


def _shown_share(over_horizon: FloatArray) -> FloatArray:
    """Visible share (...,) of a disc whose centre is `over_horizon` radii above the horizon."""
    h = np.clip(over_horizon, -1.0, 1.0)
    return 0.5 + (np.arcsin(h) + h * np.sqrt(1.0 - h * h)) / np.pi


def _optical_depth(
    altitude_m: FloatArray, mu: FloatArray, haze: tuple[HazeLayer, ...]
) -> FloatArray:
    """Optical depth (..., wavelengths) of molecules, ozone and haze to the top of the air.

    By the midpoint rule, at the wavelengths of the colour table.
    """
    wavelength_nm = colour_table()[:, 0]
    altitude_m, mu, misses = _inside(altitude_m, mu)
    radius = GROUND_RADIUS_M + altitude_m
    along = radius * mu
    rise = (_TOP_M - altitude_m) * (radius + GROUND_RADIUS_M + _TOP_M)
    whole = np.sqrt(along * along + rise) - along
    # Dense near the start, where the air is.
    u = (np.arange(_STEPS) + 0.5) / _STEPS
    t = whole[..., None] * u * u
    weight = whole[..., None] * 2.0 * u / _STEPS
    squares = t * (2.0 * along[..., None] + t)
    higher = squares / (radius[..., None] + np.sqrt(radius[..., None] ** 2 + squares))
    height = altitude_m[..., None] + higher
    air = (np.exp(-height / SCALE_HEIGHT_M) * weight).sum(axis=-1)
    ozone = (ozone_density(height) * weight).sum(axis=-1)
    depth = air[..., None] * molecules_per_m(wavelength_nm)
    depth += ozone[..., None] * ozone_per_m(wavelength_nm)
    for layer in haze:
        heights = (np.exp(-height / layer.height_m) * weight).sum(axis=-1) / layer.height_m
        depth += heights[..., None] * haze_depth(layer, wavelength_nm)
    return np.where(misses[..., None], 0.0, depth)


def haze_depth(layer: HazeLayer, wavelength_nm: FloatArray) -> FloatArray:
    """Vertical depth (n,) of a layer: its logarithm is a parabola of the wavelength's."""
    log_depth = np.log(np.maximum(layer.optical_depth, _LEAST_DEPTH))
    parabola = np.polyfit(np.log(HAZE_NM), log_depth, 2)
    return np.exp(np.polyval(parabola, np.log(wavelength_nm)))


def _inside(
    altitude_m: FloatArray, mu: FloatArray
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Altitude and mu (...,) where rays from above the air enter it, and whether they miss it."""
    above, top = altitude_m > _TOP_M, GROUND_RADIUS_M + _TOP_M
    perigee = (GROUND_RADIUS_M + altitude_m) * np.sqrt((1.0 - mu) * (1.0 + mu))
    squares = (top - perigee) * (top + perigee)
    misses = above & ((mu >= 0.0) | (squares <= 0.0))
    entering = np.where(misses, 1.0, -np.sqrt(np.maximum(squares, 0.0)) / top)
    return np.minimum(altitude_m, _TOP_M), np.where(above, entering, mu), misses
