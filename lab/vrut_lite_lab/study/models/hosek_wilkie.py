"""Hosek and Wilkie 2012, 2013, by `dynamic_skylight`, under the study's sun and over its grass.

The authors' spectral fit has one albedo for all wavelengths: each wavelength here gets a sky of
its own, over the grass as that wavelength sees it (Bruneton 2016). The sun that the fit was made
with is exchanged for the study's, from 320 to 720 nm; beyond 720 nm the model fades out.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from dynamic_skylight import HosekWilkieSky

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY, StudyAtmosphere
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.models.model import cosines

# Radiance of the authors' sun, W m^-2 sr^-1 nm^-1, each 40 nm from 320 nm, and its solid angle.
_BANDS_NM = np.arange(320.0, 721.0, 40.0)
_AUTHORS_SUN = np.array(
    [
        7500.0,
        12500.0,
        21127.5,
        26760.5,
        30663.7,
        27825.0,
        25503.8,
        25134.2,
        23212.1,
        21526.7,
        19870.8,
    ]
)
_SUN_SR = 6.87e-5
# Where the model's sky ends.
_LAST_NM = 760.0
_HAS_SUN = np.less_equal(WAVELENGTHS_NM, _BANDS_NM[-1])


@dataclass(frozen=True)
class HosekWilkie:
    """The sky of one turbidity."""

    air: StudyAtmosphere = STUDY
    turbidity: float = STUDY.turbidity
    name: str = "hosek-wilkie"
    title: str = "Hosek-Wilkie 2012"

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40), 0 above 760 nm."""
        gamma = np.arccos(cosines(sun_zenith_rad, view_zenith_rad, relative_azimuth_rad).nu)
        skies = self._skies(sun_zenith_rad)
        radiance = np.zeros((*gamma.shape, WAVELENGTHS_NM.size))
        for i in np.flatnonzero(WAVELENGTHS_NM <= _LAST_NM):
            radiance[..., i] = skies[i].spectral_radiance(view_zenith_rad, gamma, WAVELENGTHS_NM[i])
        return radiance * self._exchange_of_suns()

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,), 0 above 720 nm: radiance of the disc's centre times its solid angle.

        As published. The fit's radiance behind clear air is its sun's irradiance over that
        solid angle, so this keeps the energy; its darkening from there to the limb loses 25 %.
        """
        sky, irradiance = self._skies(sun_zenith_rad)[0], np.zeros(WAVELENGTHS_NM.size)
        centre = sky.solar_radiance(sun_zenith_rad, 0.0, WAVELENGTHS_NM[_HAS_SUN])
        irradiance[_HAS_SUN] = centre * _SUN_SR
        return irradiance * self._exchange_of_suns()

    def _skies(self, sun_zenith_rad: float) -> tuple[HosekWilkieSky, ...]:
        return _skies(self.turbidity, tuple(self.air.ground_albedo), float(sun_zenith_rad))

    def _exchange_of_suns(self) -> FloatArray:
        authors = np.interp(WAVELENGTHS_NM, _BANDS_NM, _AUTHORS_SUN) * _SUN_SR
        return np.where(_HAS_SUN, self.air.solar_irradiance / authors, 1.0)


@lru_cache(maxsize=4)
def _skies(
    turbidity: float, albedo: tuple[float, ...], sun_zenith_rad: float
) -> tuple[HosekWilkieSky, ...]:
    elevation = np.pi / 2 - sun_zenith_rad
    return tuple(HosekWilkieSky(turbidity, each, elevation) for each in albedo)
