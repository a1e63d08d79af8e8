"""Refraction: by a standard formula on the ground, and aloft by the standard atmosphere.

The formula gives the sun's refraction for a place's pressure and temperature, continuous from nadir
to zenith. From aloft rays are traced through the standard atmosphere and kept as tables.

Auer and Standish (2000, Astron. J. 119, 2472): along a ray n r sin z is constant, and the bending
is the integral over z of r n' / (n + r n'), which is smooth even on the horizon. The air is that
of ISO 2533 with 10 deg C and 1010 hPa at its foot, 570 nm. From aloft a ray sinks to the place
where it is level and climbs again: from space the one that grazes the ground bends twice as much.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.atmosphere.planet import EARTH_RADIUS_M
from vrut_lite.numeric_types import FloatArray, Vector

STANDARD_PRESSURE_PA = 101_325.0
STANDARD_TEMPERATURE_C = 10.0
# Lower end of the formula's fit, and elevation below which its refraction is zero.
_FITTED_DOWN_TO_DEG = -1.0
_FORMULA_GONE_AT_DEG = -6.0
_INVERSION_STEPS = 24
_FOOT_K, _FOOT_PA = 283.15, 101_000.0
_LAPSE_K_PER_M, _TROPOPAUSE_M = 6.5e-3, 11_000.0
# Hydrostatic constant g M / R, K/m.
_HYDROSTATIC = 0.0341632
# Refractivity n - 1 per Pa/K at 570 nm: 2.777e-4 at 288.15 K and 101325 Pa.
_REFRACTIVITY = 2.777e-4 * 288.15 / 101_325.0
_TOP_M = 90_000.0
_STEPS, _NEWTON_STEPS = 200, 4
# Heights (m) between which the sun's formula for the ground gives way to refraction at the eye.
_ON_GROUND_M, _ALOFT_M = 30.0, 130.0
# Lowest elevation (degrees) of the table, below the horizon.
_LOWEST_DEG = -0.3
# Dips, without refraction, of the altitudes for which tables are traced: within 0.1' of any other
# altitude's. Spacing of their low elevations.
_LEVEL_RAD, _SPACING_DEG = np.radians(0.02), 0.05


class _Air(NamedTuple):
    """Refractive index less 1 and its slope (1/m) at altitudes."""

    refractivity: FloatArray
    slope_per_m: FloatArray


def pressure_at_altitude_pa(altitude_m: float) -> float:
    """Pressure of the standard atmosphere (ISO 2533), its second layer going on to space."""
    if altitude_m <= 11_000.0:
        return float(STANDARD_PRESSURE_PA * (1.0 - 2.25577e-5 * altitude_m) ** 5.25588)
    return 22_632.0 * math.exp((11_000.0 - altitude_m) / 6_341.6)


def refraction_of_true_rad(
    elevation_rad: ArrayLike,
    pressure_pa: float = STANDARD_PRESSURE_PA,
    temperature_c: float = STANDARD_TEMPERATURE_C,
) -> FloatArray:
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
    x = np.clip((h - _FORMULA_GONE_AT_DEG) / (_FITTED_DOWN_TO_DEG - _FORMULA_GONE_AT_DEG), 0.0, 1.0)
    fade = x * x * (3.0 - 2.0 * x)
    # At the zenith the fit is -0.002 arc minutes.
    return np.radians(np.maximum(arcminutes, 0.0) * air * fade / 60.0)


def geometric_elevation(apparent_elevation_rad: ArrayLike) -> FloatArray:
    """Geometric elevation (...,) of an apparent one, with standard refraction, to 1e-12 rad.

    Fixed-point iteration: the slope of refraction is below 0.2, so a step gains 0.7 of a digit.
    """
    apparent = np.asarray(apparent_elevation_rad, dtype=float)
    geometric = apparent
    for _ in range(_INVERSION_STEPS):
        geometric = apparent - refraction_of_true_rad(geometric)
    return geometric


def dip_rad(altitude_m: float) -> float:
    """How far below the level the horizon is seen from an altitude above it, refraction counted.

    The ray that grazes the ground has n r at the eye times the dip's cosine equal to that there.
    """
    grazing, here = _index_radius(0.0), _index_radius(altitude_m)
    return float(np.arccos(min(grazing / here, 1.0)))


def refraction_rad(apparent_elevation_rad: ArrayLike, altitude_m: float = 0.0) -> FloatArray:
    """Apparent less true elevation (...,) at apparent elevations (...,) from an altitude.

    Below the horizon's dip the table goes on evenly: discs that are half set need it.
    """
    at = np.asarray(apparent_elevation_rad, dtype=float)
    if altitude_m > _TOP_M:
        # The same ray, where it enters the air.
        cosine = np.cos(at) * _index_radius(altitude_m) / _index_radius(_TOP_M)
        meets = (at < 0.0) & (cosine < 1.0)
        return np.where(
            meets, refraction_rad(-np.arccos(np.minimum(cosine, 1.0)), _TOP_M), np.zeros(at.shape)
        )
    return np.interp(at + dip_rad(altitude_m), *_table_at(altitude_m))


def apparent_elevation(true_elevation_rad: ArrayLike, altitude_m: float = 0.0) -> FloatArray:
    """Apparent elevation (...,) of true ones: the inverse of `refraction_rad`.

    A body so low that it is hidden keeps the horizon's refraction.
    """
    at = _table_at(min(altitude_m, _TOP_M))[0] - dip_rad(altitude_m)
    bent = refraction_rad(at, altitude_m)
    true = np.asarray(true_elevation_rad, dtype=float)
    return true + np.interp(true, at - bent, bent)


def horizon_elevation(altitude_m: float) -> float:
    """True elevation of a body that is seen on the horizon from an altitude."""
    dip = dip_rad(altitude_m)
    return float(-dip - refraction_rad(-dip, altitude_m))


def eye_aloft_m(eye_height_m: float) -> float:
    """The height that counts for what an eye sees of the sky: 0 near the ground."""
    return eye_height_m if eye_height_m > _ON_GROUND_M else 0.0


def seen_from_aloft(direction: Vector, true_elevation_rad: float, eye_height_m: float) -> Vector:
    """Apparent direction for an eye aloft of an object, from that seen on the ground."""
    share = min((eye_height_m - _ON_GROUND_M) / (_ALOFT_M - _ON_GROUND_M), 1.0)
    if share <= 0.0:
        return direction
    x, y, z = direction
    before = math.asin(min(max(y, -1.0), 1.0))
    aloft = float(apparent_elevation(true_elevation_rad, eye_height_m))
    after = before + share * (aloft - before)
    level = math.cos(after) / max(math.hypot(x, z), 1e-9)
    return x * level, math.sin(after), z * level


class Flattening(NamedTuple):
    """Flattening of a disc by refraction.

    A place t radians above its apparent middle truly lies t - slope t - curvature t^2 above it.
    """

    slope: float
    curvature: float


def flattening(
    apparent_elevation_rad: float, angular_radius_rad: float, altitude_m: float = 0.0
) -> Flattening:
    """Flattening of a disc with its middle at this elevation, a parabola through three points.

    The half below the horizon is flattened like the other one.
    """
    middle = max(apparent_elevation_rad, -dip_rad(altitude_m))
    places = middle + angular_radius_rad * np.array([0.0, 0.5, 1.0])
    low, at, high = refraction_rad(places, altitude_m)
    step = 0.5 * angular_radius_rad
    curvature = (high - 2.0 * at + low) / (2.0 * step * step)
    return Flattening(float((at - low) / step - curvature * step), float(curvature))


@lru_cache(maxsize=64)
def _table(level: int) -> tuple[FloatArray, FloatArray]:
    """Elevations over a level's horizon, rising, and the bending there."""
    dip = level * _LEVEL_RAD
    altitude = min(EARTH_RADIUS_M * (1.0 / np.cos(dip) - 1.0), _TOP_M)
    low_deg = np.degrees(dip) + 2.0
    degrees = np.concatenate([
        np.arange(_LOWEST_DEG, low_deg, _SPACING_DEG), np.geomspace(low_deg + 0.05, 102.0, 60),
    ])  # fmt: skip
    over = np.radians(degrees)
    bent = trace(np.clip(over, 0.0, None) - dip_rad(altitude), altitude)
    # A ray that dips under the horizon first comes up to it: it is bent more by as much again
    # as the line of sight is low.
    up = bent[degrees >= 0.0]
    return over, np.where(over < 0.0, bent + (up[1] - up[0]) / (over[1] - over[0]) * over, bent)


def _table_at(altitude_m: float) -> tuple[FloatArray, FloatArray]:
    """Table of the traced altitude nearest to an altitude within the air."""
    dip = np.arccos(EARTH_RADIUS_M / (EARTH_RADIUS_M + max(altitude_m, 0.0)))
    return _table(round(float(dip) / _LEVEL_RAD))


def _index_radius(altitude_m: float) -> float:
    """n r at an altitude."""
    high = max(altitude_m, 0.0)
    refractivity = _air(np.full(1, high)).refractivity[0] if high <= _TOP_M else 0.0
    return float((1.0 + refractivity) * (EARTH_RADIUS_M + high))


def trace(apparent_elevation_rad: ArrayLike, altitude_m: float = 0.0) -> FloatArray:
    """Bending (n,) of rays that reach an altitude within the air at these elevations.

    One that would meet the ground grazes it.
    """
    elevation = np.asarray(apparent_elevation_rad, dtype=float)
    down = elevation < 0.0
    invariant = np.maximum(_index_radius(altitude_m) * np.cos(elevation), 0.0)
    invariant = np.where(down, np.maximum(invariant, _index_radius(0.0)), invariant)
    at_eye = np.arcsin(np.minimum(invariant / _index_radius(altitude_m), 1.0))
    at_top = np.arcsin(np.minimum(invariant / _index_radius(_TOP_M), 1.0))
    level = np.full(elevation.shape, 0.5 * np.pi)
    outward = _bending(invariant, np.where(down, level, at_eye), at_top)
    return outward + (_bending(invariant, level, at_eye) if down.any() else 0.0) * down


def _bending(invariant: FloatArray, z_low: FloatArray, z_high: FloatArray) -> FloatArray:
    """Bending (n,) of climbing rays between two zenith angles."""
    shares = (np.arange(_STEPS) + 0.5) / _STEPS
    z = z_low[:, None] + (z_high - z_low)[:, None] * shares
    height = _heights(z, invariant[:, None])
    air = _air(height)
    radius = EARTH_RADIUS_M + height
    integrand = radius * air.slope_per_m / (1.0 + air.refractivity + radius * air.slope_per_m)
    return np.asarray(integrand.mean(axis=1) * (z_high - z_low))


def _heights(z: FloatArray, invariant: FloatArray) -> FloatArray:
    """Altitudes where rays have zenith angles z: Newton's method on n r sin z."""
    height = np.clip(invariant / np.sin(np.maximum(z, 1e-9)) - EARTH_RADIUS_M, 0.0, _TOP_M)
    for _ in range(_NEWTON_STEPS):
        air = _air(height)
        radius = EARTH_RADIUS_M + height
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
