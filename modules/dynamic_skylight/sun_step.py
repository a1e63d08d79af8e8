"""The largest move of the sun that leaves the picture of the sky as it is."""

import numpy as np

# The largest unseen change of a texel by default, relative to the larger of its value and 1 % of
# the map's maximum.
RADIANCE_TOLERANCE = 1e-3


def sun_step_rad(apparent_elevation_rad: float, change: float = RADIANCE_TOLERANCE) -> float:
    """The angle (rad) by which the sun may move without changing any texel by more than `change`.

    The model's largest change per degree, over turbidity 1 to 10 and albedo 0 to 1, measured:
    3.7 at 1 to 2 deg of elevation (blue, in clear air, opposite the sun), 1.2 at 4 deg, 0.41 at
    7 deg, 0.34 at 10, 0.14 at 20, and 0.09 from 40 deg up; in twilight 2.5 at -1 deg and 5.8 at
    -18. 6 below the horizon, 4 below 7 deg, 4 over the elevation above, and never less than 0.1
    stays above all of them.
    """
    elevation_deg = float(np.degrees(apparent_elevation_rad))
    if elevation_deg < 7.0:
        change_per_deg = 6.0 if elevation_deg < 0.0 else 4.0
    else:
        change_per_deg = max(4.0 / elevation_deg, 0.1)
    return float(np.radians(change / change_per_deg))
