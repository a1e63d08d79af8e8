"""Where the nodes of an `AirVolume` lie, and what light its values make: the twin of air.glsl.

Slices are distances from where a ray enters the air (the eye, if that is inside it), the square
of what is uniform: dense near the eye. Rows are heights of view directions,
mu = mu_h + (mu_top - mu_h) x^2 above the horizon and mu_h - (1 + mu_h) x^2 below it, x uniform in
[0, 1]: dense toward the horizon, where radiance changes fast; mu_top is the zenith, or the edge of
the air for an eye above it. Columns are t = sin(phi / 2), uniform in [0, 1], phi the azimuth from
the sun: light is even about the sun's vertical plane.

A ray does not end at the ground's level: below it the air counts as at level 0. So no value jumps
at the horizon, and things that stand below the level are served too.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.kernel.messages import AirVolume

FloatArray = NDArray[np.float64]


class AirLight(NamedTuple):
    """What air does before points (...,): transmittance (..., 3), and light added (..., 3)."""

    transmittance: FloatArray
    shaded: FloatArray
    sunlit: FloatArray


def slice_distances_m(slices: int, reach_m: float) -> FloatArray:
    """Distances (slices,) from where the ray enters the air; the first is 0, the last `reach_m`."""
    return reach_m * np.linspace(0.0, 1.0, slices) ** 2


def horizon_depth(volume: AirVolume) -> FloatArray:
    """1 + mu (2,) of the ground's horizon and of the highest row, for the volume's observer."""
    return row_depth(volume.ground_radius_m, volume.top_altitude_m, volume.observer_altitude_m)


def row_depth(ground_radius_m: float, top_altitude_m: float, altitude_m: float) -> FloatArray:
    """1 + mu (2,) of the ground's horizon, and of the zenith or, from above, the air's edge."""
    inside = altitude_m <= top_altitude_m
    edge = 2.0 if inside else _grazing_depth(ground_radius_m, top_altitude_m, altitude_m)
    return np.array([_grazing_depth(ground_radius_m, 0.0, altitude_m), edge])


def row_heights(depth: FloatArray, rows_above: int, rows_below: int) -> FloatArray:
    """1 + mu (rows,) of the rows, those above the horizon first, each from the horizon on."""
    up, down = (np.linspace(0.0, 1.0, rows) ** 2 for rows in (rows_above, rows_below))
    return np.concatenate([depth[0] + (depth[1] - depth[0]) * up, depth[0] * (1.0 - down)])


def column_cosines(columns: int) -> FloatArray:
    """Cosines (columns,) of the azimuth from the sun."""
    return 1.0 - 2.0 * np.linspace(0.0, 1.0, columns) ** 2


def entry_distance_m(volume: AirVolume, direction: ArrayLike) -> FloatArray:
    """How far from the eye rays (..., 3) enter the air: 0 inside it, infinite if they miss it."""
    mu = np.asarray(direction, dtype=float)[..., 1]
    above_m = volume.observer_altitude_m - volume.top_altitude_m
    if above_m <= 0.0:
        return np.zeros_like(mu)
    radius = volume.ground_radius_m + volume.observer_altitude_m
    top_radius = volume.ground_radius_m + volume.top_altitude_m
    sine_squared = (1.0 - mu) * (1.0 + mu)
    # Half the chord in the air; the difference of squares is factored.
    squared = above_m * -(radius + top_radius) + (radius * mu) ** 2
    hits = (squared >= 0.0) & (mu < 0.0) & (sine_squared <= (top_radius / radius) ** 2)
    half_chord = np.sqrt(np.maximum(squared, 0.0))
    entry = above_m * (radius + top_radius) / np.maximum(half_chord - radius * mu, 1e-300)
    return np.where(hits, entry, np.inf)


def look_up_air(volume: AirVolume, direction: ArrayLike, distance_m: ArrayLike) -> AirLight:
    """The air before points in directions (..., 3), unit vectors, at distances (...,).

    Past the volume's reach, as at its end. `sunlit` is what a shadow would take away.
    """
    view, metres = np.asarray(direction, dtype=float), np.asarray(distance_m, dtype=float)
    entry = entry_distance_m(volume, view)
    inside_m = np.clip(np.where(np.isfinite(entry), metres - entry, 0.0), 0.0, volume.reach_m)
    row = _rows_of(volume, view)
    slices = volume.extinction.shape[0]
    depth = np.sqrt(inside_m / volume.reach_m) * (slices - 1)
    column = _columns_of(volume, view)
    extinction = _blend(volume.extinction.values[:, :, None], depth, row, np.zeros_like(column))
    optical_depth = extinction * inside_m[..., None]
    weight = -np.expm1(-optical_depth) * volume.radiance_scale
    shaded, direct, aerosol = (
        weight * _blend(part.values, depth, row, column)
        for part in (volume.shaded, volume.direct, volume.aerosol)
    )
    nu = view @ np.asarray(volume.sun_direction)
    sunlit = direct + aerosol * aerosol_phase(volume, nu)[..., None]
    return AirLight(np.exp(-optical_depth), shaded, sunlit)


def aerosol_phase(volume: AirVolume, nu: ArrayLike) -> FloatArray:
    """The aerosol's phase function (...,) in sr^-1, of the cosine of the angle to the sun."""
    cosine = np.asarray(nu, dtype=float)
    g, factor, form = volume.aerosol_phase
    spread = (1.0 - g) ** 2 + 2.0 * g * (1.0 - cosine)
    return np.asarray(factor * (1.0 + form * cosine * cosine) / spread**1.5)


def _grazing_depth(ground_radius_m: float, grazed_altitude_m: float, altitude_m: float) -> float:
    """1 + mu of the ray that descends from an altitude to graze a lower one."""
    radius, grazed = ground_radius_m + altitude_m, ground_radius_m + grazed_altitude_m
    sine = grazed / radius
    cosine = np.sqrt(max(altitude_m - grazed_altitude_m, 0.0) * (radius + grazed)) / radius
    return float(sine * sine / (1.0 + cosine))


def _rows_of(volume: AirVolume, view: FloatArray) -> FloatArray:
    """Which row (...,), as a fraction, a direction lies on."""
    level = view[..., 0] ** 2 + view[..., 2] ** 2
    # 1 + mu without cancellation near the nadir, where a far observer has all of the planet.
    one_plus = np.where(
        view[..., 1] < 0.0, level / (1.0 + np.abs(view[..., 1])), 1.0 + view[..., 1]
    )
    depth = horizon_depth(volume)
    above = one_plus >= depth[0]
    up = np.sqrt(np.clip((one_plus - depth[0]) / (depth[1] - depth[0]), 0.0, 1.0))
    down = np.sqrt(np.clip((depth[0] - one_plus) / depth[0], 0.0, 1.0))
    lowest = volume.rows_above + down * (volume.rows_below - 1)
    return np.where(above, up * (volume.rows_above - 1), lowest)


def _columns_of(volume: AirVolume, view: FloatArray) -> FloatArray:
    """Which column (...,), as a fraction; the zenith, which has no azimuth, is on the first."""
    azimuth = _level(np.asarray(volume.sun_direction, dtype=float))
    # Half the chord between level unit vectors is the sine of half the azimuth.
    chord = np.linalg.norm(_level(view) - azimuth, axis=-1)
    return np.minimum(0.5 * chord, 1.0) * (volume.shaded.shape[2] - 1)


def _level(direction: FloatArray) -> FloatArray:
    """Unit vectors (..., 2) of azimuths, (x, z); north under a zenith."""
    level = direction[..., [0, 2]]
    length = np.linalg.norm(level, axis=-1, keepdims=True)
    north = np.array([0.0, -1.0])
    return np.where(length > 1e-12, level / np.maximum(length, 1e-300), north)


def _blend(values: NDArray, depth: FloatArray, row: FloatArray, column: FloatArray) -> FloatArray:
    """Values (..., 3) between nodes (slices, rows, columns, 3), linear in all three."""
    out: FloatArray = np.zeros((*depth.shape, values.shape[-1]))
    corners = [
        _ends(at, size) for at, size in zip((depth, row, column), values.shape, strict=False)
    ]
    for i, wi in corners[0]:
        for j, wj in corners[1]:
            for k, wk in corners[2]:
                out += (wi * wj * wk)[..., None] * values[i, j, k].astype(float)
    return out


def _ends(at: FloatArray, size: int) -> tuple[tuple[NDArray[np.intp], FloatArray], ...]:
    """The two nodes about a place, and their shares."""
    low = np.clip(at.astype(np.intp), 0, max(size - 2, 0))
    share = np.clip(at - low, 0.0, 1.0)
    return (low, 1.0 - share), (np.minimum(low + 1, size - 1), share)
