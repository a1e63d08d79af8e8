"""Common parts of the pipeline's algorithms: sample counts, look-ups, light of one order."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.tables.interpolate import interpolate
from bruneton_sky.tables.parametrisations import (
    Coordinates,
    State,
    Year,
    node_states,
    parametrisation_of,
)
from bruneton_sky.tables.sizes import TableSizes
from vrut_lite.numeric_types import FloatArray

Phase = Callable[[ArrayLike], FloatArray]
# Intervals of the trapezoid rule to the top of the atmosphere, and along every other ray.
TRANSMITTANCE_INTERVALS = 500
RAY_INTERVALS = 50
# Midpoints over the zenith angles of the whole sphere; twice as many over the azimuths.
DENSITY_ZENITH_ANGLES = 16
IRRADIANCE_ZENITH_ANGLES = 32


class Setting(NamedTuple):
    """The atmosphere and the shape of its tables."""

    atmosphere: Atmosphere
    sizes: TableSizes
    parametrisation: Year

    def nodes(self) -> State:
        """The states at the nodes of a scattering table."""
        return node_states(self.atmosphere, self.sizes, self.parametrisation)

    def coordinates(self, state: State) -> Coordinates:
        """Table coordinates of states in a scattering table."""
        mapping = parametrisation_of(self.parametrisation)
        return mapping.to_coordinates(self.atmosphere, self.sizes, state)

    def look_up(self, table: FloatArray, state: State) -> FloatArray:
        """Values (..., C) of a scattering table at states."""
        return interpolate(table, self.coordinates(state))


def densities(air: Atmosphere, altitude_m: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Relative densities (...,) of molecules and of aerosol."""
    h = np.asarray(altitude_m, dtype=float)
    return np.exp(-h / air.rayleigh_scale_height_m), np.exp(-h / air.mie_scale_height_m)


def scattering_coefficients(air: Atmosphere) -> tuple[FloatArray, FloatArray]:
    """Those of molecules and of aerosol (C,) at relative density 1, in 1/m."""
    return np.asarray(air.rayleigh_scattering), np.asarray(air.mie_scattering)


def trapezoid(length_m: FloatArray, intervals: int) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Distance and weight, both in m, of each node of the trapezoid rule over a length."""
    step = length_m / intervals
    for i in range(intervals + 1):
        yield i * step, 0.5 * step if i in (0, intervals) else step


class Part(NamedTuple):
    """A table (altitude, mu, nu, mu_s, C) of radiance over a phase function."""

    table: FloatArray
    phase: Phase


def light_scattered_once(
    air: Atmosphere, rayleigh: FloatArray, mie: FloatArray
) -> tuple[Part, ...]:
    """Two tables, each divided by another phase function."""
    return Part(rayleigh, rayleigh_phase), Part(mie, lambda nu: mie_phase(air, nu))


def light_scattered_often(radiance: FloatArray) -> tuple[Part, ...]:
    """One table of radiance."""
    return (Part(radiance, np.ones_like),)


def radiance(setting: Setting, light: tuple[Part, ...], state: State) -> FloatArray:
    """Radiance (..., C) of light at states."""
    parts = (setting.look_up(part.table, state) * part.phase(state.nu)[..., None] for part in light)
    return sum(parts, start=np.zeros(1))
