"""Look-ups in tables: transmittance, the sky, the air before points, light on surfaces.

The transmittance table holds that to the top of the atmosphere; that between two points is a
ratio (thesis, equations 2.28 to 2.30). A ray that meets the ground is looked up backwards, for the
table knows no rays through the planet.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.tables.interpolate import interpolate, interpolate_suns
from bruneton_sky.tables.parametrisations import (
    State,
    Year,
    irradiance_coordinates,
    parametrisation_of,
    transmittance_coordinates,
)
from bruneton_sky.tables.rays import ViewState, after, dot, level, moved, to_edge, view_from
from bruneton_sky.tables.sizes import TableSizes, refuse_untabled, table_shapes
from vrut_lite.arguments import check_type
from vrut_lite.numeric_types import FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class TableArrays:
    """The tables of an atmosphere.

    Attributes:
        orders: highest order of scattering and reflection.
        parametrisation: of the two scattering tables.
        transmittance: (altitude, mu, C), to the top of the atmosphere.
        irradiance: (altitude, mu_s, C) of the sky on a level surface, W m^-2 nm^-1.
        scattering: (altitude, mu, nu, mu_s, C), W m^-2 sr^-1 nm^-1: light scattered once by
            molecules without its phase function, and all later orders over Rayleigh's.
        single_mie: likewise light scattered once by aerosol, without its phase function.

    Raises:
        ValueError: an array's shape differs from `sizes`, or the atmosphere has fog.
    """

    atmosphere: Atmosphere
    sizes: TableSizes
    orders: int
    parametrisation: Year
    transmittance: FloatArray
    irradiance: FloatArray
    scattering: FloatArray
    single_mie: FloatArray

    def __post_init__(self) -> None:
        parametrisation_of(self.parametrisation)
        refuse_untabled(self.atmosphere)
        for name, shape in table_shapes(self.atmosphere, self.sizes).items():
            check_type(f"{name} of the tables", getattr(self, name), np.ndarray)
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} of the tables must have the shape {shape}")


def transmittance_to_top(
    air: Atmosphere, table: FloatArray, altitude_m: ArrayLike, mu: ArrayLike
) -> FloatArray:
    """Transmittance (..., C) to the top of the atmosphere along a ray that misses the ground."""
    return interpolate(table, transmittance_coordinates(air, table.shape, altitude_m, mu))


def transmittance_between(
    air: Atmosphere,
    table: FloatArray,
    altitude_m: ArrayLike,
    mu: ArrayLike,
    distance_m: ArrayLike,
    hits_ground: ArrayLike,
) -> FloatArray:
    """Transmittance (..., C) along a ray's first metres, at most 1.

    It is 0 where both of the table's values underflow, in a haze no light crosses.
    """
    h, cosine = np.asarray(altitude_m, dtype=float), np.asarray(mu, dtype=float)
    there, mu_there = after(air, h, cosine, distance_m)
    back = np.where(hits_ground, -1.0, 1.0)
    near = transmittance_to_top(air, table, h, back * cosine)
    far = transmittance_to_top(air, table, there, back * mu_there)
    hits = np.asarray(hits_ground)[..., None]
    whole, rest = np.where(hits, far, near), np.where(hits, near, far)
    return np.minimum(np.divide(whole, rest, out=np.zeros_like(whole), where=rest > 0), 1.0)


def transmittance_to_sun(
    air: Atmosphere, table: FloatArray, altitude_m: ArrayLike, mu_s: ArrayLike
) -> FloatArray:
    """Transmittance (..., C) to the sun's disc, fading as the disc sinks below the horizon.

    The share of the disc that shows is a smooth step over its width (Bruneton 2017).
    """
    h, cosine = np.asarray(altitude_m, dtype=float), np.asarray(mu_s, dtype=float)
    ground = air.ground_radius_m
    half_width = air.sun_angular_radius_rad * ground / (ground + h)
    above = cosine - horizon_mu(ground, h)
    shown = smooth_step(-half_width, half_width, above)
    return transmittance_to_top(air, table, h, cosine) * shown[..., None]


def smooth_step(low: ArrayLike, high: ArrayLike, value: ArrayLike) -> FloatArray:
    """0 below `low`, 1 above `high`, a cubic between them."""
    start = np.asarray(low, dtype=float)
    t = np.clip((value - start) / (high - start), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def sky_radiance(
    tables: TableArrays, view: ViewState, shadow_length_m: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Radiance (..., C) of the air along whole rays, and transmittance (..., C) to space.

    The transmittance is 0 where the ground is in the way. With a shadow length, the first so
    many metres of the ray inside the air give no light (Bruneton and Neyret 2008, equation 17).
    """
    air, state = tables.atmosphere, view.state
    beyond = moved(air, state, shadow_length_m)
    dimmed = transmittance_between(
        air,
        tables.transmittance,
        state.altitude_m,
        state.mu,
        shadow_length_m,
        state.hits_ground,
    )
    dimmed = np.where(np.asarray(shadow_length_m)[..., None] > 0, dimmed, 1.0)
    radiance = with_phases(tables, state.nu, *(dimmed * part for part in scattered(tables, beyond)))
    clear = transmittance_to_top(air, tables.transmittance, state.altitude_m, state.mu)
    clear = np.where(state.hits_ground[..., None], 0.0, clear)
    misses = view.misses[..., None]
    return np.where(misses, 0.0, radiance), np.where(misses, 1.0, clear)


def scattered(tables: TableArrays, state: State) -> tuple[FloatArray, FloatArray]:
    """Values (..., C) of both scattering tables for states, without phase functions."""
    parametrisation = parametrisation_of(tables.parametrisation)
    at = parametrisation.to_coordinates(tables.atmosphere, tables.sizes, state)
    scattering, single_mie = interpolate_suns((tables.scattering, tables.single_mie), at)
    return scattering, single_mie


def with_phases(
    tables: TableArrays, nu: FloatArray, scattering: FloatArray, single_mie: FloatArray
) -> FloatArray:
    """Radiance (..., C) of values from both scattering tables."""
    cosine = nu[..., None]
    return scattering * rayleigh_phase(cosine) + single_mie * mie_phase(tables.atmosphere, cosine)


def radiance_to_point(
    tables: TableArrays, view: ViewState, distance_m: FloatArray, shadow_length_m: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Radiance (..., C) that the air adds on the way to points, and its transmittance.

    It is the difference of two whole rays, from the observer and from the point (Bruneton and
    Neyret 2008, equation 17); with a shadow length the last so many metres before the point
    give no light. A point outside the air, or hidden by the ground, counts as one at the
    edge; an observer outside it whose point comes before the air sees nothing of it.

    A difference of interpolated values errs: tables of the published sizes by day by 1 to 1.4 % rms
    (4 to 9 % at most) over 1 km and 0.3 to 0.4 % over 5 and 20 km, from 3 degrees above the level
    up. Where rays graze the ground it is worse: 15 % over a kilometre toward the horizon seen from
    1 km up, 30 % to the horizon seen from 2 m; where the planet's shadow covers the whole segment,
    some light leaks into it. `bruneton_sky.solve` has none of that; finer tables help too: 4 times
    as many altitudes, nu and mu_s and, for near things toward the horizon, as many nodes of the
    transmittance leave 0.1 to 1.3 % from 2 degrees up, 2 % at 1 degree.
    Bruneton's later remedy, to look up such rays 0.004 in mu above the horizon, is meant for
    textures of low precision, which these are not.
    """
    air, state = tables.atmosphere, view.state
    way = np.clip(distance_m - view.entry_m, 0.0, to_edge(air, state))
    lit = np.maximum(way - shadow_length_m, 0.0)
    ray = (air, tables.transmittance, state.altitude_m, state.mu)
    whole = transmittance_between(*ray, way, state.hits_ground)
    dimmed = transmittance_between(*ray, lit, state.hits_ground)
    near, beyond = scattered(tables, state), scattered(tables, moved(air, state, lit))
    rayleigh, mie = (here - dimmed * there for here, there in zip(near, beyond, strict=True))
    # Bruneton's: after sunset the difference of two aureoles is mostly their errors.
    mie = mie * smooth_step(0.0, 0.01, state.mu_s)[..., None]
    radiance = np.maximum(with_phases(tables, state.nu, rayleigh, mie), 0.0)
    misses = view.misses[..., None]
    return np.where(misses, 0.0, radiance), np.where(misses, 1.0, whole)


def sun_and_sky_irradiance(
    tables: TableArrays, point: FloatArray, normal: FloatArray, sun: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Irradiance (..., C) of the sun and of the sky on surfaces.

    The table knows level surfaces. A tilted one sees the share (1 + n . up) / 2 of the sky:
    the ambient occlusion by the ground's tangent plane (thesis, equation 2.26).
    """
    air = tables.atmosphere
    # From space the planet hides the sun less: there the sun's own ray gives its lowest point.
    sunward = view_from(air, point, sun, sun)
    disc = _facing_sun(tables, sunward.state.altitude_m, sunward.state.mu)
    disc = np.where(sunward.misses[..., None], np.asarray(air.solar_irradiance), disc)
    up = point / np.linalg.norm(point, axis=-1, keepdims=True)
    facing = np.maximum(dot(normal, sun), 0.0)[..., None]
    # Two opposite unit vectors may have a product a rounding below -1.
    open_sky = np.maximum(0.5 * (1.0 + dot(normal, up)), 0.0)[..., None]
    return disc * facing, _level_sky(tables, *level(air, point, sun)) * open_sky


def ground_radiance(tables: TableArrays, view: ViewState) -> FloatArray:
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


def _facing_sun(tables: TableArrays, altitude_m: FloatArray, mu_s: FloatArray) -> FloatArray:
    """Irradiance (..., C) of the visible disc on a plane that faces it."""
    clear = transmittance_to_sun(tables.atmosphere, tables.transmittance, altitude_m, mu_s)
    return np.asarray(tables.atmosphere.solar_irradiance) * clear


def _level_sky(tables: TableArrays, altitude_m: FloatArray, mu_s: FloatArray) -> FloatArray:
    table = tables.irradiance
    at = irradiance_coordinates(tables.atmosphere, table.shape, altitude_m, mu_s)
    return interpolate_suns((table,), at)[0]
