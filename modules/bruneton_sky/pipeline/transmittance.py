"""Algorithm 2: the transmittance to the top of the atmosphere."""

import numpy as np

from bruneton_sky.geometry import altitude_along, distance_to_top
from bruneton_sky.pipeline.setting import TRANSMITTANCE_INTERVALS, Setting, densities
from bruneton_sky.pipeline.trapezoid import trapezoid
from bruneton_sky.tables.parametrisations import node_coordinates, transmittance_state
from vrut_lite.numeric_types import FloatArray


def transmittance(setting: Setting) -> FloatArray:
    """The table (altitude, mu, C).

    Bruneton's densities stop at 1, the ground's; a ray along the ground may dip below it by a
    rounding error, which the trapezoid rule does not notice.
    """
    air, sizes = setting.atmosphere, setting.sizes
    shape = sizes.transmittance_altitude, sizes.transmittance_mu
    h, mu = transmittance_state(air, shape, *np.ix_(*map(node_coordinates, shape)))
    length = distance_to_top(air.ground_radius_m, air.top_altitude_m, h, mu)
    paths = np.zeros((3, *shape))
    for distance, metres in trapezoid(length, TRANSMITTANCE_INTERVALS):
        altitude = altitude_along(air.ground_radius_m, h, mu, distance)
        paths += metres * np.stack([*densities(air, altitude), air.absorber(altitude)])
    extinction = air.rayleigh_scattering, air.mie_extinction, air.absorption_extinction
    return np.exp(-np.tensordot(paths, np.asarray(extinction), axes=(0, 0)))
