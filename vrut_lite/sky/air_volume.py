"""Nodes and look-up of an `AirVolume`: the float64 twin of air.glsl.

Slices divide a ray's span. The span begins where the ray enters the air (at the eye, if it is in
the air) and ends after `reach_m`, or earlier where the ray leaves the air or meets `BELOW_LEVEL_M`
under the ground's level. Slices lie at the shares u (2 b + (1 - 2 b) u) of the span, u uniform in
[0, 1]: dense near an eye on the ground (b = 0), uniform at 5 km, and dense near the ground, where
the haze is, for a higher eye. Rows are zenith angles of view directions: see `air_rows`. Columns
are t = sin(phi / 2), uniform in [0, 1], with phi the azimuth from the sun: light is symmetric about
the sun's vertical plane. A second body's light has the same slices and rows; its columns count from
that body's azimuth.

A ray does not end at the ground's level: below it the air is that of altitude 0. So values are
continuous at the horizon, and objects below the level get air too.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.air_rows import BELOW_LEVEL_M, AirGrid, grid_of, row_heights, rows_of

# Altitude (m) of the eye at which slices are uniform.
_EVEN_ALTITUDE_M = 5000.0
# Lower bound of spans, which would be zero for rays that graze the edge of the air or start on it.
SHORTEST_SPAN_M = 1.0
# Least extinction, because the logarithm of zero is infinite.
_LEAST_EXTINCTION_PER_M = 1e-15


class AirLight(NamedTuple):
    """Air between eye and points (...,): transmittance (..., 3) and added radiance (..., 3).

    `shaded` is the radiance that remains in the shadow of the scene, `sunlit` the rest, from the
    body that casts it.
    """

    transmittance: FloatArray
    shaded: FloatArray
    sunlit: FloatArray


class NodeRays(NamedTuple):
    """The rays of a volume's rows (r,) and columns (c,).

    `altitude_m`, `mu`: altitude and zenith cosine where a ray enters the air, or at the eye.
    `span_m`: the length that the slices divide. `mu_s`, `nu` (r, c): cosines of the sun's zenith
    angle at the ray's start and of the angle between ray and sun.
    """

    altitude_m: FloatArray
    mu: FloatArray
    span_m: FloatArray
    mu_s: FloatArray
    nu: FloatArray


def light_of(volume: AirVolume) -> NDArray[np.floating]:
    """The light (3, slices, rows, columns, 3) of a volume.

    Raises:
        ValueError: the light stays on the GPU.
    """
    if isinstance(volume.light, GpuTexture):
        raise ValueError("the light of this air stays on the GPU: ask for air made on the CPU")
    return volume.light.values


def slice_shares(slices: int, observer_altitude_m: float) -> FloatArray:
    """Share (slices,) of a ray's span before each slice, from 0 to 1."""
    even, u = evenness(observer_altitude_m), np.linspace(0.0, 1.0, slices)
    return u * (2.0 * even + (1.0 - 2.0 * even) * u)


def span_m(
    grid: AirGrid, start_altitude_m: ArrayLike, mu: ArrayLike, below: ArrayLike
) -> FloatArray:
    """Length (...,) of rays that the slices divide, in m.

    Args:
        start_altitude_m, mu: altitude and zenith cosine where the ray enters the air, or at an
            eye in the air.
        below: whether the ray points below the ground's horizon.
    """
    start = np.asarray(start_altitude_m, dtype=float)
    along = (grid.ground_radius_m + start) * np.asarray(mu, dtype=float)
    sum_m = 2.0 * grid.ground_radius_m + start
    # To the sphere below the level; for a ray that misses it, to the tangent point or beyond.
    down = (start + BELOW_LEVEL_M) * (sum_m - BELOW_LEVEL_M)
    root = np.sqrt(np.maximum(along * along - down, 0.0))
    to_depth = down / np.maximum(root - along, 1e-30)
    # To the edge of the air, from inside.
    up = np.maximum(grid.top_altitude_m - start, 0.0) * (sum_m + grid.top_altitude_m)
    root = np.sqrt(along * along + up)
    to_edge = np.where(along > 0.0, up / np.maximum(root + along, 1e-300), root - along)
    whole = np.where(below, to_depth, to_edge)
    return np.clip(whole, min(SHORTEST_SPAN_M, grid.reach_m), grid.reach_m)


def node_rays(grid: AirGrid, columns: int, mu_s: float) -> NodeRays:
    """The rays of all nodes; mu_s is the cosine of the sun's zenith angle at the observer."""
    one_plus = row_heights(grid)
    mu, sine = one_plus - 1.0, np.sqrt(one_plus * (2.0 - one_plus))
    across = sine * np.sqrt((1.0 - mu_s) * (1.0 + mu_s))
    nu = np.clip((mu * mu_s)[:, None] + across[:, None] * column_cosines(columns), -1.0, 1.0)
    below = np.arange(mu.size) >= grid.rows_above
    suns = np.full(nu.shape, mu_s)
    start, entering = np.full(mu.shape, grid.observer_altitude_m), mu
    if grid.observer_altitude_m > grid.top_altitude_m:
        radius = grid.ground_radius_m + grid.observer_altitude_m
        top_radius = grid.ground_radius_m + grid.top_altitude_m
        half_chord, entry = _entry(grid, mu, sine)
        start, entering = np.full(mu.shape, grid.top_altitude_m), -half_chord / top_radius
        suns = np.clip((radius * mu_s + entry[:, None] * nu) / top_radius, -1.0, 1.0)
    return NodeRays(start, entering, span_m(grid, start, entering, below), suns, nu)


def column_cosines(columns: int) -> FloatArray:
    """Cosines (columns,) of the azimuth from the sun."""
    return 1.0 - 2.0 * np.linspace(0.0, 1.0, columns) ** 2


def entry_distance_m(volume: AirVolume, direction: ArrayLike) -> FloatArray:
    """Distance (...,) from the eye to where rays (..., 3) enter the air, in m.

    It is 0 for an eye in the air and infinite for rays that miss it.
    """
    return _enter(grid_of(volume), np.asarray(direction, dtype=float)).distance_m


def look_up_air(volume: AirVolume, direction: ArrayLike, distance_m: ArrayLike) -> AirLight:
    """The air before points in unit directions (..., 3) at distances (...,) in m.

    Beyond a ray's span the values are those at its end. A shadow removes `sunlit`.
    """
    view, metres = np.asarray(direction, dtype=float), np.asarray(distance_m, dtype=float)
    grid = grid_of(volume)
    entry = _enter(grid, view)
    row, below = _rows_of(grid, view)
    span = span_m(grid, entry.altitude_m, entry.mu, below)
    before = np.where(np.isfinite(entry.distance_m), metres - entry.distance_m, 0.0)
    inside_m = np.clip(before, 0.0, span)
    depth = _slice_of(inside_m / span, grid.observer_altitude_m) * (
        len(volume.extinction.values) - 1
    )
    extinction = _blend(log_extinction(volume)[:, :, None], depth, row, np.zeros_like(depth))
    optical_depth = np.exp(extinction) * inside_m[..., None]
    absorbed = -np.expm1(-optical_depth)

    def light(
        kinds: NDArray[np.floating], scale: float, direction: Vector
    ) -> tuple[FloatArray, FloatArray]:
        """Radiance (..., 3) of one body's light scattered again, and scattered once."""
        column = _columns_of(direction, view) * (volume.columns - 1)
        again, direct, aerosol = (_blend(kind, depth, row, column) for kind in kinds)
        nu = view @ np.asarray(direction)
        once = direct * molecules_phase(nu)[..., None] + aerosol * aerosol_phase(volume, nu)
        return scale * absorbed * again, scale * absorbed * once

    shaded, sunlit = light(light_of(volume), volume.radiance_scale, volume.sun_direction)
    if (second := volume.second) is not None:
        assert second.light is not None
        shaded = shaded + sum(light(second.light.values, second.radiance_scale, second.direction))
    return AirLight(np.exp(-optical_depth), shaded, sunlit)


def log_extinction(volume: AirVolume) -> FloatArray:
    """Logarithm (slices, rows, 3), linear between nodes: extinction is exponential in height."""
    return np.log(np.maximum(volume.extinction.values.astype(float), _LEAST_EXTINCTION_PER_M))


def molecules_phase(nu: ArrayLike) -> FloatArray:
    """Rayleigh's phase function (...,) in sr^-1, of the cosine of the angle to the sun."""
    cosine = np.asarray(nu, dtype=float)
    return np.asarray(3.0 / (16.0 * np.pi) * (1.0 + cosine * cosine))


def aerosol_phase(volume: AirVolume, nu: ArrayLike) -> FloatArray:
    """The aerosol's phase function (..., 3) in sr^-1, of the cosine of the angle to the sun."""
    table = volume.aerosol_phase.values.astype(float)
    place = np.sqrt(np.clip(0.5 - 0.5 * np.asarray(nu, dtype=float), 0.0, 1.0))
    nodes = np.linspace(0.0, 1.0, len(table))
    return np.stack([np.interp(place, nodes, channel) for channel in table.T], axis=-1)


class _Entry(NamedTuple):
    """Where rays (...,) enter the air: distance from the eye (infinite: never), altitude, mu."""

    distance_m: FloatArray
    altitude_m: FloatArray
    mu: FloatArray


def _enter(grid: AirGrid, view: FloatArray) -> _Entry:
    mu = view[..., 1]
    if grid.observer_altitude_m <= grid.top_altitude_m:
        return _Entry(np.zeros_like(mu), np.full(mu.shape, grid.observer_altitude_m), mu)
    half_chord, distance = _entry(grid, mu, np.hypot(view[..., 0], view[..., 2]))
    hits = (mu < 0.0) & (half_chord > 0.0)
    top_radius = grid.ground_radius_m + grid.top_altitude_m
    return _Entry(
        np.where(hits, distance, np.inf),
        np.full(mu.shape, grid.top_altitude_m),
        -half_chord / top_radius,
    )


def _entry(grid: AirGrid, mu: FloatArray, sine: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Half the chord in the air (...,) and the distance to its start, for an eye above the air."""
    radius = grid.ground_radius_m + grid.observer_altitude_m
    top_radius = grid.ground_radius_m + grid.top_altitude_m
    perigee = radius * sine
    # Factored, to avoid cancellation in the difference of squares.
    half_chord = np.sqrt(np.maximum((top_radius - perigee) * (top_radius + perigee), 0.0))
    squares = (grid.observer_altitude_m - grid.top_altitude_m) * (radius + top_radius)
    return half_chord, squares / np.maximum(half_chord - radius * mu, 1e-30)


def evenness(observer_altitude_m: float) -> float:
    """b of the slices' shares."""
    return observer_altitude_m / (observer_altitude_m + _EVEN_ALTITUDE_M)


def _slice_of(share: FloatArray, observer_altitude_m: float) -> FloatArray:
    """u (...,) of a share of the span: the inverse of `slice_shares`."""
    even = evenness(observer_altitude_m)
    root = np.sqrt(np.maximum(even * even + (1.0 - 2.0 * even) * share, 0.0))
    return np.clip(share / np.maximum(even + root, 1e-300), 0.0, 1.0)


def _rows_of(grid: AirGrid, view: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    level = view[..., 0] ** 2 + view[..., 2] ** 2
    # 1 + mu without cancellation near the nadir, where a far observer sees the whole planet.
    one_plus = np.where(
        view[..., 1] < 0.0, level / (1.0 + np.abs(view[..., 1])), 1.0 + view[..., 1]
    )
    return rows_of(grid, one_plus)


def _columns_of(direction: Vector, view: FloatArray) -> FloatArray:
    """Place (...,) between the columns, from 0 at a body's azimuth to 1; the zenith gets 0."""
    azimuth = _level(np.asarray(direction, dtype=float))
    # Half the chord between horizontal unit vectors is the sine of half the azimuth.
    chord = np.linalg.norm(_level(view) - azimuth, axis=-1)
    return np.minimum(0.5 * chord, 1.0)


def _level(direction: FloatArray) -> FloatArray:
    """Horizontal unit vectors (..., 2), (x, z), of azimuths; north for the zenith."""
    level = direction[..., [0, 2]]
    length = np.linalg.norm(level, axis=-1, keepdims=True)
    north = np.array([0.0, -1.0])
    return np.where(length > 1e-12, level / np.maximum(length, 1e-300), north)


def _blend(values: NDArray, depth: FloatArray, row: FloatArray, column: FloatArray) -> FloatArray:
    """Trilinear interpolation (..., 3) of nodes (slices, rows, columns, 3)."""
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
    """The two nodes around a position, with their weights."""
    low = np.clip(at.astype(np.intp), 0, max(size - 2, 0))
    share = np.clip(at - low, 0.0, 1.0)
    return (low, 1.0 - share), (np.minimum(low + 1, size - 1), share)
