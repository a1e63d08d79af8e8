"""Algorithm 5: the light that a point of the air scatters into a direction, from all others."""

import numpy as np

from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.pipeline.incident import Part
from bruneton_sky.pipeline.setting import (
    DENSITY_ZENITH_ANGLES,
    Setting,
    densities,
    scattering_coefficients,
)
from bruneton_sky.pipeline.zenith_angles import arriving, zenith_angles
from bruneton_sky.tables.parametrisations import State
from vrut_lite.numeric_types import FloatArray


def scattering_density(
    setting: Setting,
    transmittance: FloatArray,
    light: tuple[Part, ...],
    irradiance: FloatArray,
) -> FloatArray:
    """The table (altitude, mu, nu, mu_s, C), W m^-3 sr^-1 nm^-1.

    Directions lie on a grid of zenith angles and azimuths about a point's vertical; azimuth 0
    is the view's.

    Args:
        light: of the order before.
        irradiance: (altitude, mu_s, C) that this light, or the sun's own, sheds on the ground.
    """
    nodes = setting.nodes()
    density = np.zeros((*setting.sizes.scattering_shape, transmittance.shape[-1]))
    view_x, (sun_x, sun_y) = _sine(nodes.mu), _sun_across(nodes)
    step = np.pi / DENSITY_ZENITH_ANGLES
    azimuths = (np.arange(2 * DENSITY_ZENITH_ANGLES) + 0.5) * step
    for zenith in zenith_angles(setting, transmittance, light):
        solid_angle = zenith.sine * step * step
        for x, y in zip(
            zenith.sine * np.cos(azimuths), zenith.sine * np.sin(azimuths), strict=True
        ):
            to_sun = sun_x * x + sun_y * y + nodes.mu_s * zenith.cosine
            to_view = view_x * x + nodes.mu * zenith.cosine
            radiance = arriving(setting, zenith, irradiance, nodes, to_sun)
            density += _scattering(setting, nodes, to_view) * radiance * solid_angle
    return density


def _scattering(setting: Setting, nodes: State, nu: FloatArray) -> FloatArray:
    """What is scattered (altitude, mu, 1, 1, C) by an angle, in 1/m and per steradian."""
    air = setting.atmosphere
    rayleigh_density, mie_density = densities(air, nodes.altitude_m)
    rayleigh, mie = scattering_coefficients(air)
    by_molecules = (rayleigh_density * rayleigh_phase(nu))[..., None] * rayleigh
    by_aerosol = (mie_density * mie_phase(air, nu))[..., None] * mie
    return by_molecules + by_aerosol


def _sun_across(nodes: State) -> tuple[FloatArray, FloatArray]:
    """The sun's direction along the view's azimuth and across it; any, where the view has none."""
    across = nodes.nu - nodes.mu * nodes.mu_s
    view_x = np.broadcast_to(_sine(nodes.mu), across.shape)
    x = np.divide(across, view_x, out=np.zeros_like(across), where=view_x > 0)
    return x, np.sqrt(np.maximum(1.0 - x * x - nodes.mu_s * nodes.mu_s, 0.0))


def _sine(cosine: FloatArray) -> FloatArray:
    return np.sqrt((1.0 - cosine) * (1.0 + cosine))
