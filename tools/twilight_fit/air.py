"""The air that twilight is computed in: nine wavelengths, ozone, haze of a given turbidity."""

from dataclasses import replace

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.aerosol import ANGSTROM_EXPONENT, optical_depth_of_turbidity
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
WAVELENGTH_NM = np.arange(380.0, 701.0, 40.0)
# Ozone's absorption cross section at these wavelengths, m^2, of the University of Bremen
# (Serdyuchenko et al. 2014, at 223 K; 10 nm means).
OZONE_CROSS_SECTION_M2 = np.array(
    [2.818e-28, 5.520e-27, 3.669e-26, 1.480e-25, 3.091e-25, 4.398e-25, 3.740e-25, 1.852e-25,
     7.455e-26]
)  # fmt: skip
# 300 Dobson units in a tent from 10 to 40 km with its top at 25 km, as in Bruneton 2017.
DOBSON_UNIT_PER_M2 = 2.687e20
OZONE_DU = 300.0
TENT_M = (10_000.0, 25_000.0, 40_000.0)
TOP_M = 120_000.0
# Rayleigh's coefficient at 1 micrometre and its exponent (Bruneton 2017), 1/m.
RAYLEIGH_PER_M, RAYLEIGH_EXPONENT = 1.24062e-6, 4.0
AEROSOL_ALBEDO, AEROSOL_G = 0.9, 0.75
GROUND_ALBEDO = 0.2


def air(turbidity: float, wavelength_nm: FloatArray | None = None) -> Atmosphere:
    """Clear air with ozone up to 120 km, and Preetham's aerosol of that turbidity below 10 km.

    Per unit of solar irradiance. The ground's albedo is 0.2, a mean of land without snow.
    """
    wavelength = WAVELENGTH_NM if wavelength_nm is None else wavelength_nm
    # Between the nodes the cross section is log-linear: only the check of the sampling asks.
    section = np.exp(np.interp(wavelength, WAVELENGTH_NM, np.log(OZONE_CROSS_SECTION_M2)))
    none = (0.0,) * wavelength.size
    densest = OZONE_DU * DOBSON_UNIT_PER_M2 / (0.5 * (TENT_M[2] - TENT_M[0]))
    clear = replace(
        Atmosphere.earth(),
        wavelength_nm=tuple(wavelength),
        solar_irradiance=(1.0,) * wavelength.size,
        top_altitude_m=TOP_M,
        rayleigh_scattering=tuple(RAYLEIGH_PER_M * (wavelength / 1000.0) ** -RAYLEIGH_EXPONENT),
        mie_scattering=none,
        mie_extinction=none,
        absorption_extinction=tuple(section * densest),
        absorber_altitude_m=TENT_M,
        absorber_density=(0.0, 1.0, 0.0),
        ground_albedo=(GROUND_ALBEDO,) * wavelength.size,
    )
    depth = float(optical_depth_of_turbidity(turbidity))
    return clear.with_aerosol(depth, ANGSTROM_EXPONENT, AEROSOL_G)
