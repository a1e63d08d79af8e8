"""Whether an hour's light looks like that of the hour before."""

import math

import numpy as np

from vrut_lite.messages.sky_light import SkyLightChanged


def looks_like(
    now: SkyLightChanged, before: SkyLightChanged, change: float, sun_rad: float
) -> bool:
    """Whether light on surfaces differs invisibly from that of another hour.

    Args:
        now: an hour, with `radiance`.
        before: another.
        change: share of the brightest irradiance by sky and key light that may change.
        sun_rad: largest invisible move of the key light.
    """
    if (_source(now), now.key_light.body) != (_source(before), before.key_light.body):
        return False
    moved = math.dist(now.key_light.direction, before.key_light.direction)
    return moved <= sun_rad and _largest_change(now, before) <= change


def _largest_change(now: SkyLightChanged, before: SkyLightChanged) -> float:
    """Of any harmonic, the key light or the ground, over the larger irradiance of the two."""
    one, other = _irradiances(now), _irradiances(before)
    brightest = max(np.abs(one).max(), np.abs(other).max())
    return float(np.abs(one - other).max() / brightest) if brightest > 0.0 else 0.0


def _source(hour: SkyLightChanged) -> str:
    return hour.lighting.source


def _irradiances(hour: SkyLightChanged) -> np.ndarray:
    ground = np.pi * np.asarray(hour.lighting.ground_radiance_rgb)
    key_light = np.asarray(hour.key_light.irradiance_rgb)
    return np.vstack([hour.ambient.irradiance_sh_rgb.values, ground, key_light])
