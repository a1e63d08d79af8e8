"""A measured shadow: its bearing, its length over the object's height, and their errors.

The object is vertical, the ground level. The shadow points away from the sun, and its length is the
object's height over the tangent of the sun's apparent elevation.
"""

from dataclasses import dataclass

import numpy as np

from vrut_lite.atmosphere.refraction import geometric_elevation
from vrut_lite.errors import UserError
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.suns import Suns
from vrut_lite.sky.visible_disc import MEAN_ANGULAR_RADIUS_RAD

BEARING_ERROR_DEG, RATIO_ERROR = 2.0, 0.05
MOST_RATIO = 1000.0
# Uncertainty of refraction, as a share of it: on the horizon 0.16 degrees, the standard deviation
# that Schaefer and Liller (1990, PASP 102, 796) observed there.
_REFRACTION_SHARE = 0.28


@dataclass(frozen=True)
class MeasuredShadow:
    """Bearing and length ratio of a shadow as measured; at least one of them.

    Attributes:
        bearing_deg: direction in which the shadow points, clockwise from true north; or None.
        length_ratio: its length over the object's height, above 0; or None.
        bearing_error_deg: half width of the bearings that fit.
        ratio_error: the same of the ratio, as a share of it, below 1.
    """

    bearing_deg: float | None
    length_ratio: float | None
    bearing_error_deg: float = BEARING_ERROR_DEG
    ratio_error: float = RATIO_ERROR

    def __post_init__(self) -> None:
        if self.bearing_deg is None and self.length_ratio is None:
            raise UserError("a shadow needs its bearing, its length ratio or both: name one")

    @property
    def elevation_rad(self) -> float:
        """Apparent elevation of the sun by the ratio."""
        assert self.length_ratio is not None
        return float(np.arctan2(1.0, self.length_ratio))

    @property
    def elevations_rad(self) -> tuple[float, float]:
        """Lowest and highest apparent elevation that fit the ratio.

        The tip lies in a penumbra as wide as the disc; the air's refraction varies from day to day.
        """
        assert self.length_ratio is not None
        low, high = (
            float(np.arctan2(1.0, self.length_ratio * (1.0 + sign * self.ratio_error)))
            for sign in (1.0, -1.0)
        )
        bent = self.elevation_rad - float(geometric_elevation(self.elevation_rad))
        blur = MEAN_ANGULAR_RADIUS_RAD + _REFRACTION_SHARE * abs(bent)
        return max(low - blur, 0.0), min(high + blur, 0.5 * np.pi)

    def across(self, suns: Suns) -> FloatArray:
        """Sine of the angle (...,) from the bearing clockwise to the shadow, times its vector.

        The vector is the sun's, levelled: smooth also where the sun passes the zenith.
        """
        assert self.bearing_deg is not None
        turn = suns.azimuth_rad + np.pi - np.radians(self.bearing_deg)
        return np.asarray(np.cos(suns.elevation_rad) * np.sin(turn))

    def points_along(self, suns: Suns) -> FloatArray:
        """Whether (...,) the shadow points rather along the bearing than against it."""
        assert self.bearing_deg is not None
        return np.cos(suns.azimuth_rad + np.pi - np.radians(self.bearing_deg)) > 0.0

    def higher(self, suns: Suns) -> FloatArray:
        """Apparent elevation (...,) above that of the ratio, rad."""
        return np.asarray(suns.apparent_elevation_rad - self.elevation_rad)

    def bearing_misfit(self, suns: Suns) -> FloatArray:
        """Difference (...,) of the bearing over what fits: 1 at the edge.

        The blur of a shadow's sides is the disc's width, seen from the foot of the object.
        """
        assert self.bearing_deg is not None
        turn = suns.azimuth_rad - np.radians(self.bearing_deg)
        # The sun stands opposite to the shadow.
        off = np.abs(np.pi - turn % (2.0 * np.pi))
        width = MEAN_ANGULAR_RADIUS_RAD / np.maximum(np.cos(suns.apparent_elevation_rad), 1e-9)
        # A disc around the zenith casts shadows to all sides.
        blur = np.where(width < 1.0, np.arcsin(np.minimum(width, 1.0)), np.pi)
        return np.asarray(off / (np.radians(self.bearing_error_deg) + blur))

    def ratio_misfit(self, suns: Suns) -> FloatArray:
        """Difference (...,) of the elevation over what fits: 1 at the edge."""
        low, high = self.elevations_rad
        off = self.higher(suns)
        room = np.where(off > 0.0, high - self.elevation_rad, self.elevation_rad - low)
        return np.asarray(np.abs(off) / np.maximum(room, 1e-9))

    def misfits(self, suns: Suns) -> list[FloatArray]:
        """Misfits (...,) of the measured quantities."""
        found = []
        if self.bearing_deg is not None:
            found.append(self.bearing_misfit(suns))
        if self.length_ratio is not None:
            found.append(self.ratio_misfit(suns))
        return found
