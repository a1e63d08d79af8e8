"""The visible share of the sun's disc above a level horizon."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

# At one astronomical unit: solar radius 696 000 km over 149 597 871 km. Over the year the
# true radius differs by up to 1.7 %. The Hosek-Wilkie disc is 0.255 deg; between the two the
# irradiance is conserved.
MEAN_ANGULAR_RADIUS_RAD = float(np.arcsin(696_000.0 / 149_597_870.7))


def visible_fraction(
    apparent_elevation_rad: ArrayLike, angular_radius_rad: float = MEAN_ANGULAR_RADIUS_RAD
) -> NDArray[np.float64]:
    """Share (...,) of a round disc's area above the horizon, from its centre's elevation."""
    t = np.clip(np.asarray(apparent_elevation_rad, dtype=float) / angular_radius_rad, -1.0, 1.0)
    # At t = 1 rounding may make the sum an ulp larger than 1.
    share = 0.5 + (t * np.sqrt(1.0 - t * t) + np.arcsin(t)) / np.pi
    return np.clip(share, 0.0, 1.0)
