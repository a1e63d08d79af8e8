"""What the solver leaves: the light that every point of the air scatters, of orders two and up."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.solver.sizes import SolverSizes
from vrut_lite.numeric_types import FloatArray


# Fields are told apart by identity, so that what follows from one can be kept for it.
@dataclass(frozen=True, kw_only=True, eq=False)
class SourceField:
    """The source function J of orders two and up, by altitude, direction, azimuth and sun.

    Light is scattered toward a direction with radiance J per optical depth of scattering:
    J is in W m^-2 sr^-1 nm^-1. Molecules and aerosol scatter differently, and have one each.

    Attributes:
        atmosphere, sizes: what it was solved for.
        rayleigh, mie: (groups, altitudes, mu, azimuths, suns * 4) float32, four wavelengths a
            group; without altitudes where there is nothing to scatter.
        transmittance: (groups, altitudes, columns * 4) float32, of the sun's light.
        orders_done: the highest order that was computed.
        tail_ratio: (suns, C), by which each order beyond follows the one before; zero if the
            orders beyond are left out.
        skipped: what was left out because it is zero or too small, and how often.
    """

    atmosphere: Atmosphere
    sizes: SolverSizes
    rayleigh: NDArray[np.float32]
    mie: NDArray[np.float32]
    transmittance: NDArray[np.float32]
    orders_done: int
    tail_ratio: FloatArray
    skipped: dict[str, int] = field(default_factory=dict)
