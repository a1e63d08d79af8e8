"""What the air does to light from above it: dims it, and sends half of what it takes down again.

Of an even sky the share T + s (1 - T) arrives, T the air's transmittance: within 0.03 of all orders
by Bruneton's solved field from the zenith to 85 deg, with s = 0.45 and aerosol of depth 0.05. So
the air glows like the mean of what is above it.
"""

from typing import NamedTuple

import numpy as np

from vrut_lite.daylight.clear_sun import slant_depth
from vrut_lite.daylight.haze import SetHaze
from vrut_lite.numeric_types import FloatArray

# Where linear sRGB has its weight.
RGB_NM = np.array([610.0, 550.0, 465.0])
# Share of the light that the air takes from an even sky and that reaches the ground.
SENT_DOWN = 0.45
_NODES = 181


class NightAir(NamedTuple):
    """Transmittance (n, 3) of the air to space by the sine (n,) of the apparent elevation."""

    sine: FloatArray
    transmittance: FloatArray

    def through(self, sine: FloatArray) -> FloatArray:
        """Transmittance (..., 3) towards a height; that of the horizon below it."""
        at = np.asarray(sine, dtype=float)
        return np.stack(
            [np.interp(at, self.sine, self.transmittance[:, c]) for c in range(3)], axis=-1
        )


def night_air(haze: SetHaze) -> NightAir:
    """The air of the place's haze."""
    elevation = 0.5 * np.pi * np.linspace(0.0, 1.0, _NODES) ** 2
    depth = np.stack([slant_depth(haze, float(angle), RGB_NM) for angle in elevation])
    return NightAir(np.sin(elevation), np.exp(-depth))
