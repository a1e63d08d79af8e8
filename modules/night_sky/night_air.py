"""Transmission of light from above the air: the air dims it and scatters half of the loss down.

The share T + s (1 - T) of an even sky arrives, T the air's transmittance: within 0.03 of all orders
by Bruneton's solved field from the zenith to 85 deg, with s = 0.45 and aerosol of depth 0.05. The
air's own radiance is that of the mean light above it.
"""

from typing import NamedTuple

import numpy as np

from vrut_lite.atmosphere.refraction import dip_rad
from vrut_lite.atmosphere.sunlight import slant_depth
from vrut_lite.messages.haze import SetHaze
from vrut_lite.numeric_types import FloatArray

# Where linear sRGB has its weight.
RGB_NM = np.array([610.0, 550.0, 465.0])
# Share of the light that the air takes from an even sky and that reaches the ground.
SENT_DOWN = 0.45
_NODES = 181


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
    sine = np.sin(elevation)
    depth = slant_depth(eye_height_m, sine, RGB_NM, haze.aerosol_layers, haze.nitrogen_dioxide)
    return NightAir(haze, sine, np.exp(-depth))
