"""The moon's disc as light from many directions: the twin of moon.frag, for panoramas."""

import numpy as np

from vrut_lite.daylight.night import MoonDiscChanged
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
    radiance = _albedo(moon, normal)[:, None] * (
        (mu_sun / np.maximum(mu_sun + mu, 1e-4))[:, None] * np.asarray(moon.lit_rgb)
        + np.asarray(moon.dark_rgb)
    )
    sine = np.sin(moon.angular_radius_rad)
    place = middle + sine * (x[:, None] * right + (moon.flattening * y)[:, None] * upper)
    place /= np.linalg.norm(place, axis=1, keepdims=True)
    solid_angle = moon.flattening * (2.0 * sine / _ACROSS) ** 2
    up = place[:, 1] > 0.0
    return place[up], radiance[up] * solid_angle


def _albedo(moon: MoonDiscChanged, normal: FloatArray) -> FloatArray:
    own = normal @ np.reshape(moon.axes, (3, 3)).T
    rows, columns = moon.albedo.shape
    row = (0.5 - np.arcsin(np.clip(own[:, 2], -1.0, 1.0)) / np.pi) * rows
    column = (np.arctan2(own[:, 1], own[:, 0]) / (2.0 * np.pi) + 0.5) * columns
    at = np.clip(row, 0, rows - 1).astype(int), column.astype(int) % columns
    return np.asarray(moon.albedo.values[at], dtype=float)
