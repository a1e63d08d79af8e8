"""Turbidity and level at which Hosek and Wilkie's sky shows the same haze as the solved sky.

Their turbidity is not Preetham's: at equal optical depth theirs is two to three times as high, and
the sky then 1.1 to 2 times too bright. The table brings shape and level together. It was fitted to
skies of this project's solver under OPAC's continental average (vrut_lite_lab.hosek_wilkie_fit): no
measurement enters. With it nine tenths of the sky's luminance lie within 0.8 to 1.25 of the solved
sky's, for suns from 10 degrees up and depths to 0.2. Beyond depth 0.5, or of other aerosol, the
model cannot follow: the last row holds.
"""

from typing import NamedTuple

import numpy as np

from vrut_lite.atmosphere.aerosol import LEAST_TURBIDITY, MOST_TURBIDITY

DEPTHS = (0.0, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.5)
ELEVATIONS_DEG = (5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0)
MOST_DEPTH = DEPTHS[-1]
# Turbidity by depth, and level by depth and elevation.
TURBIDITIES = (1.0, 3.0, 4.1, 5.1, 6.8, 7.6, 8.7, 9.7)
LEVELS = (
    (0.565, 0.600, 0.592, 0.584, 0.586, 0.593, 0.573),
    (0.560, 0.614, 0.617, 0.606, 0.601, 0.611, 0.586),
    (0.555, 0.608, 0.626, 0.609, 0.602, 0.617, 0.633),
    (0.556, 0.632, 0.655, 0.634, 0.621, 0.636, 0.652),
    (0.541, 0.636, 0.682, 0.658, 0.636, 0.639, 0.682),
    (0.509, 0.644, 0.716, 0.682, 0.647, 0.648, 0.739),
    (0.488, 0.672, 0.805, 0.744, 0.668, 0.654, 0.789),
    (0.487, 0.683, 0.883, 0.810, 0.710, 0.673, 0.906),
)


class EqualSky(NamedTuple):
    """The turbidity of the model, and the factor on its radiance."""

    turbidity: float
    level: float


def equal_sky(optical_depth_550: float, sun_elevation_rad: float) -> EqualSky:
    """The sky of equal haze; the sun's elevation is the apparent one.

    Beyond the table's ends the last values hold.
    """
    elevation_deg = float(np.degrees(sun_elevation_rad))
    by_depth = [np.interp(elevation_deg, ELEVATIONS_DEG, row) for row in LEVELS]
    turbidity = float(np.interp(optical_depth_550, DEPTHS, TURBIDITIES))
    return EqualSky(
        min(max(turbidity, LEAST_TURBIDITY), MOST_TURBIDITY),
        float(np.interp(optical_depth_550, DEPTHS, by_depth)),
    )
