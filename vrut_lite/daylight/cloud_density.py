"""Density and transmittance of a `CloudLayer`: the float64 twin of cloud_density.glsl.

A weather map gives place and height of clouds, a volume of noise their billows, a finer one frays
their edges: after Schneider 2015, "The Real-Time Volumetric Cloudscapes of Horizon Zero Dawn", with
our own height profile. The weather is the sum of two copies of one map, with different periods and
turned against each other, so that the pattern does not repeat.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.daylight.clouds import CloudLayer
from vrut_lite.numeric_types import FloatArray

PLANET_RADIUS_M = 6.36e6
# Periods of the noise: of the two copies of the weather map, the shape, the detail.
WEATHER_PERIODS_M = (37_000.0, 23_300.0)
SHAPE_PERIOD_M = 5_300.0
DETAIL_PERIOD_M = 830.0
WEATHER_SHARES = (0.65, 0.35)
# Rotation of the second weather map, and of shape and detail, so that no axes of noise coincide.
WEATHER_TURN_RAD = 0.65
NOISE_TURN_RAD = 0.3
# Weather above the threshold over which a cloud grows from its least to its full height.
GROWTH = 0.42
# Height of the smallest cloud, as a share of the layer's.
LEAST_HEIGHT = 0.22
# Shares of a cloud's height over which its flat base and its round top fade.
BASE_FADE = 0.05
TOP_FADE = 0.75
# Weather above the threshold over which a cloud's side fades in.
SIDE_FADE = 0.16
# Weight of the detail noise, and sharpness of edges.
FRAYING = 0.32
SHARPNESS = 5.0


class Column(NamedTuple):
    """The clouds over places (...,), as the weather gives them.

    `strength` in [0, 1] fades a cloud's side; `top` is the height of its top, as a share of the
    layer's thickness.
    """

    strength: FloatArray
    top: FloatArray


def column_of(weather: ArrayLike, threshold: float) -> Column:
    """Clouds (...,) of weather (...,) in [0, 1]."""
    above = np.asarray(weather, dtype=float) - threshold
    growth = np.clip(above / GROWTH, 0.0, 1.0)
    return Column(
        strength=np.clip(above / SIDE_FADE, 0.0, 1.0),
        top=LEAST_HEIGHT + (1.0 - LEAST_HEIGHT) * growth * (2.0 - growth),
    )


def envelope(column: Column, height: ArrayLike) -> FloatArray:
    """Envelope (...,) of the noise at heights (...,), given as shares of the layer's thickness."""
    h = np.asarray(height, dtype=float)
    base = np.clip(h / BASE_FADE, 0.0, 1.0)
    top = np.clip((1.0 - h / column.top) / TOP_FADE, 0.0, 1.0)
    return np.asarray(column.strength * base * np.sqrt(top))


def density_of(envelopes: ArrayLike, shape: ArrayLike, detail: ArrayLike) -> FloatArray:
    """Density (...,) in [0, 1] of an envelope and the two noises (...,), each in [0, 1]."""
    kept = np.asarray(shape) - FRAYING * np.asarray(detail) + np.asarray(envelopes) - 1.0
    return np.clip(SHARPNESS * kept, 0.0, 1.0) * (np.asarray(envelopes) > 0.0)


def altitude_m(points_m: ArrayLike, eye_m: ArrayLike) -> FloatArray:
    """Altitudes (...,) of points (..., 3) above a sphere with its top below the eye (..., 3)."""
    eye = np.asarray(eye_m, dtype=float)
    across = np.asarray(points_m, dtype=float) - eye
    # The difference of squares is factored, to avoid cancellation.
    y = eye[..., 1] + across[..., 1]
    level = across[..., 0] ** 2 + across[..., 2] ** 2
    radius = np.sqrt(level + (PLANET_RADIUS_M + y) ** 2)
    return np.asarray((y * (2.0 * PLANET_RADIUS_M + y) + level) / (PLANET_RADIUS_M + radius))


def weather_at(layer: CloudLayer, level_m: ArrayLike) -> FloatArray:
    """Weather (...,) in [0, 1] over places (..., 2), world x and z."""
    texels = layer.weather.values / 65535.0
    places = np.asarray(level_m, dtype=float) - layer.drift_m
    views = (places, turned(places, WEATHER_TURN_RAD))
    parts = [
        share * _periodic(texels, view[..., ::-1] / period)
        for share, view, period in zip(WEATHER_SHARES, views, WEATHER_PERIODS_M, strict=True)
    ]
    return np.asarray(sum(parts))


def noise_at(
    volume: NDArray, period_m: float, drift_m: ArrayLike, level_m: ArrayLike, over_base_m: ArrayLike
) -> FloatArray:
    """Shape or detail (...,) in [0, 1] over places (..., 2), at heights (...,) over the base, m."""
    places = turned(np.asarray(level_m, dtype=float) - np.asarray(drift_m), NOISE_TURN_RAD)
    heights = np.broadcast_to(np.asarray(over_base_m, dtype=float), places.shape[:-1])
    at = np.stack([heights, places[..., 1], places[..., 0]], axis=-1) / period_m
    return _periodic(volume / 255.0, at)


def density(layer: CloudLayer, points_m: ArrayLike, eye_m: ArrayLike) -> FloatArray:
    """Density (...,) in [0, 1] at points (..., 3) in world axes, for eyes (..., 3)."""
    points = np.asarray(points_m, dtype=float)
    over_base = altitude_m(points, eye_m) - layer.base_m
    height = over_base / layer.thickness_m
    level = points[..., [0, 2]]
    covered = envelope(column_of(weather_at(layer, level), layer.threshold), height)
    shape = noise_at(layer.shape.values, SHAPE_PERIOD_M, layer.drift_m, level, over_base)
    detail = noise_at(layer.detail.values, DETAIL_PERIOD_M, layer.drift_m, level, over_base)
    inside = (height >= 0.0) & (height <= 1.0)
    return np.where(inside, density_of(covered, shape, detail), 0.0)


def optical_depth(
    layer: CloudLayer,
    start_m: ArrayLike,
    direction: ArrayLike,
    span_m: float,
    eye_m: ArrayLike,
    steps: int = 400,
) -> float:
    """Optical depth of the layer along a ray: point (3,), unit direction (3,); midpoint rule."""
    t = (np.arange(steps) + 0.5) * span_m / steps
    points = np.asarray(start_m, dtype=float) + t[:, None] * np.asarray(direction, dtype=float)
    return float(density(layer, points, eye_m).mean() * span_m * layer.extinction_per_m)


def sun_transmittance(layer: CloudLayer, point_m: ArrayLike, sun: ArrayLike) -> float:
    """Transmittance of the layer from a point (3,) towards the sun's direction (3,)."""
    point, towards = np.asarray(point_m, dtype=float), np.asarray(sun, dtype=float)
    enter, leave = (
        max(distance_up_m(float(point[1]), level, float(towards[1])), 0.0)
        for level in (layer.base_m, layer.base_m + layer.thickness_m)
    )
    if not leave > enter:
        return 1.0
    start = point + enter * towards
    return float(np.exp(-optical_depth(layer, start, towards, leave - enter, point)))


def distance_up_m(from_altitude_m: float, to_altitude_m: float, mu: float) -> float:
    """Distance along a ray of zenith cosine mu to a higher sphere; negative if it is below."""
    along = (PLANET_RADIUS_M + from_altitude_m) * mu
    squares = (to_altitude_m - from_altitude_m) * (
        2.0 * PLANET_RADIUS_M + from_altitude_m + to_altitude_m
    )
    root = np.sqrt(max(along * along + squares, 0.0))
    return float(squares / (along + root) if along > 0.0 else root - along)


def turned(places: FloatArray, angle_rad: float) -> FloatArray:
    """Places (..., 2) rotated about the origin."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    x, z = places[..., 0], places[..., 1]
    return np.stack([c * x - s * z, s * x + c * z], axis=-1)


def _periodic(texels: NDArray, at: FloatArray) -> FloatArray:
    """Linear interpolation of periodic texels (n, ...) at places (..., axes) of period 1."""
    size = texels.shape[0]
    place = (at - np.floor(at)) * size - 0.5
    low = np.floor(place).astype(np.intp)
    share = place - low
    axes = texels.ndim
    out = np.zeros(at.shape[:-1])
    for corner in np.ndindex(*(2,) * axes):
        weight = np.ones(at.shape[:-1])
        for axis, upper in enumerate(corner):
            weight = weight * (share[..., axis] if upper else 1.0 - share[..., axis])
        index = tuple((low[..., axis] + corner[axis]) % size for axis in range(axes))
        out += weight * texels[index]
    return out
