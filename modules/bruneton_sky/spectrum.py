"""The sky's spectrum in a direction.

Skies are solved at four wavelengths; a spectrum needs more, which takes about a second. The last
atmosphere's solution is cached: only the first direction waits for it.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.solved_sky import SolvedSky
from bruneton_sky.solver_job import solve_air
from vrut_lite.kernel.job import JobControl
from vrut_lite.numeric_types import Vector

# From violet to red; three groups of four, as the solver takes them.
SPECTRUM_NM = tuple(np.linspace(390.0, 720.0, 12).tolist())


class SkySpectrum(NamedTuple):
    """Radiance (12,) at `SPECTRUM_NM` in a direction, W m^-2 sr^-1 nm^-1."""

    direction: Vector
    radiance: NDArray[np.float64]


def sky_spectrum(
    atmosphere: Atmosphere,
    orders: int,
    altitude_m: float,
    direction: Vector,
    sun_direction: Vector,
    control: JobControl | None = None,
) -> SkySpectrum:
    """The spectral radiance of the sky above the horizon, without the sun's disc.

    The atmosphere has the wavelengths `SPECTRUM_NM`. Directions are unit vectors in world axes.
    """
    cosines = direction[1], sun_direction[1], float(np.dot(direction, sun_direction))
    sky = _solved(atmosphere, orders)
    return SkySpectrum(direction, sky.radiance(max(altitude_m, 0.0), *np.clip(cosines, -1.0, 1.0)))


@lru_cache(maxsize=1)
def _solved(atmosphere: Atmosphere, orders: int) -> SolvedSky:
    return SolvedSky(field=solve_air(atmosphere, orders))
