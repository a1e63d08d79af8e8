"""Algorithm 7: the light that points scatter into a view, gathered along the view."""

import numpy as np

from bruneton_sky.pipeline.setting import RAY_INTERVALS, Setting
from bruneton_sky.pipeline.trapezoid import trapezoid
from bruneton_sky.tables.look_ups import transmittance_between
from bruneton_sky.tables.rays import moved, to_edge
from vrut_lite.numeric_types import FloatArray


def multiple_scattering(
    setting: Setting, transmittance: FloatArray, density: FloatArray
) -> FloatArray:
    """Radiance (altitude, mu, nu, mu_s, C), W m^-2 sr^-1 nm^-1, of a scattering density."""
    air, nodes = setting.atmosphere, setting.nodes()
    gathered = np.zeros_like(density)
    ray = (air, transmittance, nodes.altitude_m, nodes.mu)
    for distance, metres in trapezoid(to_edge(air, nodes), RAY_INTERVALS):
        clear = transmittance_between(*ray, distance, nodes.hits_ground) * metres[..., None]
        gathered += clear * setting.look_up(density, moved(air, nodes, distance))
    return gathered
