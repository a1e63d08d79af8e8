"""The solver's result: the light of orders two and up that every point of the air scatters."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.solver.between_suns import SingleArray, sun_bend
from bruneton_sky.solver.delta_m import thinned
from bruneton_sky.solver.grid import SunGrid
from bruneton_sky.solver.later_order_kernels import Source
from bruneton_sky.solver.sizes import SolverSizes
from vrut_lite.numeric_types import FloatArray

if TYPE_CHECKING:
    from bruneton_sky.solver.later_order_kernels import Source


# Compared by identity, so that results of one field can be cached by it.
@dataclass(frozen=True, kw_only=True, eq=False)
class SourceField:
    """The source function J of orders two and up, by altitude, direction, azimuth and sun.

    Light is scattered toward a direction with radiance J per optical depth of scattering:
    J is in W m^-2 sr^-1 nm^-1. Molecules and aerosol scatter differently, and have one each.

    Attributes:
        atmosphere, sizes: what it was solved for.
        rayleigh, mie: (groups, altitudes, mu, azimuths, suns * 4) float32, four wavelengths a
            group; without altitudes where there is nothing to scatter.
        polarised: (groups, altitudes, 2, harmonics, suns * 4) float32: e and b of aerosol's Q and
            U (see `polarisation`; molecules' follow from `rayleigh`), without altitudes where there
            is no aerosol; None if not all orders are polarised.
        transmittance: (groups, altitudes, columns * 4) float32, of the sun's light.
        orders_done: the highest order that was computed.
        tail_ratio: (suns, C), by which each order beyond follows the one before; zero if the
            orders beyond are left out.
        skipped: how often each term was left out because it is zero or too small.
    """

    atmosphere: Atmosphere
    sizes: SolverSizes
    rayleigh: SingleArray
    mie: SingleArray
    polarised: SingleArray | None
    transmittance: SingleArray
    orders_done: int
    tail_ratio: FloatArray
    skipped: dict[str, int] = field(default_factory=dict)

    @property
    def thinned(self) -> Atmosphere:
        """The air for all light but the sun's disc: see `delta_m`."""
        return thinned(self.atmosphere, self.sizes.degree)


def source_of_group(field: SourceField, group: int) -> "Source":
    """The source function of a group of wavelengths as the kernels take it."""
    suns = SunGrid(field.atmosphere, field.sizes.mu_s)
    return make_source(field.rayleigh[group], field.mie[group], suns)


def make_source(rayleigh: SingleArray, mie: SingleArray, suns: SunGrid) -> "Source":
    """The source function as kernels take it, of the arrays of a `SourceField`."""
    azimuth_cosine = 1.0 - 2.0 * np.linspace(0.0, 1.0, mie.shape[2]) ** 2
    pace = np.append(np.diff(suns.mu_s) ** -2.0, 0.0) / 12.0
    return Source(
        rayleigh, mie, azimuth_cosine.astype(np.float32), suns.constants(),
        sun_bend(rayleigh, mie, suns.mu_s), pace.astype(np.float32),
    )  # fmt: skip
