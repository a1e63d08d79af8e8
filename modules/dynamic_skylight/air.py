"""A simple air to go with a measured or fitted sky: exponential layers, lit as the sky is.

Molecules and aerosol thin with height, over 8.4 km and as the haze does. Their scattered light is
known in total: an endless path must have the sky's radiance in its direction or, below the horizon,
that of the sky just above it. So light is the sky's, times 1 - T of the path over 1 - T of all the
air in that direction, and hills fade into the very sky behind them. The part that a shadow removes,
sunlight scattered once, is the sun's irradiance times albedo and phase function, by the shares of
molecules and aerosol at the eye, but at most nine tenths: the sky's aureole is softer than the
phase function. All of it counts as the molecules'. The rest is light scattered
again; with the sun below the horizon all light counts as such, though high air may still be lit.

The aerosol is the troposphere's (`SetHaze.optics`): that of the stratosphere lies behind the scene.
Molecules are those of the standard air, in one exponential with their column.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dynamic_skylight.daylight import Daylight
from vrut_lite.array import Array
from vrut_lite.atmosphere.aerosols import PhaseTable
from vrut_lite.atmosphere.air_colour import lost_and_depth, shares_of_white
from vrut_lite.atmosphere.clear_air import COLUMN_M, molecules_per_m
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.geometry.colour import SKYLIGHT_NM, solar_irradiance
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.haze import SetHaze
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.air_reach import UNSEEN_SHARE
from vrut_lite.sky.air_rows import AirGrid
from vrut_lite.sky.air_volume import (
    NodeRays,
    column_cosines,
    molecules_phase,
    node_rays,
    slice_shares,
)

TOP_ALTITUDE_M = 60_000.0
# From the ground the rows above the horizon and the columns are the twilight table's own: that is
# bilinear, and chords across its kinks would be up to 7 % too bright, a degree above the horizon.
SLICES, ROWS_ABOVE, ROWS_BELOW, COLUMNS = 32, 64, 24, 32
_MOST_SUNLIT = 0.9
# Largest factor on light at high altitudes, where little air must make the sky's light.
_LEAST_LOST = 0.02
# The model's radiance has an infinite slope on the horizon, which would draw a line across the
# hills at the eye's level: the sky `_SOFT_MU` higher is taken there, ever less to both sides, and
# from `_SHARP_MU` (1 degree) up none: there the air must not outshine the sky behind it.
_SOFT_MU, _SHARP_MU = 0.006, 0.0174
# The first node is at the eye, where light is a limit: it is taken at this share of a slice.
_FIRST_SHARE = 0.01
_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(6)


class Layers(NamedTuple):
    """Molecules, aerosol, and aerosol aloft.

    `scale_height_m` (3,); `extinction` (3, 4) in 1/m at the ground, at SKYLIGHT_NM; `albedo` (3,)
    of the aerosol's scattering of red, green and blue, `phase` (..., 3) its phase function of the
    cosine (...,), in sr^-1.
    """

    scale_height_m: FloatArray
    extinction: FloatArray
    albedo: FloatArray
    phase: PhaseTable


@lru_cache(maxsize=8)
def layers_of(haze: SetHaze) -> Layers:
    """The air of a haze."""
    optics = haze.optics
    heights_m = np.array([COLUMN_M, *(layer.height_m for layer in optics.layers)])
    low, aloft = (layer.depth_at(SKYLIGHT_NM) for layer in haze.troposphere_layers)
    # The colour of a channel's light is that of the wavelengths near it: negative shares, of
    # others, would make no phase function.
    near = np.maximum(_shares(), 0.0)
    near /= near.sum(axis=0)
    return Layers(
        heights_m,
        np.stack([molecules_per_m(SKYLIGHT_NM), low / heights_m[1], aloft / heights_m[2]]),
        optics.albedo_at(SKYLIGHT_NM) @ near,
        optics.phase_at(SKYLIGHT_NM).at_rows(near.T),
    )


def air_is_seen(haze: SetHaze, altitude_m: float, reach_m: float) -> bool:
    """Whether the air may be visible: an upper bound by the density of the lowest air in reach."""
    if reach_m <= 0.0:
        return False
    lowest_m = max(min(altitude_m, TOP_ALTITUDE_M) - reach_m, 0.0)
    layers = layers_of(haze)
    densest = np.exp(-lowest_m / layers.scale_height_m) @ layers.extinction
    return bool(-np.expm1(-densest.max() * reach_m) > UNSEEN_SHARE)


def air_volume(
    daylight: Daylight, sun_direction: Vector, altitude_m: float, reach_m: float
) -> AirVolume:
    """The air around an observer; the sun's direction is the apparent one, in world axes."""
    grid = AirGrid(altitude_m, GROUND_RADIUS_M, TOP_ALTITUDE_M, reach_m, ROWS_ABOVE, ROWS_BELOW)
    rays = node_rays(grid, COLUMNS, float(np.clip(sun_direction[1], -1.0, 1.0)))
    layers = layers_of(daylight.air_haze)
    depth = _depths(rays, layers, _distances(rays.span_m, altitude_m))
    light = _mean_light(daylight, grid, rays, layers)
    values, scale = encode_float16(light.astype(np.float32))
    return AirVolume(
        # The same at every distance.
        light=Array(np.repeat(values[:, None], SLICES, axis=1)),
        columns=COLUMNS,
        extinction=Array(np.ascontiguousarray(np.moveaxis(depth, 0, 1), dtype=np.float32)),
        radiance_scale=scale,
        # There is no light that it would be multiplied by.
        aerosol_phase=Array(np.full((2, 3), 0.25 / np.pi, dtype=np.float32)),
        sun_direction=sun_direction,
        **grid._asdict(),
    )


def _mean_light(daylight: Daylight, grid: AirGrid, rays: NodeRays, layers: Layers) -> FloatArray:
    """Mean radiance (3, rows, columns, 3): light scattered again, scattered once over the phase
    function of molecules, nothing."""
    sky = _sky_behind(daylight, rays, grid.rows_above)
    total = sky / np.maximum(_whole_lost(grid, rays, layers), _LEAST_LOST)[:, None]
    sunlit = np.minimum(_sunlit(daylight, grid, rays, layers), _MOST_SUNLIT * total)
    over_phase = sunlit / molecules_phase(rays.nu)[..., None]
    return np.stack([total - sunlit, over_phase, np.zeros_like(total)])


def _sky_behind(daylight: Daylight, rays: NodeRays, rows_above: int) -> FloatArray:
    """The sky's radiance (rows, columns, 3); below the level, more and more that on the horizon."""
    up = np.where(np.arange(rays.mu.size) < rows_above, np.maximum(rays.mu, 0.0), rays.mu)
    higher = 0.5 * (np.hypot(up, 2.0 * _SOFT_MU) - up)
    fade = (1.0 - np.clip(up / _SHARP_MU, 0.0, 1.0) ** 2) ** 2
    mu = up + higher * fade
    sun = daylight.sky.sun_elevation_rad
    level = np.sqrt((1.0 - mu) * (1.0 + mu)) * np.cos(sun)
    nu = mu[:, None] * np.sin(sun) + level[:, None] * column_cosines(rays.nu.shape[1])
    gamma = np.arccos(np.clip(nu, -1.0, 1.0))
    return daylight.sky.radiance(np.broadcast_to(np.arccos(mu)[:, None], gamma.shape), gamma)


def _whole_lost(grid: AirGrid, rays: NodeRays, layers: Layers) -> FloatArray:
    """1 - T (rows, 3) of all the air in each direction; below the horizon, of that on it."""
    endless = node_rays(grid._replace(reach_m=np.inf), 1, 0.0)
    above = NodeRays(*(part[: grid.rows_above] for part in endless))
    distance = _distances(above.span_m, grid.observer_altitude_m)
    paths = _paths(above, distance, layers)[:, -1]
    lost, _ = lost_and_depth(-np.expm1(-paths @ layers.extinction), _shares())
    return np.concatenate([lost, np.broadcast_to(lost[:1], (grid.rows_below, 3))])


def _sunlit(daylight: Daylight, grid: AirGrid, rays: NodeRays, layers: Layers) -> FloatArray:
    """Radiance (rows, columns, 3) of sunlight scattered once, per extinction of the eye's air."""
    thinner = np.exp(-grid.observer_altitude_m / layers.scale_height_m)[:, None]
    here = thinner * (layers.extinction @ _shares())
    of_molecules = here[0] / np.maximum(here.sum(axis=0), 1e-300)
    of_aerosol = 1.0 - of_molecules
    nu = rays.nu[..., None]
    molecules = 3.0 / (16.0 * np.pi) * (1.0 + nu * nu)
    scattered = of_molecules * molecules + layers.albedo * of_aerosol * layers.phase(rays.nu)
    return np.asarray(daylight.sun.irradiance_rgb * scattered)


def _depths(rays: NodeRays, layers: Layers, distance: FloatArray) -> FloatArray:
    """Extinction (rows, slices, 3) in 1/m, mean up to the distances."""
    lost = -np.expm1(-_paths(rays, distance, layers) @ layers.extinction)
    return lost_and_depth(lost, _shares())[1] / distance[..., None]


def _distances(span_m: FloatArray, altitude_m: float) -> FloatArray:
    """Distances (rows, slices) of the nodes, the first of them a little before the eye."""
    shares = slice_shares(SLICES, altitude_m)
    shares[0] = _FIRST_SHARE * shares[1]
    return span_m[:, None] * shares


def _paths(rays: NodeRays, distance: FloatArray, layers: Layers) -> FloatArray:
    """Paths (rows, slices, 3) in m through each layer up to the distances; by Gauss-Legendre."""
    start = np.concatenate([np.zeros_like(distance[:, :1]), distance[:, :-1]], axis=1)
    half = 0.5 * (distance - start)[..., None]
    metres = start[..., None] + half * (1.0 + _GAUSS_X)
    radius = GROUND_RADIUS_M + rays.altitude_m[:, None, None]
    step = metres * (metres + 2.0 * radius * rays.mu[:, None, None])
    rise = step / (np.sqrt(np.maximum(step + radius * radius, 0.0)) + radius)
    altitude = np.maximum(rays.altitude_m[:, None, None] + rise, 0.0)
    density = np.exp(-altitude[..., None] / layers.scale_height_m)
    return np.cumsum(np.einsum("rsg,rsgk->rsk", half * _GAUSS_W, density), axis=1)


def _shares() -> FloatArray:
    return shares_of_white(SKYLIGHT_NM, solar_irradiance(SKYLIGHT_NM))
