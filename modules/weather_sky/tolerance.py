"""Sizes and thresholds for a tolerance of radiance."""

from typing import NamedTuple

import numpy as np


class WeatherQuality(NamedTuple):
    """A cube's edge in texels, and the share of radiance that unseen moves may change."""

    cube_size: int
    sun_change: float


def quality_for(tolerance: float) -> WeatherQuality:
    """Weather is smooth but for the light beside the sun, which falls to a third over 7 degrees."""
    return WeatherQuality(int(np.clip(16.0 / tolerance, 64, 512)), 0.05 * tolerance)
