"""Transmission of light from above the air: the air dims it and scatters half of the loss down.

The share T + s (1 - T) of an even sky arrives, T the air's transmittance: within 0.03 of all orders
by Bruneton's solved field from the zenith to 85 deg, with s = 0.45 and aerosol of depth 0.05. The
air's own radiance is that of the mean light above it.

Rays are straight, from any height: the air before a star lies on the line towards it.
"""

from typing import NamedTuple

import numpy as np

from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.atmosphere.refraction import dip_rad
from vrut_lite.messages.haze import SetHaze
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.clear_sun import extinction_per_m

# Where linear sRGB has its weight.
RGB_NM = np.array([610.0, 550.0, 465.0])
# Share of the light that the air takes from an even sky and that reaches the ground.
SENT_DOWN = 0.45
_NODES = 181
TOP_M = 120_000.0
# Quadrature nodes of a part of a ray, denser in dense air.
_STEPS = 48


class NightAir(NamedTuple):
    """Transmittance (n, 3) of the air from an eye to space by the sine (n,) of the apparent
    elevation, from the horizon up, in a haze."""

    haze: SetHaze
    sine: FloatArray
    transmittance: FloatArray

    def through(self, sine: FloatArray) -> FloatArray:
        """Transmittance (..., 3) towards a height; that of the horizon below it."""
        at = np.asarray(sine, dtype=float)
        return np.stack(
            [np.interp(at, self.sine, self.transmittance[:, c]) for c in range(3)], axis=-1
        )


def night_air(haze: SetHaze, eye_height_m: float = 0.0) -> NightAir:
    """The air of the place's haze before an eye."""
    lowest = -dip_rad(eye_height_m)
    elevation = lowest + (0.5 * np.pi - lowest) * np.linspace(0.0, 1.0, _NODES) ** 2
    return NightAir(haze, np.sin(elevation), np.exp(-_depth(haze, eye_height_m, elevation)))


def _depth(haze: SetHaze, eye_height_m: float, elevation: FloatArray) -> FloatArray:
    """Optical depth (n, 3) from an eye to space along straight rays.

    A ray is followed by its distance from where it is nearest to the planet, forth and, of one that
    descends, back.
    """
    impact = (GROUND_RADIUS_M + eye_height_m) * np.cos(elevation)
    eye = (GROUND_RADIUS_M + eye_height_m) * np.sin(elevation)
    top = np.sqrt(np.maximum((GROUND_RADIUS_M + TOP_M) ** 2 - impact**2, 0.0))
    start = np.clip(eye, -top, top)
    up = _part(haze, impact, np.maximum(start, 0.0), top)
    return up + _part(haze, impact, np.zeros_like(start), np.maximum(-start, 0.0))


def _part(haze: SetHaze, impact: FloatArray, near: FloatArray, far: FloatArray) -> FloatArray:
    """Depth (n, 3) between two distances (n,) from a ray's lowest place, dense near the first."""
    x, weight = np.polynomial.legendre.leggauss(_STEPS)
    place, weight = 0.5 * (x + 1.0), 0.5 * weight
    along = near[:, None] + (far - near)[:, None] * place**2
    altitude = np.maximum(np.hypot(impact[:, None], along) - GROUND_RADIUS_M, 0.0)
    metres = (far - near)[:, None] * (2.0 * place * weight)
    return np.asarray((extinction_per_m(haze, altitude, RGB_NM) * metres[..., None]).sum(axis=1))
