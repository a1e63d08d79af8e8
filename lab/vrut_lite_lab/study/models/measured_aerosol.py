"""The solver's sky under aerosol as measured: OPAC's continental average, nothing fitted.

Of the day of the measurements it has what is published of it: the aerosol's optical depth, the
sun's distance, a mean column of ozone. What the aerosol does to light comes from tables of 1998.
"""

from dataclasses import dataclass, field, replace
from functools import lru_cache, partial

import numpy as np
from bruneton_sky import Atmosphere, SolvedSky, solve
from bruneton_sky.presets import earth_standard

from vrut_lite.atmosphere.aerosols import type_optics
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.day import KIDER, MeasuredDay
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.models.changes import with_ozone, with_sun_of_the_day
from vrut_lite_lab.study.models.in_parts import in_parts
from vrut_lite_lab.study.models.model import cosines

_TYPE = "continental-average"


def measured_air(humidity_percent: float = 80.0, day: MeasuredDay = KIDER) -> Atmosphere:
    """The shipped air over the study's ground, with OPAC's aerosol at the day's depth at 550 nm."""
    air = replace(
        earth_standard(WAVELENGTHS_NM),
        solar_irradiance=tuple(STUDY.solar_irradiance),
        ground_albedo=tuple(STUDY.ground_albedo),
    )
    air = air.with_optics(type_optics(_TYPE, humidity_percent), day.optical_depth_550)
    return with_sun_of_the_day(with_ozone(air, day), day)


@dataclass(frozen=True, eq=False)
class MeasuredAerosol:
    """All orders of scattering at the 40 wavelengths."""

    air: Atmosphere = field(default_factory=measured_air)
    name: str = "measured-aerosol"
    title: str = "All orders, OPAC's continental aerosol"

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40)."""
        mu, mu_s, nu = cosines(sun_zenith_rad, view_zenith_rad, relative_azimuth_rad)
        return in_parts(partial(self._seen, mu_s), mu, nu)

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,); none from a sun below the horizon."""
        if sun_zenith_rad > np.pi / 2:
            return np.zeros(len(self.air.wavelength_nm))
        return _solved(self.air).irradiance(0.0, float(np.cos(sun_zenith_rad)))[0]

    def _seen(self, mu_s: float, mu: FloatArray, nu: FloatArray) -> FloatArray:
        return _solved(self.air).radiance(0.0, mu, mu_s, nu)


@lru_cache(maxsize=2)
def _solved(air: Atmosphere) -> SolvedSky:
    return solve(air)
