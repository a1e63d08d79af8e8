"""The sky's spectrum in a direction.

Skies are solved at four wavelengths; a spectrum needs more, which takes about a second. The last
atmosphere's solution is cached: only the first direction waits for it.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.solver import SourceField, multiple_scattering, single_scattering_fast
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

    The atmosphere has the wavelengths `SPECTRUM_NM`. Directions are unit vectors in world axes; an
    observer above the air is moved to its top.
    """
    altitude_m = min(max(altitude_m, 0.0), atmosphere.top_altitude_m)
    mu, mu_s = np.array([direction[1]]), float(np.clip(sun_direction[1], -1.0, 1.0))
    nu = np.array([float(np.dot(direction, sun_direction))])
    view = (_solved(atmosphere, orders), altitude_m, mu, mu_s, nu)
    by_molecules, by_aerosol = single_scattering_fast(*view)
    once = by_molecules * rayleigh_phase(nu) + by_aerosol * mie_phase(atmosphere, nu)
    return SkySpectrum(direction, (once + multiple_scattering(*view))[0])


@lru_cache(maxsize=1)
def _solved(atmosphere: Atmosphere, orders: int) -> SourceField:
    return solve_air(atmosphere, orders)
