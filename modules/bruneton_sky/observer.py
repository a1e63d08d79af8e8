"""Where the observer is and where the sun: what of their moves nobody would see."""

import numpy as np

from vrut_lite.kernel.messages import Vector

# What a texel may change unseen, relative to the larger of its value and 1 % of the map's
# maximum.
RADIANCE_TOLERANCE = 1e-3


def altitude_step_m(altitude_m: float) -> float:
    """By how much an observer may rise or sink unseen.

    Haze thins by 1 % over 12 m; the horizon of one on the ground sinks by 0.07 degrees over
    5 m, a fifth of a texel at 256 texels an edge.
    """
    return 5.0 + 0.01 * altitude_m


def sun_step_rad(elevation_rad: float) -> float:
    """By what angle the sun may stray without changing any texel beyond the tolerance.

    The largest relative change per degree, for haze from none to turbidity 10 (measured, and
    measured again by `test_observer`): 2.7 in twilight, 1.25 at sunset, 0.67 at 4 degrees,
    0.27 at 10, 0.14 from 20 up.
    """
    elevation_deg = float(np.degrees(elevation_rad))
    if elevation_deg < 4.0:
        change_per_deg = 3.0 if elevation_deg < 0.0 else 1.3
    else:
        change_per_deg = max(5.0 / elevation_deg, 0.15)
    return float(np.radians(RADIANCE_TOLERANCE / change_per_deg))


def same_to_the_eye(shown: Vector, now: Vector) -> bool:
    """Whether two directions to the sun make the same picture."""
    chord = float(np.linalg.norm(np.subtract(shown, now)))
    return chord <= sun_step_rad(float(np.arcsin(np.clip(shown[1], -1.0, 1.0))))
