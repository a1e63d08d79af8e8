"""Refraction by the standard atmosphere, traced ray by ray and kept as a table.

Auer and Standish (2000, Astron. J. 119, 2472): along a ray n r sin z is constant, and the bending
is the integral over z of r n' / (n + r n'), which is smooth even on the horizon. The air is that
of ISO 2533 with 10 deg C and 1010 hPa at its foot, 570 nm.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.numeric_types import FloatArray

_RADIUS_M = 6_371_000.0
_FOOT_K, _FOOT_PA = 283.15, 101_000.0
_LAPSE_K_PER_M, _TROPOPAUSE_M = 6.5e-3, 11_000.0
# g M / R, K/m.
_HYDROSTATIC = 0.0341632
# n - 1 per Pa/K at 570 nm: 2.777e-4 at 288.15 K and 101325 Pa.
_REFRACTIVITY = 2.777e-4 * 288.15 / 101_325.0
_TOP_M = 90_000.0
_STEPS, _NEWTON_STEPS = 400, 12
# Apparent elevations of the table, dense at the horizon; below it the table's end holds.
_LOWEST_DEG = -0.6


class _Air(NamedTuple):
    """Refractive index less 1 and its slope (1/m) at altitudes."""

    refractivity: FloatArray
    slope_per_m: FloatArray


def refraction_rad(apparent_elevation_rad: ArrayLike) -> FloatArray:
    """Apparent less true elevation (...,) at apparent elevations (...,), from sea level."""
    at, bent = _table()
    return np.interp(np.asarray(apparent_elevation_rad, dtype=float), at, bent)


def apparent_elevation(true_elevation_rad: ArrayLike) -> FloatArray:
    """Apparent elevation (...,) of true ones: the inverse of the table.

    A body so low that it is hidden keeps the horizon's refraction.
    """
    at, bent = _table()
    true = np.asarray(true_elevation_rad, dtype=float)
    return true + np.interp(true, at - bent, bent)


class Flattening(NamedTuple):
    """How much less high a disc looks than it is.

    A place t radians above its apparent middle truly lies t - slope t - curvature t^2 above it.
    """

    slope: float
    curvature: float


def flattening(apparent_elevation_rad: float, angular_radius_rad: float) -> Flattening:
    """That of a disc whose middle is seen at this elevation, through three places of it.

    The disc's half that the horizon hides is flattened as the other one.
    """
    middle = max(apparent_elevation_rad, 0.0)
    low, at, high = refraction_rad(middle + angular_radius_rad * np.array([0.0, 0.5, 1.0]))
    step = 0.5 * angular_radius_rad
    curvature = (high - 2.0 * at + low) / (2.0 * step * step)
    return Flattening(float((at - low) / step - curvature * step), float(curvature))


@lru_cache(maxsize=1)
def _table() -> tuple[FloatArray, FloatArray]:
    degrees = np.concatenate([
        np.linspace(_LOWEST_DEG, 2.0, 53), np.geomspace(2.1, 90.0, 60),
    ])  # fmt: skip
    at = np.radians(degrees)
    bent = trace(np.maximum(at, 0.0))
    # A ray that dips under the horizon first comes up to it: it is bent more by as much again
    # as the line of sight is low; only discs that are half set need it.
    slope = (bent[degrees >= 0.0][1] - bent[degrees >= 0.0][0]) / (at[1] - at[0])
    return at, np.where(at < 0.0, bent + slope * at, bent)


def trace(apparent_elevation_rad: FloatArray) -> FloatArray:
    """Bending (n,) of rays that reach sea level at these elevations, at least 0."""
    z0 = 0.5 * np.pi - np.asarray(apparent_elevation_rad, dtype=float)
    foot = _air(np.zeros(1)).refractivity[0]
    invariant = (1.0 + foot) * _RADIUS_M * np.sin(z0)
    top = _air(np.full(1, _TOP_M)).refractivity[0]
    z_top = np.arcsin(invariant / ((1.0 + top) * (_RADIUS_M + _TOP_M)))
    shares = (np.arange(_STEPS) + 0.5) / _STEPS
    z = z0[:, None] + (z_top - z0)[:, None] * shares
    height = _heights(z, invariant[:, None])
    air = _air(height)
    radius = _RADIUS_M + height
    integrand = radius * air.slope_per_m / (1.0 + air.refractivity + radius * air.slope_per_m)
    return np.asarray(integrand.mean(axis=1) * (z_top - z0))


def _heights(z: FloatArray, invariant: FloatArray) -> FloatArray:
    """Altitudes where rays have zenith angles z: Newton's method on n r sin z."""
    height = np.clip(invariant / np.sin(np.maximum(z, 1e-9)) - _RADIUS_M, 0.0, _TOP_M)
    for _ in range(_NEWTON_STEPS):
        air = _air(height)
        radius = _RADIUS_M + height
        error = (1.0 + air.refractivity) * radius * np.sin(z) - invariant
        slope = (1.0 + air.refractivity + radius * air.slope_per_m) * np.sin(z)
        height = np.clip(height - error / np.maximum(slope, 1e-9), 0.0, _TOP_M)
    return height


def _air(height_m: FloatArray) -> _Air:
    low = np.minimum(height_m, _TROPOPAUSE_M)
    kelvin = _FOOT_K - _LAPSE_K_PER_M * low
    pascal = _FOOT_PA * (kelvin / _FOOT_K) ** (_HYDROSTATIC / _LAPSE_K_PER_M)
    pascal = pascal * np.exp(-_HYDROSTATIC * (height_m - low) / kelvin)
    refractivity = _REFRACTIVITY * pascal / kelvin
    lapse = np.where(height_m < _TROPOPAUSE_M, _LAPSE_K_PER_M, 0.0)
    return _Air(refractivity, refractivity * (lapse - _HYDROSTATIC) / kelvin)
