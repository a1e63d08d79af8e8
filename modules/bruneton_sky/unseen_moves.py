"""Moves of observer and sun that leave the picture the same to the eye."""

import math

import numpy as np

from bruneton_sky.atmosphere import Atmosphere

# Change of a texel that is not seen, relative to the larger of its value and 1 % of the map's
# maximum; the default.
RADIANCE_TOLERANCE = 1e-3
# A fifth of a texel at 256 texels an edge.
HORIZON_TOLERANCE_RAD = math.radians(0.07)
# Share by which air and fog may thin over a step.
_THINNING = 0.01


def altitude_step_m(altitude_m: float, atmosphere: Atmosphere) -> float:
    """Altitude change in m below which the picture stays the same.

    The horizon moves by 0.07 degrees at most: on the ground that is the dip from 4.7 m. Molecules
    thin by 1 % at most, and so does fog where it is denser than a hundredth of its density on the
    ground.
    """
    reach_m = math.sqrt(2.0 * atmosphere.ground_radius_m * max(altitude_m, 0.0))
    from_ground_m = 0.5 * atmosphere.ground_radius_m * HORIZON_TOLERANCE_RAD**2
    of_horizon_m = max(HORIZON_TOLERANCE_RAD * reach_m - from_ground_m, from_ground_m)
    step_m = min(from_ground_m + 0.01 * altitude_m, of_horizon_m)
    if altitude_m <= atmosphere.top_altitude_m:
        step_m = min(step_m, _THINNING * atmosphere.rayleigh_scale_height_m)
    fog_m = atmosphere.fog_scale_height_m
    if atmosphere.foggy and altitude_m < math.log(100.0) * fog_m:
        step_m = min(step_m, _THINNING * fog_m)
    return step_m


def sun_step_rad(
    elevation_rad: float, mie_g: float = 0.8, change: float = RADIANCE_TOLERANCE
) -> float:
    """Angle by which the sun may move without changing any texel by more than `change`.

    The largest relative change per degree, for haze of one lobe from none to turbidity 10 and
    observers from the ground to space: 7.1 in twilight, 1.9 at sunset, 0.8 at 4 and at 10 degrees,
    0.3 at 15, 0.12 from 25 up. A narrow aureole changes faster: in haze of a measured type texels
    beside the sun change by 1.4 times `change` (continental) to 2.7 times (desert).
    """
    elevation_deg = float(np.degrees(elevation_rad))
    if elevation_deg < 4.0:
        change_per_deg = 7.5 if elevation_deg < 0.0 else 2.0
    else:
        change_per_deg = max(0.9 * min((10.0 / elevation_deg) ** 2, 1.0), 0.13)
    aureole_per_deg = 0.035 / (1.0 - min(abs(mie_g), 0.99))
    return float(np.radians(change / max(change_per_deg, aureole_per_deg)))
