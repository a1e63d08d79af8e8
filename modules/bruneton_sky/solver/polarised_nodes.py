"""Q and U at the solver's nodes, for four wavelengths: see `polarisation`."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.solver.bin_kernels import Bins
from bruneton_sky.solver.grid import SunGrid, azimuths
from bruneton_sky.solver.node_kernels import bin_nodes
from bruneton_sky.solver.particles import phase_cosines, phase_tables
from bruneton_sky.solver.polarisation import (
    MOLECULES_RATIO,
    PolarisedOperator,
    particles_chi,
    polarised_operator,
    polarised_phases,
)
from bruneton_sky.solver.polarisation_kernels import first_polarised, next_polarised
from bruneton_sky.solver.sizes import LATER, SolverSizes
from bruneton_sky.solver.wavelength_groups import LANES, WavelengthGroup, in_lanes
from vrut_lite.numeric_types import FloatArray

if TYPE_CHECKING:
    from bruneton_sky.solver.later_order_kernels import Source

Lanes = NDArray[np.float32]


class PolarisedNodes(NamedTuple):
    """The solver's nodes with fewer directions, for Q and U.

    `phase` (altitudes or 1, n, 5): P12 of molecules and particles, see `apply_phases`. `chi`
    (3, altitudes or 1, harmonics, suns * 4): chi12, chi22 and chi33 of particles.
    """

    air: WavelengthGroup
    altitude_m: FloatArray
    suns: SunGrid
    operator: PolarisedOperator
    bins: Bins
    higher_bins: Bins
    turn: FloatArray
    phase: Lanes
    chi: Lanes

    def first(self, transmittance: Lanes) -> Lanes:
        """Coefficients (altitudes, 2, harmonics, suns * 4) of light scattered once."""
        polarised, directions = self._empty(), self.operator.directions
        first_polarised(
            self.air, self.altitude_m, directions.mu, self.bins, transmittance, self.suns.mu_s,
            np.cos(self.turn), self.phase, _by_ray(polarised),
        )  # fmt: skip
        return self.operator.project(polarised)

    def next(self, source: "Source", radiance: Lanes, polarised: Lanes) -> Lanes:
        """Coefficients of the next order, from those of the last and the source of its radiance."""
        tables = np.empty((2, 0, 2, 2, radiance.shape[-1]), np.float32)
        if self.air.scattering[1:].any():
            tables = self.operator.tables(self.scattered(radiance, polarised))
        place = np.linspace(0.0, 1.0, self.operator.turn_out.shape[1])
        turned = source._replace(azimuth_cosine=(1.0 - 2.0 * place**2).astype(np.float32))
        following, directions = self._empty(), self.operator.directions
        next_polarised(
            self.air, self.altitude_m, directions.mu, self.higher_bins, turned, tables,
            self.suns.mu_s, np.cos(self.turn), _by_ray(following),
        )  # fmt: skip
        return self.operator.project(following)

    def fed(self, polarised: Lanes) -> tuple[Lanes, tuple[NDArray[np.int64], Lanes]]:
        """Radiance added by Q and U: for molecules, before they scatter it, at degree 2
        (altitudes, 3, suns * 4); for particles, after they have, places (n,) and (altitudes, n,
        suns * 4)."""
        e = polarised[:, 0]
        molecules = np.float32(MOLECULES_RATIO) * e[:, self.operator.degree == 2]
        return molecules, (self.operator.radiance_index, e * self.chi[0])

    def scattered(self, radiance: Lanes, polarised: Lanes) -> Lanes:
        """The coefficients of Q and U that particles scatter, of light with such coefficients."""
        shared = self.operator.radiance_index < radiance.shape[1]
        made = polarised[:, 0] * self.chi[1]
        made[:, shared] += (
            self.chi[0][:, shared] * radiance[:, self.operator.radiance_index[shared]]
        )
        return np.stack([made, polarised[:, 1] * self.chi[2]], axis=1)

    def _empty(self) -> Lanes:
        shape = *self.operator.directions.mu.shape, self.turn.size, self.suns.mu_s.size * LANES
        return np.empty((2, *shape), dtype=np.float32)


def _by_ray(polarised: Lanes) -> Lanes:
    return polarised.reshape(*polarised.shape[:3], -1)


def make_polarised_nodes(
    atmosphere: Atmosphere,
    air: WavelengthGroup,
    sizes: SolverSizes,
    altitude_m: FloatArray,
    group: int,
) -> PolarisedNodes:
    """The nodes for a group of an atmosphere's wavelengths, whose air is `air`."""
    operator = polarised_operator(atmosphere.ground_radius_m, tuple(altitude_m), sizes)
    later_count = min(sizes.polarised_bins, sizes.bins_of(LATER))
    directions, suns = operator.directions, SunGrid(atmosphere, sizes.mu_s)
    bins, later = (
        Bins.empty(directions.mu.shape, count) for count in (sizes.node_bins, later_count)
    )
    bin_nodes(air, altitude_m, directions.mu, directions.downward, sizes.steps, bins, later)
    chi = in_lanes(particles_chi(atmosphere, sizes, altitude_m))[group].astype(np.float32)
    chi = np.tile(chi[:, :, operator.degree], sizes.mu_s)
    turn = azimuths(sizes.polarised_azimuth)
    phases = polarised_phases(atmosphere, sizes.degree, phase_cosines(), altitude_m)
    phase = phase_tables(*phases)[group]
    return PolarisedNodes(air, altitude_m, suns, operator, bins, later, turn, phase, chi)
