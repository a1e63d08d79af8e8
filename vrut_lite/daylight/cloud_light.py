"""What clouds make of the light on the ground: skylight under a broken or a closed layer.

Two streams (Eddington's): a cloud of optical depth tau lets 1 / (1 + 3/4 (1 - g) tau) of what
falls on it through, whatever its direction. This light comes from the cloud's base, evenly; the
clear sky's comes through the gaps.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.clouds import CloudLayer
from vrut_lite.daylight.sun_aloft import sun_aloft
from vrut_lite.geometry.spherical_harmonics import COSINE_LOBE, evaluate_irradiance
from vrut_lite.numeric_types import Vector

_UP = np.array([0.0, 1.0, 0.0])
_DARKEST_IRRADIANCE = 1e-12


class ClearLight(NamedTuple):
    """The light of a sky without clouds: as a `Light` of the frame has it."""

    sun_direction: Vector
    sun_irradiance: Vector
    irradiance_sh: NDArray


class Beneath(NamedTuple):
    """Light under a layer: (3,) each, linear sRGB.

    Attributes:
        scattered_share: of what falls on clouds that their bases send down.
        ground_by_sun: of the light on level ground under a clear sky, the sun's share.
        ground_by_sky: what sky and clouds together give now, relative to the same.
        light_from_below: radiance of the ground as clouds see it, W m^-2 sr^-1.
    """

    scattered_share: float
    ground_by_sun: NDArray[np.float64]
    ground_by_sky: NDArray[np.float64]
    light_from_below: NDArray[np.float64]


def scattered_share(layer: CloudLayer) -> float:
    """Share of the light on clouds that their bases send down."""
    forward, backward, share = layer.phase
    g = share * forward + (1.0 - share) * backward
    depth = layer.extinction_per_m * layer.thickness_m * layer.column_density
    return 1.0 / (1.0 + 0.75 * (1.0 - g) * depth)


def sky_beneath(layer: CloudLayer, light: ClearLight) -> Beneath:
    """The light under a layer that a clear sky's light falls on."""
    covered, through = layer.coverage, scattered_share(layer)
    sun = np.asarray(light.sun_irradiance) * max(light.sun_direction[1], 0.0)
    sky = evaluate_irradiance(light.irradiance_sh, _UP)
    from_clouds = _sky_of_clouds(layer, light, sky) * through
    below = evaluate_irradiance(light.irradiance_sh, -_UP) / np.pi
    clear = np.maximum(sun + sky, _DARKEST_IRRADIANCE)
    by_sky = ((1.0 - covered) * sky + covered * from_clouds) / clear
    lit = (1.0 - covered) * sun / clear + by_sky
    return Beneath(through, sun / clear, by_sky, below * lit)


def under_clouds(layer: CloudLayer, light: ClearLight) -> NDArray[np.float64]:
    """The harmonics (25, 3) of skylight under a layer: clear sky in gaps, even bases between."""
    covered = layer.coverage
    beneath = sky_beneath(layer, light)
    clear = np.asarray(light.irradiance_sh, dtype=float)
    return (1.0 - covered) * clear + covered * _dome(
        _sky_of_clouds(layer, light, evaluate_irradiance(clear, _UP)) * beneath.scattered_share,
        beneath.light_from_below * np.pi,
    )


def _sky_of_clouds(layer: CloudLayer, light: ClearLight, sky: NDArray) -> NDArray[np.float64]:
    """Irradiance (3,) of the layer's top by sun and sky."""
    sine = light.sun_direction[1]
    return np.asarray(sun_aloft(layer.base_m + layer.thickness_m, sine) * max(sine, 0.0) + sky)


def _dome(from_above: NDArray, from_below: NDArray) -> NDArray[np.float64]:
    """Harmonics (25, 3) of two even half spheres that give level planes these irradiances (3,)."""
    harmonics = np.zeros((25, 3))
    mean, half = 0.5 * (from_above + from_below) / np.pi, 0.5 * (from_above - from_below) / np.pi
    # L = mean + half sign(y): its bands 0 and 1, and 3 that the cosine lobe lacks.
    harmonics[0] = COSINE_LOBE[0] * mean * np.sqrt(4.0 * np.pi)
    harmonics[1] = COSINE_LOBE[1] * half * np.sqrt(3.0 * np.pi)
    return harmonics
