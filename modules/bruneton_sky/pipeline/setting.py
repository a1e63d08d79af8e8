"""What every algorithm of the pipeline needs to know, and the sample counts of all."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.atmosphere import Atmosphere
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
        """Where states lie in a scattering table."""
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
