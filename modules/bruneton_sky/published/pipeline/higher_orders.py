"""Algorithms 6 and 7: irradiance of the ground and radiance of views by one order of scattering."""

import numpy as np

from bruneton_sky.published.pipeline.first_order import irradiance_nodes
from bruneton_sky.published.pipeline.setting import (
    IRRADIANCE_ZENITH_ANGLES,
    RAY_INTERVALS,
    Part,
    Setting,
    radiance,
    trapezoid,
)
from bruneton_sky.tables.look_ups import transmittance_between
from bruneton_sky.tables.parametrisations import State
from bruneton_sky.tables.rays import moved, to_edge
from vrut_lite.numeric_types import FloatArray


def indirect_irradiance(setting: Setting, light: tuple[Part, ...]) -> FloatArray:
    """Algorithm 6: irradiance (altitude, mu_s, C) of level surfaces by one order, W m^-2 nm^-1.

    Midpoints of even steps over the upper half of the sphere; azimuth 0 is the sun's.
    """
    altitude, mu_s = (axis[..., None] for axis in irradiance_nodes(setting))
    sun_x = np.sqrt((1.0 - mu_s) * (1.0 + mu_s))
    step = np.pi / IRRADIANCE_ZENITH_ANGLES
    azimuths = (np.arange(2 * IRRADIANCE_ZENITH_ANGLES) + 0.5) * step
    irradiance = 0.0
    for theta in (np.arange(IRRADIANCE_ZENITH_ANGLES // 2) + 0.5) * step:
        mu, sine = np.cos(theta), np.sin(theta)
        nu = sine * np.cos(azimuths) * sun_x + mu * mu_s
        arriving = radiance(setting, light, State(altitude, mu, mu_s, nu, np.asarray(False)))
        irradiance = irradiance + arriving.sum(axis=-2) * (mu * sine * step * step)
    return np.asarray(irradiance)


def multiple_scattering(
    setting: Setting, transmittance: FloatArray, density: FloatArray
) -> FloatArray:
    """Algorithm 7: radiance (altitude, mu, nu, mu_s, C), W m^-2 sr^-1 nm^-1.

    The integral of a scattering density (of the same axes) along the views.
    """
    air, nodes = setting.atmosphere, setting.nodes()
    gathered = np.zeros_like(density)
    ray = (air, transmittance, nodes.altitude_m, nodes.mu)
    for distance, metres in trapezoid(to_edge(air, nodes), RAY_INTERVALS):
        clear = transmittance_between(*ray, distance, nodes.hits_ground) * metres[..., None]
        gathered += clear * setting.look_up(density, moved(air, nodes, distance))
    return gathered
