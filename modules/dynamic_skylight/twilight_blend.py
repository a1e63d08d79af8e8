"""Blends the model's last sky into the computed twilight, direction by direction.

At the horizon below the sun the model's last sky is several times as bright as the computed one;
in thick haze over dark ground its far horizon is black. A weighted sum would keep the first too
long and brighten the second at once. So the logarithm of luminance is interpolated, linearly in
the sun's elevation, and colour over a shorter range, linearly.
"""

import numpy as np

from dynamic_skylight.hosek_wilkie.formula import extended_perez
from dynamic_skylight.twilight_table import MAP_SHAPE, luminous_irradiance, sin_elevation_of
from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import FloatArray

# Geometric elevations where the blend begins, and where the model's luminance and colour have
# vanished.
BLEND_DEG = 0.5
BLEND_ENDS_DEG = -2.5
COLOUR_ENDS_DEG = -1.5
# Share of the blend at each end over which the change of luminance sets in and fades.
_ROUNDED = 0.12
# Lower bound of the model's luminance in the blend, relative to twilight's.
_DARKEST = 0.05


def model_on_map(
    distribution: FloatArray, mean_radiance: FloatArray, sun_elevation_rad: float
) -> FloatArray:
    """Radiance (64, 32, 3) of the clamped formula on the directions of `twilight_table`'s map."""
    rows, columns = MAP_SHAPE
    cos_theta = sin_elevation_of(np.linspace(0.0, 1.0, rows))[:, None]
    cos_azimuth = 1.0 - 2.0 * np.linspace(0.0, 1.0, columns) ** 2
    sin_theta = np.sqrt((1.0 - cos_theta) * (1.0 + cos_theta))
    cos_gamma = cos_theta * np.sin(sun_elevation_rad)
    cos_gamma = cos_gamma + sin_theta * np.cos(sun_elevation_rad) * cos_azimuth
    gamma = np.arccos(np.clip(cos_gamma, -1.0, 1.0))
    return np.maximum(extended_perez(cos_theta, gamma, distribution) * mean_radiance, 0.0)


def blend(
    model: FloatArray, twilight: FloatArray, level: float, geometric_deg: float
) -> FloatArray:
    """A map (V, A, 4): the radiance to add (3), and the factor of the model before that (1).

    Applied to `model`, the result has the luminous irradiance `level`.

    Args:
        model: radiance (V, A, 3) of the model's last sky.
        twilight: (V, A, 3), of one unit of luminous irradiance.
        level: luminous irradiance on level ground, CIE Y in W m^-2.
        geometric_deg: the sun's elevation.
    """
    share, share_of_colour = luminance_share(geometric_deg), colour_share(geometric_deg)
    model_level = luminous_irradiance(model)
    of_model, of_twilight = luminance(model) / model_level, luminance(twilight)
    of_model = np.hypot(of_model, _DARKEST * of_twilight)
    together = of_model**share * of_twilight ** (1.0 - share)
    factor = share_of_colour * together / (of_model * model_level)
    added = ((1.0 - share_of_colour) * together / of_twilight)[..., None] * twilight
    sky = np.concatenate([added, factor[..., None]], axis=-1)
    return np.asarray(sky * (level / luminous_irradiance(added + factor[..., None] * model)))


def luminance_share(geometric_deg: float) -> float:
    """Exponent of the model's luminance: 1 at the blend, 0 from -2.5 deg down.

    Linear, with parabolas at both ends that round its kinks.
    """
    x = _position(geometric_deg, BLEND_ENDS_DEG)
    near_end = min(x, 1.0 - x, _ROUNDED)
    value = near_end * near_end / (2.0 * _ROUNDED)
    if near_end == _ROUNDED:
        value = min(x, 1.0 - x) - 0.5 * _ROUNDED
    value /= 1.0 - _ROUNDED
    return value if x < 0.5 else 1.0 - value


def colour_share(geometric_deg: float) -> float:
    """The model's share of the colours: 1 at the blend, 0 from -1.5 deg down, smooth."""
    x = _position(geometric_deg, COLOUR_ENDS_DEG)
    return x * x * (3.0 - 2.0 * x)


def _position(geometric_deg: float, end_deg: float) -> float:
    return min(max((geometric_deg - end_deg) / (BLEND_DEG - end_deg), 0.0), 1.0)
