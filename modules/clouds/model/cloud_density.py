"""Density and transmittance of a `CloudLayer`: the float64 twin of cloud_density.glsl.

A weather map gives place and height of clouds, a volume of noise their billows, a finer one frays
their edges: after Schneider 2015, "The Real-Time Volumetric Cloudscapes of Horizon Zero Dawn", with
our own height profile (a layer's `form`). The weather is the sum of two copies of one map, with
different periods and turned against each other, so that the pattern does not repeat.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.messages.clouds import CloudForm, CloudLayer
from vrut_lite.numeric_types import FloatArray

# Rotation of the second weather map, and of shape and detail, so that no axes of noise coincide.
WEATHER_TURN_RAD = 0.65
NOISE_TURN_RAD = 0.3
# Amplitude, as a share of the period, of waves that shift the billows across each other, and waves
# per period along both axes: without them the repeated volume shows as rows of the same cloud.
WARP = 0.3
WARP_WAVES = (0.306, 0.414)
# The same for both copies of the weather map, so that clouds do not stand in rows from space:
# amplitude in periods of the first copy; waves per period along x and z for each axis of the shift.
WEATHER_WARP = 0.216
WEATHER_WAVES = ((0.184, 0.205), (-0.214, 0.411))
# An anvil grows out of towers, from where their sides are so deep: from which share of the layer's
# thickness, over which it spreads, and over which it fades in and, at the top, out.
ANVIL_ROOT, ANVIL_FROM, ANVIL_RISE, ANVIL_FADE = 0.5, 0.5, 0.4, 0.12


class Column(NamedTuple):
    """The clouds over places (...,), as the weather gives them.

    `side` is how far a place lies within a cloud's side, 0 at its border and 1 where it has ended,
    negative outside; `top` is the height of its top, as a share of the layer's thickness.
    """

    side: FloatArray
    top: FloatArray


def column_of(weather: ArrayLike, threshold: float, form: CloudForm) -> Column:
    """Clouds (...,) of weather (...,) in [0, 1]."""
    above = np.asarray(weather, dtype=float) - threshold
    growth = np.clip(above / form.growth, 0.0, 1.0)
    return Column(
        side=above / form.side_fade,
        top=form.least_height + (1.0 - form.least_height) * growth * (2.0 - growth),
    )


def envelope(column: Column, height: ArrayLike, form: CloudForm) -> FloatArray:
    """Envelope (...,) of the noise at heights (...,), given as shares of the layer's thickness."""
    h = np.asarray(height, dtype=float)
    base = np.clip(h / form.base_fade, 0.0, 1.0)
    top = np.clip((1.0 - h / column.top) / form.top_fade, 0.0, 1.0)
    cloud = np.clip(column.side, 0.0, 1.0) * base * np.sqrt(top)
    if form.anvil == 0.0:
        return np.asarray(cloud)
    rise = np.clip((h - ANVIL_FROM) / ANVIL_RISE, 0.0, 1.0)
    within = np.clip(np.minimum(h - ANVIL_FROM, 1.0 - h) / ANVIL_FADE, 0.0, 1.0)
    reach = (form.anvil + ANVIL_ROOT) * rise * rise - ANVIL_ROOT
    return np.maximum(cloud, np.clip(column.side + reach, 0.0, 1.0) * within)


def density_of(
    envelopes: ArrayLike, shape: ArrayLike, detail: ArrayLike, form: CloudForm
) -> FloatArray:
    """Density (...,) in [0, 1] of an envelope and the two noises (...,), each in [0, 1]."""
    kept = np.asarray(shape) - form.fraying * np.asarray(detail) + np.asarray(envelopes) - 1.0
    return np.clip(form.sharpness * kept, 0.0, 1.0) * (np.asarray(envelopes) > 0.0)


def altitude_m(points_m: ArrayLike, eye_m: ArrayLike) -> FloatArray:
    """Altitudes (...,) of points (..., 3) above a sphere with its top below the eye (..., 3)."""
    eye = np.asarray(eye_m, dtype=float)
    across = np.asarray(points_m, dtype=float) - eye
    # The difference of squares is factored, to avoid cancellation.
    y = eye[..., 1] + across[..., 1]
    level = across[..., 0] ** 2 + across[..., 2] ** 2
    radius = np.sqrt(level + (GROUND_RADIUS_M + y) ** 2)
    return np.asarray((y * (2.0 * GROUND_RADIUS_M + y) + level) / (GROUND_RADIUS_M + radius))


def level_m(points_m: ArrayLike, eye_m: ArrayLike) -> FloatArray:
    """Places (..., 2), world x and z, of points (..., 3) over a sphere with its top below the eye.

    Areas are kept (Lambert's azimuthal projection about the eye).
    """
    eye = np.asarray(eye_m, dtype=float)
    across = np.asarray(points_m, dtype=float) - eye
    upright = GROUND_RADIUS_M + eye[..., 1] + across[..., 1]
    radius = np.sqrt(across[..., 0] ** 2 + across[..., 2] ** 2 + upright**2)
    scale = np.sqrt(2.0 * radius / (radius + upright))
    return np.asarray(eye[..., [0, 2]] + across[..., [0, 2]] * scale[..., None])


def weather_at(layer: CloudLayer, level_m: ArrayLike) -> FloatArray:
    """Weather (...,) in [0, 1] over places (..., 2), world x and z."""
    texels = layer.weather.values / 65535.0
    places = np.asarray(level_m, dtype=float) - layer.drift_m
    along = places / layer.form.weather_periods_m[0] @ np.transpose(WEATHER_WAVES)
    waves = WEATHER_WARP * wave(along)
    views = (places, turned(places, WEATHER_TURN_RAD))
    shares = 1.0 - layer.form.second_share, layer.form.second_share
    parts = [
        share * _periodic(texels, (view / period + waves)[..., ::-1])
        for share, view, period in zip(shares, views, layer.form.weather_periods_m, strict=True)
    ]
    return np.asarray(sum(parts))


def noise_places_m(layer: CloudLayer, level_m: ArrayLike) -> FloatArray:
    """Places (..., 2) in the axes of the noise, at the layer's base: turned, and stretched."""
    places = turned(np.asarray(level_m, dtype=float) - layer.drift_m, NOISE_TURN_RAD)
    return places / (layer.form.stretch, 1.0)


def weather_origin(layer: CloudLayer, level_m: ArrayLike) -> FloatArray:
    """A place (2,), world x and z, in the two views of the weather (4,), in periods below 1."""
    place = np.asarray(level_m, dtype=float) - layer.drift_m
    views = place, turned(place, WEATHER_TURN_RAD)
    periods_m = layer.form.weather_periods_m
    return np.concatenate([(v / p) % 1.0 for v, p in zip(views, periods_m, strict=True)])


def noise_origin(layer: CloudLayer, level_m: ArrayLike) -> FloatArray:
    """The same in shape and detail (4,)."""
    place, form = noise_places_m(layer, level_m), layer.form
    return np.concatenate([(place / p) % 1.0 for p in (form.shape_period_m, form.detail_period_m)])


def warp_origin(layer: CloudLayer, level_m: ArrayLike) -> FloatArray:
    """The same in the waves (4,) that warp the shape, and the weather."""
    place = np.asarray(level_m, dtype=float) - layer.drift_m
    in_shape = noise_places_m(layer, level_m) / layer.form.shape_period_m
    in_weather = place / layer.form.weather_periods_m[0]
    waves = in_shape[::-1] * WARP_WAVES, np.asarray(WEATHER_WAVES) @ in_weather
    return np.concatenate(waves) % 1.0


def shape_at(layer: CloudLayer, level_m: ArrayLike, over_base_m: ArrayLike) -> FloatArray:
    """Shape (...,) in [0, 1] over places (..., 2), at heights (...,) over the base, m."""
    period = layer.form.shape_period_m
    at = noise_places_m(layer, level_m) / period
    waves = WARP * wave(at[..., ::-1] * WARP_WAVES)
    return _volume_at(layer, layer.shape.values, period, at + waves, over_base_m)


def detail_at(layer: CloudLayer, level_m: ArrayLike, over_base_m: ArrayLike) -> FloatArray:
    """Detail (...,) in [0, 1] over places (..., 2), at heights (...,) over the base, m."""
    period = layer.form.detail_period_m
    at = noise_places_m(layer, level_m) / period
    return _volume_at(layer, layer.detail.values, period, at, over_base_m)


def _volume_at(
    layer: CloudLayer, volume: NDArray, period_m: float, at: FloatArray, over_base_m: ArrayLike
) -> FloatArray:
    """A volume (...,) in [0, 1] at places (..., 2) in periods, which lean with the height."""
    heights = np.broadcast_to(np.asarray(over_base_m, dtype=float), at.shape[:-1]) / period_m
    leant = at[..., 0] - layer.form.lean * heights / layer.form.stretch
    return _periodic(volume / 255.0, np.stack([heights, at[..., 1], leant], axis=-1))


def density(layer: CloudLayer, points_m: ArrayLike, eye_m: ArrayLike) -> FloatArray:
    """Density (...,) in [0, 1] at points (..., 3) in world axes, for eyes (..., 3)."""
    points = np.asarray(points_m, dtype=float)
    over_base = altitude_m(points, eye_m) - layer.base_m
    height = over_base / layer.thickness_m
    level, form = level_m(points, eye_m), layer.form
    covered = envelope(column_of(weather_at(layer, level), layer.threshold, form), height, form)
    shape, detail = (at(layer, level, over_base) for at in (shape_at, detail_at))
    inside = (height >= 0.0) & (height <= 1.0)
    return np.where(inside, density_of(covered, shape, detail, form), 0.0)


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
    along = (GROUND_RADIUS_M + from_altitude_m) * mu
    squares = (to_altitude_m - from_altitude_m) * (
        2.0 * GROUND_RADIUS_M + from_altitude_m + to_altitude_m
    )
    root = np.sqrt(max(along * along + squares, 0.0))
    return float(squares / (along + root) if along > 0.0 else root - along)


def wave(at: FloatArray) -> FloatArray:
    """Nearly a sine (...,), of period 1: parabolas."""
    place = at - np.floor(at + 0.5)
    return np.asarray(8.0 * place * (1.0 - 2.0 * np.abs(place)))


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
