"""What every program is asked for: a latitude-longitude picture of the sky, the sun in its middle.

Errors are taken at every fourth pixel each way of the upper half, or of the lower half from space.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.numeric_types import FloatArray, Vector

HEIGHT, STEP = 256, 4
WIDTH = 2 * HEIGHT
SUNS_DEG = (60.0, 30.0, 10.0, 3.0, 0.0, -3.0, -6.0, -12.0)
# Aloft: one high and one low sun.
SUNS_ALOFT_DEG = (30.0, 3.0)
ALOFT_M, SPACE_M = 10_000.0, 100_000.0
# Below it the truth is Monte Carlo itself.
LOWEST_SOLVED_DEG = -6.0


class SkyViewpoint(NamedTuple):
    """Where the sun stands, and the observer above the ground."""

    sun_deg: float
    altitude_m: float = 0.0

    @property
    def sun_direction(self) -> Vector:
        """To the sun, in world axes: north, which is in the middle of the picture."""
        elevation = np.radians(self.sun_deg)
        return (0.0, float(np.sin(elevation)), -float(np.cos(elevation)))

    @property
    def title(self) -> str:
        """As in `sun 30°, 10 km`."""
        where = f", {self.altitude_m / 1000:g} km" if self.altitude_m else ""
        return f"sun {self.sun_deg:g}°{where}"


TIMED = SkyViewpoint(30.0)
ON_GROUND = tuple(SkyViewpoint(sun) for sun in SUNS_DEG)
ALOFT = tuple(SkyViewpoint(sun, height) for height in (ALOFT_M, SPACE_M) for sun in SUNS_ALOFT_DEG)


class HalfRays(NamedTuple):
    """Directions (rows, columns) of one half of the measured pixels, east of the sun.

    Attributes:
        mu: cosine of the zenith angle.
        nu: cosine of the angle from the sun.
        weight: solid angle, of sum 1.
        azimuth_rad: from the sun's.
    """

    mu: FloatArray
    nu: FloatArray
    weight: FloatArray
    azimuth_rad: FloatArray


@lru_cache(maxsize=32)
def rays(view: SkyViewpoint) -> HalfRays:
    """The rays of a view."""
    direction = of_picture(lat_long_directions(HEIGHT), view)[:, _columns() :]
    mu = direction[..., 1]
    nu = np.clip(direction @ np.array(view.sun_direction), -1.0, 1.0)
    level = np.sqrt(1.0 - mu**2)
    azimuth = np.arctan2(direction[..., 0], -direction[..., 2])
    return HalfRays(mu, nu, level / level.sum(), azimuth)


def of_picture(picture: NDArray[np.floating], view: SkyViewpoint) -> FloatArray:
    """The measured pixels (rows, 2 columns, 3) of a picture (256, 512, 3)."""
    half = HEIGHT // 2
    first = half if view.altitude_m >= SPACE_M else 0
    # Mirror images about the sun: a sky's two sides are measured alike.
    part = np.asarray(picture[first : first + half], float)
    east = part[STEP // 2 :: STEP, WIDTH // 2 + STEP // 2 :: STEP]
    west = part[STEP // 2 :: STEP, WIDTH // 2 - 1 - STEP // 2 :: -STEP][:, ::-1]
    return np.concatenate([west, east], axis=1)


def whole(half: FloatArray) -> FloatArray:
    """Both sides (rows, 2 columns, 3) of a sky that is known east of the sun."""
    return np.concatenate([half[:, ::-1], half], axis=1)


def _columns() -> int:
    return WIDTH // 2 // STEP
