"""Equations 4 and 5 of Galaj and Wojciechowski 2019: coefficients from the refractive index."""

from collections.abc import Iterator

import numpy as np

from vrut_lite.atmosphere.gases import rayleigh_scattering
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY
from vrut_lite_lab.study.framework.spectra import WAVELENGTHS_NM

# At 15 deg C and 1013.25 hPa.
MOLECULES_PER_M3 = 2.547e25
# What renderers take for all wavelengths.
CONSTANT_INDEX = 1.0003
PENNDORF_DEPOLARISATION = 0.035


def edlen_index(wavelength_nm: FloatArray) -> FloatArray:
    """Refractive index (n,) of dry air at 15 deg C and 1013.25 hPa: Edlen 1953."""
    wavenumber_squared = (1000.0 / wavelength_nm) ** 2
    return np.asarray(
        1.0
        + 1e-8
        * (
            6432.8
            + 2_949_810.0 / (146.0 - wavenumber_squared)
            + 25_540.0 / (41.0 - wavenumber_squared)
        )
    )


def rayleigh_ratio(index: FloatArray | float, depolarisation: float = 0.0) -> FloatArray:
    """Equation 4 over the tabulated coefficient (40,) of the study's air."""
    spectrum = np.broadcast_to(index, WAVELENGTHS_NM.shape)
    by_equation = rayleigh_scattering(WAVELENGTHS_NM, spectrum, MOLECULES_PER_M3, depolarisation)
    return np.asarray(by_equation / STUDY.rayleigh_scattering)


def mie_by_equation() -> float:
    """Equation 5: 8 pi^3 (n^2 - 1)^2 / (3 N), in m^3 and not in 1/m."""
    contrast = (CONSTANT_INDEX - 1.0) * (CONSTANT_INDEX + 1.0)
    return float(8.0 * np.pi**3 * contrast**2 / (3.0 * MOLECULES_PER_M3))


def report() -> Iterator[str]:
    """Lines of text."""
    measured = edlen_index(WAVELENGTHS_NM)
    for what, ratio in {
        f"index {CONSTANT_INDEX}": rayleigh_ratio(CONSTANT_INDEX),
        "Edlen's index": rayleigh_ratio(measured),
        "Edlen's index, King's factor": rayleigh_ratio(measured, PENNDORF_DEPOLARISATION),
    }.items():
        at = ", ".join(f"{np.interp(nm, WAVELENGTHS_NM, ratio):.4f}" for nm in (360, 440, 550, 680))
        yield f"eq. 4, {what}: {at} of the tabulated at 360, 440, 550, 680 nm"
    mie = STUDY.mie_scattering
    yield (
        f"eq. 5: {mie_by_equation():.2e} m^3; tabulated {mie[0]:.2e} to {mie[-1]:.2e} 1/m, "
        f"{mie[0] / mie[-1]:.2f} times as much at 360 as at 818 nm"
    )
