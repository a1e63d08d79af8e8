"""Algorithm 5: the light that a point of the air scatters into a direction, from all others.

The points and suns are nodes of the tables, so the four-linear look-ups of arriving light need
no interpolation along altitude and mu_s, and the one along mu is made once for a zenith angle.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bruneton_sky.geometry import make_ray
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.published.pipeline.setting import (
    DENSITY_ZENITH_ANGLES,
    Part,
    Setting,
    densities,
    scattering_coefficients,
)
from bruneton_sky.tables.interpolate import interpolate, neighbours
from bruneton_sky.tables.look_ups import transmittance_between
from bruneton_sky.tables.parametrisations import (
    Coordinates,
    State,
    irradiance_coordinates,
    node_coordinates,
    texture_coordinate,
)
from bruneton_sky.tables.ray_lengths import ground_distance
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
        irradiance: (altitude, mu_s, C) of the ground by this light, or by the sun.
    """
    nodes = setting.nodes()
    density = np.zeros((*setting.sizes.scattering_shape, transmittance.shape[-1]))
    view_x, (sun_x, sun_y) = _sine(nodes.mu), _sun_across(nodes)
    step = np.pi / DENSITY_ZENITH_ANGLES
    azimuths = (np.arange(2 * DENSITY_ZENITH_ANGLES) + 0.5) * step
    for zenith in _zenith_angles(setting, transmittance, light):
        solid_angle = zenith.sine * step * step
        for x, y in zip(
            zenith.sine * np.cos(azimuths), zenith.sine * np.sin(azimuths), strict=True
        ):
            to_sun = sun_x * x + sun_y * y + nodes.mu_s * zenith.cosine
            to_view = view_x * x + nodes.mu * zenith.cosine
            radiance = _arriving(setting, zenith, irradiance, nodes, to_sun)
            density += _scattering(setting, nodes, to_view) * radiance * solid_angle
    return density


def _scattering(setting: Setting, nodes: State, nu: FloatArray) -> FloatArray:
    """Scattering (altitude, mu, 1, 1, C) by an angle, in 1/m and per steradian."""
    air = setting.atmosphere
    rayleigh_density, mie_density = densities(air, nodes.altitude_m)
    rayleigh, mie = scattering_coefficients(air)
    by_molecules = (rayleigh_density * rayleigh_phase(nu))[..., None] * rayleigh
    by_aerosol = (mie_density * mie_phase(air, nu))[..., None] * mie
    return by_molecules + by_aerosol


def _sun_across(nodes: State) -> tuple[FloatArray, FloatArray]:
    """The sun's direction along the view's azimuth and across it; any for a vertical view."""
    across = nodes.nu - nodes.mu * nodes.mu_s
    view_x = np.broadcast_to(_sine(nodes.mu), across.shape)
    x = np.divide(across, view_x, out=np.zeros_like(across), where=view_x > 0)
    return x, np.sqrt(np.maximum(1.0 - x * x - nodes.mu_s * nodes.mu_s, 0.0))


def _sine(cosine: FloatArray) -> FloatArray:
    return np.sqrt((1.0 - cosine) * (1.0 + cosine))


class _Zenith(NamedTuple):
    """Directions of one zenith angle from every node altitude.

    The tables of `parts` are (altitude, nu, mu_s, C). `distance_m` (altitude, 1, 1, 1) is that
    to the ground, and `reflected` (altitude, 1, 1, 1, C) what arrives from there per unit of
    irradiance; both are 0 where the directions miss the ground.
    """

    cosine: float
    sine: float
    parts: tuple[Part, ...]
    distance_m: FloatArray
    reflected: FloatArray


def _zenith_angles(
    setting: Setting, transmittance: FloatArray, light: tuple[Part, ...]
) -> Iterator[_Zenith]:
    """The zenith angles of Algorithm 5: midpoints of even steps from 0 to pi."""
    air, h = setting.atmosphere, setting.nodes().altitude_m
    for theta in (np.arange(DENSITY_ZENITH_ANGLES) + 0.5) * (np.pi / DENSITY_ZENITH_ANGLES):
        cosine = np.cos(theta)
        hits = make_ray(air.ground_radius_m, h, cosine).hits_ground()
        state = State(h, cosine, np.zeros(1), np.zeros(1), hits)
        distance = np.where(hits, ground_distance(air, h, cosine, hits), 0.0)
        clear = transmittance_between(air, transmittance, h, cosine, distance, hits)
        reflected = clear * hits[..., None] * np.asarray(air.ground_albedo) / np.pi
        parts = tuple(Part(_rows(setting, part.table, state), part.phase) for part in light)
        yield _Zenith(float(cosine), float(np.sin(theta)), parts, distance, reflected)


def _arriving(
    setting: Setting, zenith: _Zenith, irradiance: FloatArray, nodes: State, nu: FloatArray
) -> FloatArray:
    """Radiance (altitude, mu, nu, mu_s, C) from one azimuth of a zenith angle.

    Args:
        irradiance: (altitude, mu_s, C); its first row falls on the ground.
        nu: (altitude, mu, nu, mu_s), cosine between the direction and the sun.
    """
    light = sum(
        (_along_nu(part.table, nu) * part.phase(nu)[..., None] for part in zenith.parts),
        start=np.zeros(1),
    )
    if not zenith.reflected.any():
        return light
    air, ground = setting.atmosphere, setting.atmosphere.ground_radius_m
    # The ground's own vertical, where the direction meets it, is turned against the point's.
    mu_s = ((ground + nodes.altitude_m) * nodes.mu_s + zenith.distance_m * nu) / ground
    at = irradiance_coordinates(air, irradiance.shape, 0.0, np.clip(mu_s, -1.0, 1.0))
    return light + zenith.reflected * interpolate(irradiance[0], at[1:])


def _rows(setting: Setting, table: FloatArray, state: State) -> FloatArray:
    """A scattering table (altitude, nu, mu_s, C) at the mu of a state of its node altitudes."""
    _, mu, _, _ = setting.coordinates(state)
    sizes = setting.sizes
    axes = np.ix_(*map(node_coordinates, (sizes.altitude, 1, sizes.nu, sizes.mu_s)))
    at = Coordinates(axes[0], mu, axes[2], axes[3])
    return interpolate(table, at)[:, 0]


def _along_nu(table: FloatArray, nu: FloatArray) -> FloatArray:
    """A table (altitude, nu, mu_s, C) at its own altitudes and suns, and at nu (altitude, ...)."""
    altitudes, size, suns, _ = table.shape
    before, share = neighbours(texture_coordinate(0.5 * (1.0 + nu), size), size)
    altitude, sun = np.arange(altitudes)[:, None, None, None], np.arange(suns)
    near, far = table[altitude, before, sun], table[altitude, before + 1, sun]
    return near + share[..., None] * (far - near)
