"""The two atmospheres in which the rules are compared, and the rays."""

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from bruneton_sky.atmosphere import Atmosphere

from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.directions import directions
from vrut_lite_lab.study.framework.errors import IN_COMMON
from vrut_lite_lab.study.framework.spectra import COMMON_NM, WAVELENGTHS_NM
from vrut_lite_lab.study.models.model import cosines

# What a renderer computes; here run times are taken.
RGB_NM = (680.0, 550.0, 440.0)
_MIE_SCATTERING, _MIE_ALBEDO = 3.996e-6, 0.9


class SeaLevelRays(NamedTuple):
    """Cosines of rays from sea level: of view and sun with the vertical, of the two."""

    mu: FloatArray
    mu_s: float
    nu: FloatArray


def clear_air(wavelength_nm: FloatArray) -> Atmosphere:
    """Clear air under a grey sun, called A: molecules as nm^-4, a little grey aerosol, no ozone."""
    count = wavelength_nm.size
    return replace(
        Atmosphere.earth(ozone=False),
        wavelength_nm=tuple(wavelength_nm),
        solar_irradiance=(1.0,) * count,
        rayleigh_scattering=tuple(13.558e-6 * (550.0 / wavelength_nm) ** 4),
        mie_scattering=(_MIE_SCATTERING,) * count,
        mie_extinction=(_MIE_SCATTERING / _MIE_ALBEDO,) * count,
        mie_g=0.8,
        absorption_extinction=(0.0,) * count,
        ground_albedo=(0.0,) * count,
    )


@lru_cache(maxsize=1)
def spectral_airs() -> dict[str, Atmosphere]:
    """Both at 40, or 31, wavelengths of 360 to 720 nm."""
    return {
        "A": clear_air(np.linspace(*COMMON_NM, 40)),
        "evaluation": _at(WAVELENGTHS_NM[IN_COMMON]),
    }


@lru_cache(maxsize=1)
def rgb_airs() -> dict[str, Atmosphere]:
    """Both at three wavelengths."""
    return {"A": clear_air(np.array(RGB_NM)), "evaluation": _at(np.array(RGB_NM))}


def rays_to(sun_zenith_deg: float) -> SeaLevelRays:
    """To the 81 directions, the sun in the north."""
    zenith, azimuth = directions()
    return SeaLevelRays(*cosines(float(np.radians(sun_zenith_deg)), zenith, azimuth))


def _at(wavelength_nm: FloatArray) -> Atmosphere:
    """The air of the evaluation at other wavelengths, linear between its own."""
    air, count = STUDY.bruneton_atmosphere(), wavelength_nm.size

    def there(spectrum: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(np.interp(wavelength_nm, WAVELENGTHS_NM, spectrum))

    return replace(
        air,
        wavelength_nm=tuple(wavelength_nm),
        solar_irradiance=there(air.solar_irradiance),
        rayleigh_scattering=there(air.rayleigh_scattering),
        mie_scattering=there(air.mie_scattering),
        mie_extinction=there(air.mie_extinction),
        absorption_extinction=(0.0,) * count,
        ground_albedo=(0.0,) * count,
    )
