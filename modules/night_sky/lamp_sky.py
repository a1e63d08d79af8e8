"""The sky over towns: air lit by ground that shines evenly, as a Lambertian lamp without end.

Light that the air scatters once, as seen from the ground. From the zenith aerosol must send light
back, which it hardly does; along the horizon it is seen from the side. So such a sky grows more
towards the horizon than the air's depth does. The level is asked for apart.
"""

from functools import lru_cache

import numpy as np

from night_sky.night_air import RGB_NM
from vrut_lite.atmosphere.aerosols.phase_table import PHASE_NODES
from vrut_lite.atmosphere.clear_air import TOP_ALTITUDE_M
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.atmosphere.sunlight import extinctions_per_m
from vrut_lite.messages.haze import SetHaze
from vrut_lite.numeric_types import FloatArray

# Elevations, steps along a ray, slopes and azimuths of light that comes up; altitudes.
_NODES, _STEPS, _SLOPES, _TURNS, _HEIGHTS = 32, 48, 8, 24, 256


def lamp_share(haze: SetHaze, sine: FloatArray) -> FloatArray:
    """Radiance (..., 3) of the sky over that of the ground, by the sine (...,) of the elevation."""
    nodes, share = _shares(haze)
    at = np.asarray(sine, dtype=float)
    return np.stack([np.interp(at, nodes, share[:, c]) for c in range(3)], axis=-1)


@lru_cache(maxsize=2)
def _shares(haze: SetHaze) -> tuple[FloatArray, FloatArray]:
    elevation = 0.5 * np.pi * np.linspace(0.0, 1.0, _NODES) ** 2
    x, weight = np.polynomial.legendre.leggauss(_STEPS)
    place, weight = 0.5 * (x + 1.0), 0.5 * weight
    start = GROUND_RADIUS_M * np.sin(elevation)[:, None]
    length = (
        np.sqrt((GROUND_RADIUS_M + TOP_ALTITUDE_M) ** 2 - GROUND_RADIUS_M**2 + start**2) - start
    )
    along = length * place**2
    altitude = np.sqrt(GROUND_RADIUS_M**2 + along**2 + 2.0 * start * along) - GROUND_RADIUS_M
    metres = length * (2.0 * place * weight)
    kinds = extinctions_per_m(altitude, RGB_NM, haze.aerosol_layers)
    step = kinds.sum(axis=0) * metres[..., None]
    through = np.exp(-(np.cumsum(step, axis=1) - 0.5 * step))
    slope, slopes_weight = np.polynomial.legendre.leggauss(_SLOPES)
    slope, slopes_weight = 0.5 * (slope + 1.0), 0.5 * slopes_weight
    up = np.exp(-_depth_below(haze, altitude)[..., None] / slope)
    scattered = np.zeros_like(step)
    for kind, extinction in enumerate(kinds[1:]):
        phase = _mean_phase(haze, kind, elevation, slope)
        arriving = (up * phase[:, None] * slopes_weight).sum(axis=-1) * 2.0 * np.pi
        scattered += extinction * _albedo(haze, kind) * arriving
    return np.sin(elevation), np.asarray((scattered * metres[..., None] * through).sum(axis=1))


def _depth_below(haze: SetHaze, altitude: FloatArray) -> FloatArray:
    """Vertical optical depth (..., 3) between the ground and altitudes (...,)."""
    heights = TOP_ALTITUDE_M * np.linspace(0.0, 1.0, _HEIGHTS) ** 3
    each = extinctions_per_m(heights, RGB_NM, haze.aerosol_layers).sum(axis=0)
    steps = 0.5 * (each[1:] + each[:-1]) * np.diff(heights)[:, None]
    below = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    return np.stack([np.interp(altitude, heights, below[:, c]) for c in range(3)], axis=-1)


def _albedo(haze: SetHaze, kind: int) -> FloatArray:
    """Single scattering albedo (3,) of molecules (kind 0) or of a layer of aerosol."""
    return np.ones(3) if kind == 0 else haze.aerosol_layers[kind - 1].albedo_at(RGB_NM)


def _mean_phase(haze: SetHaze, kind: int, elevation: FloatArray, slope: FloatArray) -> FloatArray:
    """Phase functions (n, 3, slopes), sr^-1, of light that comes up steep as `slope`, seen at an
    elevation (n,), in the mean over its azimuths."""
    turn = np.cos((np.arange(_TURNS) + 0.5) * np.pi / _TURNS)
    across = np.cos(elevation)[:, None] * np.sqrt(1.0 - slope**2)
    cosine = -np.sin(elevation)[:, None, None] * slope[:, None] - across[..., None] * turn
    if kind == 0:
        found = 3.0 / (16.0 * np.pi) * (1.0 + cosine**2)
        return np.repeat(found.mean(axis=-1)[:, None], 3, axis=1)
    table = haze.aerosol_layers[kind - 1].phase_at(RGB_NM).values
    at = np.sqrt(np.maximum(0.5 - 0.5 * cosine, 0.0))
    nodes = np.linspace(0.0, 1.0, PHASE_NODES)
    return np.stack([np.interp(at, nodes, row).mean(axis=-1) for row in table], axis=1)
