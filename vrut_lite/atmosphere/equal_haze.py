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
TURBIDITIES = (1.1, 3.1, 4.2, 5.7, 7.0, 7.9, 8.8, 9.7)
LEVELS = (
    (0.532, 0.552, 0.540, 0.529, 0.527, 0.525, 0.512),
    (0.522, 0.562, 0.563, 0.550, 0.543, 0.550, 0.536),
    (0.527, 0.569, 0.574, 0.556, 0.547, 0.566, 0.569),
    (0.514, 0.583, 0.600, 0.575, 0.565, 0.573, 0.602),
    (0.512, 0.606, 0.635, 0.620, 0.597, 0.595, 0.651),
    (0.501, 0.615, 0.671, 0.639, 0.600, 0.600, 0.703),
    (0.488, 0.637, 0.769, 0.701, 0.644, 0.623, 0.772),
    (0.467, 0.657, 0.887, 0.809, 0.712, 0.668, 0.895),
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
