"""Algorithm 4: light scattered once."""

import numpy as np

from bruneton_sky.pipeline.setting import (
    RAY_INTERVALS,
    Setting,
    densities,
    scattering_coefficients,
)
from bruneton_sky.pipeline.trapezoid import trapezoid
from bruneton_sky.tables.look_ups import transmittance_between, transmittance_to_sun
from bruneton_sky.tables.rays import moved, to_edge
from vrut_lite.numeric_types import FloatArray


def single_scattering(setting: Setting, transmittance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Molecules' and aerosol's tables (altitude, mu, nu, mu_s, C), without phase functions."""
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
