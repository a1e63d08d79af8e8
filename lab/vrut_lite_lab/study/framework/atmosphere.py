"""The atmosphere of all physical models in the comparison: Bruneton 2016, section 4.

Exponential molecules and aerosol under one sun over grass; no ozone.
"""

from dataclasses import dataclass
from functools import cached_property
from math import cos, radians
from typing import Self

from bruneton_sky.atmosphere import Atmosphere

from vrut_lite.atmosphere.aerosol import turbidity_of_optical_depth
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.day import KIDER, MeasuredDay
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM
from vrut_lite_lab.study.framework.tables import table_spectra

# Penndorf's table holds at 0 deg C; molecules thin out as the air warms to 15 deg C (his eq. 12).
_PENNDORF_TO_15_C = 273.16 / 288.16
_MIE_ALBEDO = 0.8
_MIE_SCALE_HEIGHT_M = 1200.0


@dataclass(frozen=True, eq=False, kw_only=True)
class StudyAtmosphere:
    """Spectra (40,) at `WAVELENGTHS_NM` and lengths of one atmosphere.

    Attributes:
        solar_irradiance: above the atmosphere, W m^-2 nm^-1.
        rayleigh_scattering, mie_scattering, mie_extinction: at sea level, 1/m.
        ground_albedo: of a diffuse ground.
        mie_g: of Cornette and Shanks' phase function.
        turbidity: what stands for this aerosol in models that know no other.
    """

    solar_irradiance: FloatArray
    rayleigh_scattering: FloatArray
    mie_extinction: FloatArray
    mie_scattering: FloatArray
    ground_albedo: FloatArray
    ground_radius_m: float = 6_360_000.0
    top_radius_m: float = 6_420_000.0
    rayleigh_scale_height_m: float = 8000.0
    mie_scale_height_m: float = _MIE_SCALE_HEIGHT_M
    mie_g: float = 0.7
    turbidity: float = 2.53

    @classmethod
    def published(cls) -> Self:
        """The atmosphere of Bruneton's evaluation."""
        return cls.of_day(KIDER)

    @classmethod
    def of_day(cls, day: MeasuredDay) -> Self:
        """The same with a day's aerosol, Angstrom's, of which 0.8 is scattering.

        The sun is at 1 au and there is no ozone, as published.
        """
        (solar,), (molecules,) = (
            table_spectra("solar_astm_g173"),
            table_spectra("rayleigh_penndorf"),
        )
        depth = day.optical_depth_550 * (WAVELENGTHS_NM / 550.0) ** -day.angstrom_exponent
        turbidity = cls.turbidity
        if day != KIDER:
            turbidity = turbidity_of_optical_depth(day.optical_depth_550)
        extinction = depth / _MIE_SCALE_HEIGHT_M
        return cls(
            solar_irradiance=solar,
            rayleigh_scattering=molecules * 1e-6 * _PENNDORF_TO_15_C,
            mie_extinction=extinction,
            mie_scattering=_MIE_ALBEDO * extinction,
            ground_albedo=table_spectra("albedo_grass")[0],
            turbidity=turbidity,
        )

    @property
    def top_altitude_m(self) -> float:
        """Thickness of the atmosphere."""
        return self.top_radius_m - self.ground_radius_m

    def bruneton_atmosphere(self) -> Atmosphere:
        """The same air for `bruneton_sky`, at the 40 wavelengths."""
        return self._bruneton

    @cached_property
    def _bruneton(self) -> Atmosphere:
        return Atmosphere(
            wavelength_nm=tuple(WAVELENGTHS_NM),
            solar_irradiance=tuple(self.solar_irradiance),
            ground_radius_m=self.ground_radius_m,
            top_altitude_m=self.top_altitude_m,
            rayleigh_scattering=tuple(self.rayleigh_scattering),
            rayleigh_scale_height_m=self.rayleigh_scale_height_m,
            mie_scattering=tuple(self.mie_scattering),
            mie_extinction=tuple(self.mie_extinction),
            mie_scale_height_m=self.mie_scale_height_m,
            mie_g=self.mie_g,
            absorption_extinction=(0.0,) * WAVELENGTHS_NM.size,
            absorber_altitude_m=(0.0, 1.0),
            absorber_density=(0.0, 0.0),
            ground_albedo=tuple(self.ground_albedo),
            sun_angular_radius_rad=radians(0.5357 / 2),
            mu_s_min=cos(radians(102.0)),
        )


STUDY = StudyAtmosphere.published()
