"""Algorithm 6: what the sky sheds on a level surface."""

import numpy as np

from bruneton_sky.pipeline.direct_irradiance import irradiance_nodes
from bruneton_sky.pipeline.incident import Part, radiance
from bruneton_sky.pipeline.setting import IRRADIANCE_ZENITH_ANGLES, Setting
from bruneton_sky.tables.parametrisations import State
from vrut_lite.numeric_types import FloatArray


def indirect_irradiance(setting: Setting, light: tuple[Part, ...]) -> FloatArray:
    """The table (altitude, mu_s, C) of light of one order, W m^-2 nm^-1.

    Midpoints of even steps over the upper half of the sphere; azimuth 0 is the sun's.
    """
    altitude, mu_s = (axis[..., None] for axis in irradiance_nodes(setting))
    sun_x = np.sqrt((1.0 - mu_s) * (1.0 + mu_s))
    step = np.pi / IRRADIANCE_ZENITH_ANGLES
    azimuths = (np.arange(2 * IRRADIANCE_ZENITH_ANGLES) + 0.5) * step
    irradiance = 0.0
    for theta in (np.arange(IRRADIANCE_ZENITH_ANGLES // 2) + 0.5) * step:
        mu, sine = np.cos(theta), np.sin(theta)
        nu = sine * np.cos(azimuths) * sun_x + mu * mu_s
        arriving = radiance(setting, light, State(altitude, mu, mu_s, nu, np.asarray(False)))
        irradiance = irradiance + arriving.sum(axis=-2) * (mu * sine * step * step)
    return np.asarray(irradiance)
