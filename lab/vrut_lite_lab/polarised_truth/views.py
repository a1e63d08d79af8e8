"""Rays that share a sky's solid angle evenly, and what a solved sky shows along them."""

from typing import NamedTuple

import numpy as np
from bruneton_sky import Atmosphere, SolvedSky

from vrut_lite.numeric_types import FloatArray

ALTITUDES_M = {"ground": 0.0, "5 km": 5e3, "300 km": 3e5}
# Cosines of the zenith angles between which each observer looks: from 300 km at the planet and up
# to 60 km of its limb.
_MU = {"ground": (0.02, 1.0), "5 km": (-1.0, 1.0), "300 km": (-1.0, -0.262)}
_NEAREST_SUN_DEG = 6.0
_GOLDEN = 0.618033988749895
_BEYOND_M = 1e9


class Rays(NamedTuple):
    """An observer's altitude in m and views (n,): the cosine of the zenith angle, the azimuth from
    the sun (radians), the cosine of the angle to the sun; the cosine of the sun's zenith angle."""

    altitude_m: float
    mu: FloatArray
    azimuth: FloatArray
    nu: FloatArray
    mu_s: float


def rays_of(observer: str, sun_zenith_deg: float, count: int) -> Rays:
    """Rays over half the sky, 6 degrees and more from the sun."""
    low, high = _MU[observer]
    place = np.arange(count)
    mu = low + (high - low) * (place + 0.5) / count
    azimuth = np.pi * ((place * _GOLDEN) % 1.0)
    mu_s = float(np.cos(np.radians(sun_zenith_deg)))
    nu = mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * np.cos(azimuth)
    far = nu < np.cos(np.radians(_NEAREST_SUN_DEG))
    return Rays(ALTITUDES_M[observer], mu[far], azimuth[far], nu[far], mu_s)


def solved_radiance(sky: SolvedSky, rays: Rays) -> FloatArray:
    """Radiance (n, C) of a solved sky along rays, with the ground that they meet."""
    air = sky.atmosphere
    light = sky.radiance(rays.altitude_m, rays.mu, rays.mu_s, rays.nu)
    meets = np.flatnonzero(_ground_distance(air, rays) > 0.0)
    if meets.size:
        mu, nu = rays.mu[meets], rays.nu[meets]
        light[meets], passed = sky.radiance_to_point(rays.altitude_m, mu, rays.mu_s, nu, _BEYOND_M)
        way_m = _ground_distance(air, rays)[meets]
        eye_m, ground_m = air.ground_radius_m + rays.altitude_m, air.ground_radius_m
        there = (eye_m * rays.mu_s + way_m * nu) / ground_m
        sun, skylight = sky.irradiance(0.0, there)
        lit = sun * np.maximum(there, 0.0)[:, None] + skylight
        light[meets] += passed * np.asarray(air.ground_albedo) / np.pi * lit
    return light


def _ground_distance(air: Atmosphere, rays: Rays) -> FloatArray:
    """Metres (n,) to the ground along rays that look down at it from above; 0 along others."""
    eye_m, ground_m = air.ground_radius_m + rays.altitude_m, air.ground_radius_m
    inside = ground_m**2 - eye_m**2 * (1.0 - rays.mu**2)
    down = (inside > 0.0) & (rays.mu < 0.0)
    return np.where(down, -eye_m * rays.mu - np.sqrt(np.maximum(inside, 0.0)), 0.0)
