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
TURBIDITIES = (1.1, 3.2, 4.2, 5.8, 7.0, 7.9, 8.7, 9.7)
LEVELS = (
    (0.534, 0.553, 0.541, 0.530, 0.528, 0.526, 0.513),
    (0.524, 0.560, 0.561, 0.545, 0.539, 0.543, 0.538),
    (0.528, 0.570, 0.575, 0.557, 0.548, 0.566, 0.569),
    (0.513, 0.584, 0.597, 0.572, 0.559, 0.571, 0.600),
    (0.513, 0.607, 0.636, 0.621, 0.597, 0.604, 0.651),
    (0.499, 0.616, 0.672, 0.639, 0.600, 0.602, 0.703),
    (0.481, 0.634, 0.764, 0.708, 0.640, 0.623, 0.783),
    (0.467, 0.657, 0.887, 0.809, 0.712, 0.672, 0.895),
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
