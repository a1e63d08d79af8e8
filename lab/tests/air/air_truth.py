"""Light before walls in the module's air by the float64 reference."""

import numpy as np
from bruneton_sky.solver import SourceField

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.air_exact import light_before

WALLS_M = np.array([1e3, 1e4, 1e5])


def exactly(
    solved: SourceField, altitude_m: float, view: FloatArray, sun: FloatArray, metres: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Light added (n, 3) and transmittance (n, 3) of the twin, linear sRGB."""
    air, nu = solved.atmosphere, float(np.clip(view @ sun, -1.0, 1.0))
    light = light_before(solved, altitude_m, view[1], sun[1], nu, metres)
    total = light.once + light.more
    white = np.asarray(air.solar_irradiance)
    through = rgb_from_spectrum(white * light.transmittance, air.wavelength_nm)
    return (
        rgb_from_spectrum(total, air.wavelength_nm),
        through / rgb_from_spectrum(white, air.wavelength_nm),
    )


def white_wall(solved: SourceField, sun: FloatArray) -> FloatArray:
    """Radiance (3,) of a white thing in full sunlight outside the air."""
    air = solved.atmosphere
    return rgb_from_spectrum(air.solar_irradiance, air.wavelength_nm) / np.pi * sun[1]
