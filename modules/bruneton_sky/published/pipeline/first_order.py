"""Algorithms 2, 3 and 4: transmittance, the sun on level surfaces, light scattered once."""

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import altitude_along, distance_to_top
from bruneton_sky.published.pipeline.setting import (
    RAY_INTERVALS,
    TRANSMITTANCE_INTERVALS,
    Setting,
    densities,
    scattering_coefficients,
    trapezoid,
)
from bruneton_sky.tables.look_ups import (
    transmittance_between,
    transmittance_to_sun,
    transmittance_to_top,
)
from bruneton_sky.tables.parametrisations import (
    irradiance_state,
    node_coordinates,
    transmittance_state,
)
from bruneton_sky.tables.rays import moved, to_edge
from vrut_lite.numeric_types import FloatArray


def transmittance(setting: Setting) -> FloatArray:
    """Algorithm 2: the transmittance (altitude, mu, C) to the top of the atmosphere.

    Bruneton's densities stop at 1, the ground's; a ray along the ground may dip below it by a
    rounding error, which the trapezoid rule does not notice.
    """
    air, sizes = setting.atmosphere, setting.sizes
    shape = sizes.transmittance_altitude, sizes.transmittance_mu
    h, mu = transmittance_state(air, shape, *np.ix_(*map(node_coordinates, shape)))
    length = distance_to_top(air.ground_radius_m, air.top_altitude_m, h, mu)
    paths = np.zeros((3, *shape))
    for distance, metres in trapezoid(length, TRANSMITTANCE_INTERVALS):
        altitude = altitude_along(air.ground_radius_m, h, mu, distance)
        paths += metres * np.stack([*densities(air, altitude), air.absorber(altitude)])
    extinction = air.rayleigh_scattering, air.mie_extinction, air.absorption_extinction
    return np.exp(-np.tensordot(paths, np.asarray(extinction), axes=(0, 0)))


def direct_irradiance(setting: Setting, transmittance: FloatArray) -> FloatArray:
    """Algorithm 3: irradiance (altitude, mu_s, C) of level surfaces by the sun, W m^-2 nm^-1."""
    air = setting.atmosphere
    h, mu_s = irradiance_nodes(setting)
    clear = transmittance_to_top(air, transmittance, h, mu_s)
    return np.asarray(air.solar_irradiance) * clear * disc_cosine(air, mu_s)[..., None]


def disc_cosine(air: Atmosphere, mu_s: FloatArray) -> FloatArray:
    """Approximate mean cosine (...,) over the part of a disc above a level surface.

    mu_s itself where the whole disc shows, 0 where none does, a parabola between them.
    """
    a = air.sun_angular_radius_rad
    rising = (mu_s + a) ** 2 / (4.0 * a)
    return np.where(mu_s < -a, 0.0, np.where(mu_s > a, mu_s, rising))


def irradiance_nodes(setting: Setting) -> tuple[FloatArray, FloatArray]:
    """Altitude in m and mu_s at the nodes of an irradiance table; they broadcast."""
    shape = setting.sizes.irradiance_altitude, setting.sizes.irradiance_mu_s
    return irradiance_state(setting.atmosphere, shape, *np.ix_(*map(node_coordinates, shape)))


def single_scattering(setting: Setting, transmittance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Algorithm 4: light scattered once by molecules and by aerosol, without phase functions.

    Two tables (altitude, mu, nu, mu_s, C).
    """
    air, nodes = setting.atmosphere, setting.nodes()
    shape = (*setting.sizes.scattering_shape, len(air.wavelength_nm))
    rayleigh, mie = np.zeros(shape), np.zeros(shape)
    ray = (air, transmittance, nodes.altitude_m, nodes.mu)
    for distance, metres in trapezoid(to_edge(air, nodes), RAY_INTERVALS):
        there = moved(air, nodes, distance)
        light = transmittance_to_sun(air, transmittance, there.altitude_m, there.mu_s)
        light *= transmittance_between(*ray, distance, nodes.hits_ground) * metres[..., None]
        rayleigh_density, mie_density = densities(air, there.altitude_m)
        rayleigh += light * rayleigh_density[..., None]
        mie += light * mie_density[..., None]
    sun = np.asarray(air.solar_irradiance)
    rayleigh_scattering, mie_scattering = scattering_coefficients(air)
    return rayleigh * sun * rayleigh_scattering, mie * sun * mie_scattering
