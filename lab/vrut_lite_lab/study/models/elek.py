"""Elek and Kmoch 2010: tables like Bruneton's at 15 wavelengths, spectra drawn through them.

"Real-time spectral scattering in large-scale natural participating media". The 15 are spread
evenly over the study's 40; between them the light per unit of sunlight is taken as linear.
Bruneton 2016 gives this model the tables of 40 wavelengths, and takes the colour alone from 15.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.atmosphere_numbers import SPECTRAL_FIELDS

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY, StudyAtmosphere
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM, at_wavelength, linear
from vrut_lite_lab.study.models.bruneton import Bruneton

_WAVELENGTHS = 15


@dataclass(frozen=True, eq=False)
class Elek:
    """The sky of an atmosphere."""

    air: StudyAtmosphere = STUDY
    name: str = "elek"
    title: str = "Elek 2010"

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40)."""
        seen = self._tables.sky_radiance(sun_zenith_rad, view_zenith_rad, relative_azimuth_rad)
        return self._at_all_wavelengths(seen)

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,)."""
        return self._at_all_wavelengths(self._tables.sun_irradiance(sun_zenith_rad))

    @cached_property
    def _tables(self) -> Bruneton:
        return Bruneton(at_wavelengths(self.air.bruneton_atmosphere(), _few_wavelengths_nm()))

    def _at_all_wavelengths(self, few: FloatArray) -> FloatArray:
        """Spectra (..., 40) of spectra (..., 15)."""
        share = few / np.asarray(self._tables.air.solar_irradiance)
        return linear(share, _few_wavelengths_nm(), WAVELENGTHS_NM) * self.air.solar_irradiance


def at_wavelengths(air: Atmosphere, wavelength_nm: FloatArray) -> Atmosphere:
    """An atmosphere of 40 wavelengths at others (n,), linear between."""
    spectra: dict[str, Any] = {
        name: tuple(at_wavelength(getattr(air, name), wavelength_nm)) for name in SPECTRAL_FIELDS
    }
    return replace(air, wavelength_nm=tuple(wavelength_nm), **spectra)


def _few_wavelengths_nm() -> FloatArray:
    return np.linspace(WAVELENGTHS_NM[0], WAVELENGTHS_NM[-1], _WAVELENGTHS)
