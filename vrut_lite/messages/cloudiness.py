"""Cloudiness of an hour, from a module that has the weather."""

import numpy as np

from vrut_lite import checks
from vrut_lite.kernel.messages import Derived


class CloudinessChanged(Derived, frozen=True, kw_only=True):
    """Cloudiness of the present hour.

    Attributes:
        cover: share of the hemisphere that is cloud, 0 to 1.
        global_share: irradiance of level ground over that below a cloudless sky; None where the sun
            is too low for the ratio.
        direct_share: the sun's share of that cloudless light.
        sun_elevation_rad: apparent elevation of the hour's sun.
    """

    cover: float
    global_share: float | None
    direct_share: float
    sun_elevation_rad: float
    source: str

    def check(self) -> None:
        """Shares, and an elevation."""
        checks.number(self, "cover", 0.0, 1.0)
        if self.global_share is not None:
            checks.number(self, "global_share", 0.0, 2.0)
        checks.number(self, "direct_share", 0.0, 1.0)
        checks.number(self, "sun_elevation_rad", -0.5 * np.pi, 0.5 * np.pi)
        checks.text(self, "source")
