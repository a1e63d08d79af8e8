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
TURBIDITIES = (1.1, 3.2, 4.2, 5.8, 7.0, 7.9, 8.8, 9.7)
LEVELS = (
    (0.533, 0.553, 0.541, 0.530, 0.527, 0.526, 0.512),
    (0.524, 0.558, 0.560, 0.547, 0.539, 0.545, 0.540),
    (0.528, 0.570, 0.575, 0.558, 0.549, 0.568, 0.569),
    (0.511, 0.583, 0.596, 0.572, 0.561, 0.571, 0.602),
    (0.512, 0.606, 0.635, 0.620, 0.597, 0.604, 0.652),
    (0.502, 0.616, 0.671, 0.639, 0.599, 0.602, 0.703),
    (0.489, 0.638, 0.769, 0.704, 0.644, 0.617, 0.772),
    (0.468, 0.658, 0.887, 0.810, 0.712, 0.672, 0.895),
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
