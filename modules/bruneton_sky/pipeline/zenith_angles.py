"""Light that arrives at the nodes' points from all directions of one zenith angle.

The points and suns are nodes of the tables, so of the four-linear look-ups those along
altitude and mu_s fall away, and the one along mu is made once for a zenith angle.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bruneton_sky.geometry import make_ray
from bruneton_sky.pipeline.incident import Part
from bruneton_sky.pipeline.setting import DENSITY_ZENITH_ANGLES, Setting
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


class Zenith(NamedTuple):
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


def zenith_angles(
    setting: Setting, transmittance: FloatArray, light: tuple[Part, ...]
) -> Iterator[Zenith]:
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
        yield Zenith(float(cosine), float(np.sin(theta)), parts, distance, reflected)


def arriving(
    setting: Setting, zenith: Zenith, irradiance: FloatArray, nodes: State, nu: FloatArray
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
