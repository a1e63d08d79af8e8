"""Algorithm 3: what the sun's disc sheds on a level surface."""

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.pipeline.setting import Setting
from bruneton_sky.tables.look_ups import transmittance_to_top
from bruneton_sky.tables.parametrisations import irradiance_state, node_coordinates
from vrut_lite.numeric_types import FloatArray


def direct_irradiance(setting: Setting, transmittance: FloatArray) -> FloatArray:
    """The table (altitude, mu_s, C), W m^-2 nm^-1."""
    air = setting.atmosphere
    h, mu_s = irradiance_nodes(setting)
    clear = transmittance_to_top(air, transmittance, h, mu_s)
    return np.asarray(air.solar_irradiance) * clear * disc_cosine(air, mu_s)[..., None]


def disc_cosine(air: Atmosphere, mu_s: FloatArray) -> FloatArray:
    """Mean cosine (...,) over a disc of which a level surface cuts a part, nearly.

    mu_s itself where the whole disc shows, 0 where none does, a parabola between them.
    """
    a = air.sun_angular_radius_rad
    rising = (mu_s + a) ** 2 / (4.0 * a)
    return np.where(mu_s < -a, 0.0, np.where(mu_s > a, mu_s, rising))


def irradiance_nodes(setting: Setting) -> tuple[FloatArray, FloatArray]:
    """Altitude in m and mu_s at the nodes of an irradiance table; they broadcast."""
    shape = setting.sizes.irradiance_altitude, setting.sizes.irradiance_mu_s
    return irradiance_state(setting.atmosphere, shape, *np.ix_(*map(node_coordinates, shape)))
