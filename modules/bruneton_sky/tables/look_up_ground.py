"""Light on surfaces, and the light of the ground."""

from typing import TYPE_CHECKING

import numpy as np

from bruneton_sky.tables.interpolate import interpolate
from bruneton_sky.tables.look_up_transmittance import transmittance_between, transmittance_to_sun
from bruneton_sky.tables.observer import View, dot, level, view_from
from bruneton_sky.tables.parametrisation_flat import irradiance_coordinates
from bruneton_sky.tables.travel import moved, to_edge
from vrut_lite.numeric_types import FloatArray

if TYPE_CHECKING:
    from bruneton_sky.tables.tables import Tables


def sun_and_sky_irradiance(
    tables: "Tables", point: FloatArray, normal: FloatArray, sun: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Irradiance (..., C) of the sun and of the sky on surfaces.

    The table knows level surfaces. A tilted one sees the share (1 + n . up) / 2 of the sky:
    the ambient occlusion by the ground's tangent plane (thesis, equation 2.26).
    """
    air = tables.atmosphere
    # From space the planet hides the sun less: there the sun's own ray tells where it passes.
    sunward = view_from(air, point, sun, sun)
    disc = _facing_sun(tables, sunward.state.altitude_m, sunward.state.mu)
    disc = np.where(sunward.misses[..., None], np.asarray(air.solar_irradiance), disc)
    up = point / np.linalg.norm(point, axis=-1, keepdims=True)
    facing = np.maximum(dot(normal, sun), 0.0)[..., None]
    # Two opposite unit vectors may have a product a rounding below -1.
    open_sky = np.maximum(0.5 * (1.0 + dot(normal, up)), 0.0)[..., None]
    return disc * facing, _level_sky(tables, *level(air, point, sun)) * open_sky


def ground_radiance(tables: "Tables", view: View) -> FloatArray:
    """Radiance (..., C) of the bare level ground at the end of rays, through the air before it.

    R[L0] and R^[L*] of the thesis's equations 2.12 and 2.26; 0 where a ray misses the ground.
    """
    air, state = tables.atmosphere, view.state
    distance = np.where(state.hits_ground, to_edge(air, state), 0.0)
    mu_s = moved(air, state, distance).mu_s
    ground = np.zeros_like(mu_s)
    lit = _facing_sun(tables, ground, mu_s) * np.maximum(mu_s, 0.0)[..., None]
    reflected = np.asarray(air.ground_albedo) / np.pi * (lit + _level_sky(tables, ground, mu_s))
    clear = transmittance_between(
        air, tables.transmittance, state.altitude_m, state.mu, distance, state.hits_ground
    )
    seen = (state.hits_ground & ~view.misses)[..., None]
    return np.where(seen, clear * reflected, 0.0)


def _facing_sun(tables: "Tables", altitude_m: FloatArray, mu_s: FloatArray) -> FloatArray:
    """Irradiance (..., C) of the visible disc on a plane that faces it."""
    clear = transmittance_to_sun(tables.atmosphere, tables.transmittance, altitude_m, mu_s)
    return np.asarray(tables.atmosphere.solar_irradiance) * clear


def _level_sky(tables: "Tables", altitude_m: FloatArray, mu_s: FloatArray) -> FloatArray:
    table = tables.irradiance
    return interpolate(
        table, irradiance_coordinates(tables.atmosphere, table.shape, altitude_m, mu_s)
    )
