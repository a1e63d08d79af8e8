"""The module's air, and walls seen through it: by the reference, and through a volume."""

from functools import lru_cache

import numpy as np
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solver import SourceField
from bruneton_sky.solver_job import solve_air

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.messages.air import AirVolume
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.air_volume import look_up_air
from vrut_lite_lab.air_exact import light_before

WALLS_M = np.array([1e3, 1e4, 1e5])


@lru_cache
def field(turbidity: float = 3.0) -> SourceField:
    """The module's own air, solved as for a picture."""
    air = atmosphere_of(BrunetonSkySettings(turbidity=turbidity, aerosol="one-lobe"))
    return solve_air(air)


def towards(elevation_deg: float, azimuth_deg: float = 0.0) -> FloatArray:
    """The unit vector, world axes; azimuth from north."""
    e, a = np.radians(elevation_deg), np.radians(azimuth_deg)
    return np.array([np.sin(a) * np.cos(e), np.sin(e), -np.cos(a) * np.cos(e)])


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


def found(volume: AirVolume, view: FloatArray, metres: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The same of a volume."""
    light = look_up_air(volume, np.broadcast_to(view, (metres.size, 3)), metres)
    return light.shaded + light.sunlit, light.transmittance


def white_wall(solved: SourceField, sun: FloatArray) -> FloatArray:
    """Radiance (3,) of a white thing in full sunlight outside the air."""
    air = solved.atmosphere
    return rgb_from_spectrum(air.solar_irradiance, air.wavelength_nm) / np.pi * sun[1]
