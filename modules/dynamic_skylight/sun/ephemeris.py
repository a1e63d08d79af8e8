"""The sun from an ephemeris: astronomy-engine (D. Cross), after VSOP87 and IAU nutation."""

from datetime import UTC, datetime

import astronomy
import numpy as np

_J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)


def geometric_angles(
    when: datetime, latitude_deg: float, longitude_deg: float, altitude_m: float
) -> tuple[float, float]:
    """Topocentric azimuth (from north, clockwise) and geometric elevation, in radians.

    Within 0.0006 deg of NREL's SPA from 1950 to 2080. UTC is taken for UT1: 0.9 s, which is
    0.004 deg, at most.
    """
    time = astronomy.Time((when - _J2000).total_seconds() / 86_400.0)
    observer = astronomy.Observer(latitude_deg, longitude_deg, altitude_m)
    equator = astronomy.Equator(astronomy.Body.Sun, time, observer, ofdate=True, aberration=True)
    horizon = astronomy.Horizon(
        time, observer, equator.ra, equator.dec, astronomy.Refraction.Airless
    )
    return float(np.radians(horizon.azimuth)), float(np.radians(horizon.altitude))
