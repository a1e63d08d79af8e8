"""The albedo of the ground below a sky, from the sky's own messages."""

import numpy as np

from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged, SkyRadianceChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import Vector

_UP = np.array([0.0, 1.0, 0.0])
# Below this irradiance (W m^-2) the quotient of ground radiance and irradiance is rounding.
_DARKEST_IRRADIANCE = 1e-12


def ground_albedo(
    background: BackgroundChanged | SkyRadianceChanged,
    key_light: KeyLightChanged,
    ambient: AmbientChanged,
) -> Vector:
    """Albedo (R, G, B) of the ground that a sky was computed with: pi L / E at the nadir.

    Taken from the messages, so that the ground disc meets the sky's lower half without an edge for
    every sky module.
    """
    radiance = np.asarray(background.ground_radiance_rgb)
    direct = np.asarray(key_light.irradiance_rgb) * max(0.0, key_light.direction[1])
    irradiance = evaluate_irradiance(ambient.irradiance_sh_rgb.values, _UP) + direct
    albedo = np.clip(np.pi * radiance / np.maximum(irradiance, _DARKEST_IRRADIANCE), 0.0, 1.0)
    return (float(albedo[0]), float(albedo[1]), float(albedo[2]))
