"""The converged sky of all orders of scattering, computed without tables.

Light scattered once comes from an exact rule, all later orders from `bruneton_sky.solver`. The
reference of the study's comparisons with truth; a Monte Carlo path tracer, which shares
nothing with it but the atmosphere, says how far it can be trusted.
"""

from dataclasses import dataclass, field
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
from bruneton_sky import Atmosphere, single_scattering
from bruneton_sky.optical_path import optical_depth_to_top
from bruneton_sky.solver import SolverSizes, SourceField, multiple_scattering, solve

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.monte_carlo import monte_carlo_stokes
from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.models.in_parts import in_parts
from vrut_lite_lab.study.models.model import cosines

# At 16 nodes light scattered once errs by 1e-9 by day and 1e-7 in twilight.
_NODES = 16
# In the study's air and directions, of all light, against SolverSizes.converged() at four
# wavelengths: 4e-4 rms with the sun above 45 degrees, 5e-4 at 15, 1.3e-3 at 1 degree; at most
# 4e-3. Ten times as fast, and a 40th of the memory at 40 wavelengths.
_SIZES = SolverSizes(
    altitude=32,
    mu_s=64,
    source_mu=48,
    source_azimuth=16,
    steps=96,
    node_bins=24,
    multiple_bins=32,
)
_ORDERS, _TOLERANCE = 10, 1e-3


@dataclass(frozen=True, eq=False)
class Converged:
    """The sky of an atmosphere over its ground."""

    air: Atmosphere = field(default_factory=STUDY.bruneton_atmosphere)
    name: str = "converged"
    title: str = "All orders, converged"

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, C)."""
        mu, mu_s, nu = cosines(sun_zenith_rad, view_zenith_rad, relative_azimuth_rad)
        return in_parts(partial(self._seen, mu_s), mu, nu)

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (C,); none from a sun below the horizon."""
        if sun_zenith_rad > np.pi / 2:
            return np.zeros(len(self.air.wavelength_nm))
        depth = optical_depth_to_top(self.air, 0.0, float(np.cos(sun_zenith_rad)))
        return np.asarray(self.air.solar_irradiance) * np.exp(-depth)

    def _seen(self, mu_s: float, mu: FloatArray, nu: FloatArray) -> FloatArray:
        once = single_scattering(self.air, 0.0, mu, mu_s, nu, samples=_NODES)
        return once + multiple_scattering(_field(self.air), 0.0, mu, mu_s, nu)


@lru_cache(maxsize=2)
def _field(air: Atmosphere) -> SourceField:
    return solve(air, _ORDERS, _SIZES, all_orders=True, tolerance=_TOLERANCE)


class MonteCarloSky(NamedTuple):
    """Radiance (n, C) in W m^-2 sr^-1 nm^-1, and its standard error."""

    radiance: FloatArray
    standard_error: FloatArray


def monte_carlo_sky(
    air: Atmosphere,
    sun_zenith_rad: float,
    view_zenith_rad: FloatArray,
    relative_azimuth_rad: FloatArray,
    paths: int = 4096,
) -> MonteCarloSky:
    """The same sky by paths of light, a number of them for each direction (n,).

    Seconds for a few directions: for checks, not for pictures.
    """
    seen = cosines(sun_zenith_rad, view_zenith_rad, relative_azimuth_rad)
    # Light scattered once needs no chance.
    once = single_scattering(air, 0.0, *seen, samples=_NODES)
    light, _, _ = monte_carlo_stokes(air, 0.0, *seen, paths=paths)
    return MonteCarloSky(once + light.total(2), light.total_error(2))
