"""The moon's disc as light from many directions: the twin of moon.frag, for panoramas."""

import numpy as np

from vrut_lite.messages.night import EDGE_OVER_MIDDLE, THROUGH_PLACES, EarthShadow, MoonDiscChanged
from vrut_lite.numeric_types import FloatArray

# Samples across the disc, which is some twelve pixels wide in the largest maps.
_ACROSS = 96


def moon_samples(moon: MoonDiscChanged) -> tuple[FloatArray, FloatArray]:
    """Directions (n, 3) above the horizon, world axes, and the irradiance (n, 3) from each."""
    steps = (np.arange(_ACROSS) + 0.5) / _ACROSS * 2.0 - 1.0
    x, y = (part.ravel() for part in np.meshgrid(steps, steps))
    inside = x * x + y * y < 1.0
    x, y = x[inside], y[inside]
    middle = np.asarray(moon.direction)
    right = np.cross(middle, [0.0, 1.0, 0.0])
    right /= max(float(np.linalg.norm(right)), 1e-9)
    upper = np.cross(right, middle)
    mu = np.sqrt(1.0 - x * x - y * y)
    normal = x[:, None] * right + y[:, None] * upper - mu[:, None] * middle
    mu_sun = np.maximum(normal @ np.asarray(moon.to_sun), 0.0)
    sine = np.sin(moon.angular_radius_rad)
    place = middle + sine * (x[:, None] * right + (moon.flattening * y)[:, None] * upper)
    place /= np.linalg.norm(place, axis=1, keepdims=True)
    lit = (mu_sun / np.maximum(mu_sun + mu, 1e-4))[:, None] * np.asarray(moon.lit_rgb)
    if moon.shadow is not None:
        lit = lit * shadow_share(moon.shadow, place)
    radiance = _albedo(moon, normal)[:, None] * (lit + np.asarray(moon.dark_rgb))
    if moon.through_rgb:
        places = np.linspace(-1.0, 1.0, THROUGH_PLACES)
        channels = np.reshape(moon.through_rgb, (-1, 3)).T
        radiance *= np.stack([np.interp(y, places, through) for through in channels], axis=-1)
    solid_angle = moon.flattening * (2.0 * sine / _ACROSS) ** 2
    up = place[:, 1] > np.sin(moon.horizon_rad)
    return place[up], radiance[up] * solid_angle


def shadow_share(shadow: EarthShadow, direction: FloatArray) -> FloatArray:
    """Share (n, 3) of sunlight on the moon in directions (n, 3): the sun cut by a straight edge."""
    beside = np.linalg.norm(np.cross(direction, shadow.direction), axis=-1)
    t = (beside - shadow.umbra_rad) / (shadow.penumbra_rad - shadow.umbra_rad)
    x = np.clip(2.0 * t - 1.0, -1.0, 1.0)
    sun = 0.5 + (x * np.sqrt(1.0 - x * x) + np.arcsin(x)) / np.pi
    inner = np.minimum(beside / shadow.umbra_rad, 1.0)
    copper = EDGE_OVER_MIDDLE ** (inner * inner)
    left = copper[..., None] * np.asarray(shadow.umbra_rgb)
    return np.asarray(sun[..., None] + (1.0 - sun[..., None]) * np.minimum(left, 1.0))


def _albedo(moon: MoonDiscChanged, normal: FloatArray) -> FloatArray:
    own = normal @ np.reshape(moon.axes, (3, 3)).T
    rows, columns = moon.albedo.shape
    row = (0.5 - np.arcsin(np.clip(own[:, 2], -1.0, 1.0)) / np.pi) * rows
    column = (np.arctan2(own[:, 1], own[:, 0]) / (2.0 * np.pi) + 0.5) * columns
    at = np.clip(row, 0, rows - 1).astype(int), column.astype(int) % columns
    return np.asarray(moon.albedo.values[at], dtype=float)
