"""The solver's nodes for four wavelengths: the light that arrives, and its source function."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import rayleigh_phase
from bruneton_sky.solver.bin_kernels import Bins
from bruneton_sky.solver.first_order_kernels import fill_transmittance
from bruneton_sky.solver.grid import SunGrid, altitude_nodes, azimuths
from bruneton_sky.solver.node_kernels import bin_nodes, first_radiance, next_radiance
from bruneton_sky.solver.particles import (
    mixed_coefficients,
    phase_cosines,
    phase_tables,
    shares_above,
    shares_at,
    shown_phase,
)
from bruneton_sky.solver.polarised_nodes import PolarisedNodes, make_polarised_nodes
from bruneton_sky.solver.ray_kernels import layer_nodes, nodes_of_axis
from bruneton_sky.solver.scattering_operator import (
    ScatteringOperator,
    scattering_operator,
)
from bruneton_sky.solver.sizes import LATER, SolverSizes
from bruneton_sky.solver.source_field import make_source
from bruneton_sky.solver.wavelength_groups import LANES, WavelengthGroup, in_lanes
from vrut_lite.numeric_types import FloatArray

if TYPE_CHECKING:
    from bruneton_sky.solver.bin_kernels import Bins
    from bruneton_sky.solver.later_order_kernels import Source

Lanes = NDArray[np.float32]
_TRANSMITTANCE_ROWS, _TRANSMITTANCE_COLUMNS = 64, 256


class NodeLight(NamedTuple):
    """Light at the nodes in harmonics: radiance (altitudes, harmonics, suns * 4), and Q and U
    (altitudes, 2, harmonics, suns * 4), see `polarisation`, or none if it counts as unpolarised."""

    radiance: Lanes
    polarised: Lanes | None = None


class Nodes(NamedTuple):
    """Altitudes, directions and suns, and the rays that end there, in bins.

    `higher_bins` are for the light of orders three and up; `bins_left_out` counts the bins that
    rays through little air do not need. `mie_chi` (altitudes or 1, degrees, 4): of the particles'
    phase functions. `polarised`: None in scalar transfer.
    """

    air: WavelengthGroup
    sizes: SolverSizes
    altitude_m: FloatArray
    suns: SunGrid
    operator: ScatteringOperator
    bins: "Bins"
    higher_bins: "Bins"
    bins_left_out: int
    mie_chi: Lanes
    polarised: PolarisedNodes | None

    def first_radiance(self, transmittance: Lanes, phase: Lanes) -> Lanes:
        """Light that arrives at the nodes after one scattering or reflection.

        Args:
            transmittance: (altitudes, columns * 4), of the sun's light.
            phase: see `fed_phase_tables`.

        Returns:
            (altitudes, mu, azimuths, suns * 4).
        """
        directions, turn = self.operator.directions, azimuths(self.sizes.direction_azimuth)
        shape = *directions.mu.shape, turn.size, self.suns.mu_s.size * LANES
        radiance = np.empty(shape, dtype=np.float32)
        first_radiance(
            self.air, self.altitude_m, directions.mu, directions.downward, self.bins,
            transmittance, self.suns.mu_s, np.cos(turn), phase, self._sun_on_ground(transmittance),
            self.suns.constants(), radiance.reshape(*shape[:2], -1),
        )  # fmt: skip
        return radiance

    def first_light(self, transmittance: Lanes, phase: Lanes) -> tuple[Lanes, NodeLight]:
        """`first_radiance`, and the harmonics of all light scattered once."""
        radiance = self.first_radiance(transmittance, phase)
        polarised = None if self.polarised is None else self.polarised.first(transmittance)
        return radiance, NodeLight(self.operator.project(radiance), polarised)

    def next_light(self, light: NodeLight, radiance: Lanes, order: int) -> tuple[Lanes, NodeLight]:
        """The same of an order of three and up, from the light of the order before."""
        source, polarised = self.source(light), light.polarised
        if self.polarised is not None and polarised is not None:
            carried = self.sizes.polarises(order - 1)
            polarised = self.polarised.next(source, light.radiance, polarised) if carried else None
        following = self.next_radiance(source, radiance, order)
        return following, NodeLight(self.operator.project(following), polarised)

    def next_radiance(self, source: "Source", radiance: Lanes, order: int) -> Lanes:
        """Light of an order that arrives at the nodes, of a source function and from the ground.

        `radiance` is that of the order before, which lights the ground.
        """
        directions, turn = self.operator.directions, azimuths(self.sizes.azimuths_of(order))
        shape = *directions.mu.shape, turn.size, radiance.shape[-1]
        following = np.empty(shape, dtype=np.float32)
        next_radiance(
            self.air, self.altitude_m, directions.mu, directions.downward, self.higher_bins, source,
            self.suns.mu_s, np.cos(turn), self._sky_on_ground(radiance),
            following.reshape(*shape[:2], -1),
        )  # fmt: skip
        return following

    def source(self, light: NodeLight) -> "Source":
        """The source function of light."""
        coefficients, molecules, particles = light.radiance, None, None
        rayleigh = np.empty((0, 4, coefficients.shape[-1]), dtype=np.float32)
        shape = 0, self.sizes.source_mu, self.sizes.source_azimuth, coefficients.shape[-1]
        mie = np.empty(shape, dtype=np.float32)
        if self.polarised is not None and light.polarised is not None:
            molecules, particles = self.polarised.fed(light.polarised)
        if self.air.scattering[0].any():
            rayleigh = self.operator.scatter_by_molecules(
                coefficients, self.air.anisotropy, molecules
            )
        if self.air.scattering[1:].any():
            mie = self.operator.scatter(coefficients, self.mie_chi, particles)
        return make_source(rayleigh, mie, self.suns)

    def polarised_source(self, light: NodeLight) -> Lanes:
        """Coefficients of Q and U that particles scatter: see `SourceField.polarised`."""
        if self.polarised is None or light.polarised is None or not self.air.scattering[1:].any():
            harmonics = 0 if self.polarised is None else self.polarised.operator.degree.size
            return np.empty((0, 2, harmonics, light.radiance.shape[-1]), dtype=np.float32)
        return self.polarised.scattered(light.radiance, light.polarised)

    def _sun_on_ground(self, transmittance: Lanes) -> Lanes:
        """Irradiance (n, 4) of the level ground by the sun, on a finer axis of suns."""
        suns = self.suns.mu_s_at(np.linspace(0.0, 1.0, 4 * self.suns.mu_s.size))
        radius, top = self.air.ground_radius_m, self.air.top_altitude_m
        squared = top * (2.0 * radius + top)
        along = radius * np.maximum(suns, 0.0)
        distance = squared / (np.sqrt(along * along + squared) + along)
        ground = transmittance[0].reshape(-1, LANES)
        nodes = np.linspace(top, np.sqrt(squared), len(ground))
        passed = np.stack([np.interp(distance, nodes, lane) for lane in ground.T], axis=-1)
        light = passed * np.maximum(suns, 0.0)[:, None] * self.air.solar_irradiance
        return np.asarray(light, dtype=np.float32)

    def _sky_on_ground(self, radiance: Lanes) -> Lanes:
        """Irradiance (suns, 4) of the level ground by the sky."""
        directions = self.operator.directions
        up = ~directions.downward
        weight = (directions.weight[0] * directions.mu[0])[up] * 2.0 * np.pi / radiance.shape[2]
        light = np.tensordot(weight, radiance[0, up].sum(axis=1), axes=1)
        return np.asarray(light.reshape(-1, LANES), dtype=np.float32)


def make_nodes(
    atmosphere: Atmosphere, air: WavelengthGroup, sizes: SolverSizes, group: int = 0
) -> Nodes:
    """The nodes of an atmosphere for a group of its wavelengths, whose air is `air`."""
    altitude = altitude_nodes(atmosphere, sizes.altitude)
    if air.layer_share > 0.0:
        altitude = layer_nodes(air, nodes_of_axis(sizes.altitude, air.layer_share))
    operator = scattering_operator(atmosphere.ground_radius_m, tuple(altitude), sizes)
    mu, downward = operator.directions.mu, operator.directions.downward
    bins, later = (Bins.empty(mu.shape, count) for count in (sizes.node_bins, sizes.bins_of(LATER)))
    left_out = bin_nodes(air, altitude, mu, downward, sizes.steps, bins, later)
    chi = in_lanes(mixed_coefficients(atmosphere, sizes.degree, altitude))[group]
    suns, polarised = SunGrid(atmosphere, sizes.mu_s), None
    if sizes.polarises(1):
        polarised = make_polarised_nodes(atmosphere, air, sizes, altitude, group)
    return Nodes(
        air, sizes, altitude, suns, operator, bins, later, left_out, chi.astype(np.float32),
        polarised,
    )  # fmt: skip


def make_transmittance(air: WavelengthGroup) -> Lanes:
    """Transmittance (altitudes, columns * 4) of the sun's light, see `fill_transmittance`."""
    rows = nodes_of_axis(_TRANSMITTANCE_ROWS, air.layer_share)
    table = np.empty((rows, _TRANSMITTANCE_COLUMNS, LANES), dtype=np.float32)
    fill_transmittance(air, table)
    return table.reshape(rows, -1)


def shown_phase_tables(atmosphere: Atmosphere, degree: int, altitude_m: FloatArray) -> Lanes:
    """The phase functions (groups, altitudes, n, 5) by which light scattered once is shown.

    Those of molecules and of particles at four wavelengths, uniform in sqrt((1 - nu) / 2), for eyes
    at altitudes. The particles' is per unit of scattering in `delta_m.thinned` air.
    """
    nu, shares = phase_cosines(), shares_above(atmosphere, degree, altitude_m)
    return _phase_tables([shown_phase(atmosphere, degree, nu, share) for share in shares])


def fed_phase_tables(atmosphere: Atmosphere, degree: int, altitude_m: FloatArray) -> Lanes:
    """The same (groups, altitudes or 1, n, 5), as light scattered once feeds the orders beyond: at
    altitudes, and without the peak of a table."""
    if atmosphere.mie_table is None:
        shares = shares_at(atmosphere, degree, altitude_m if atmosphere.mixed else [0.0])
        nu = phase_cosines()
        return _phase_tables([shown_phase(atmosphere, degree, nu, share) for share in shares])
    legendre = np.polynomial.legendre.legvander(phase_cosines(), degree)
    legendre *= (2.0 * np.arange(degree + 1) + 1.0) / (4.0 * np.pi)
    return _phase_tables(list(legendre @ mixed_coefficients(atmosphere, degree, altitude_m)))


def _phase_tables(particles: list[FloatArray]) -> Lanes:
    return phase_tables(rayleigh_phase(phase_cosines()), particles)
