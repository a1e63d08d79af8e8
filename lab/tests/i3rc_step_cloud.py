"""The step cloud of I3RC, phase I, case 1, and its consensus of several Monte Carlo codes.

A cloud 250 m thick and without end along z repeats each 500 m along x: half of it has an optical
depth of 2, half one of 18. It scatters by Henyey and Greenstein's function, g = 0.85, without loss
(Cahalan et al. 2005, "The I3RC: bringing together the most advanced radiative transfer tools for
cloudy atmospheres"; results of the project's archive, experiment 2: the sun at 30 degrees).
"""

from typing import NamedTuple

import numpy as np
from clouds.model.cloud_density_kernels import compiled

from vrut_lite.atmosphere.aerosols.phase_table import node_cosines

PIXELS, PERIOD_M, MU_0 = 32, 500.0, 0.5
# Light goes along +x.
SUN = np.array([-np.sqrt(0.75), 0.5, 0.0])
# pi times radiance over the sun's irradiance of the level, pixel by pixel: from straight above ...
ABOVE = np.array([
    0.14987, 0.11545, 0.10332, 0.097624, 0.096786, 0.095556, 0.095591, 0.10003,
    0.10399, 0.10706, 0.11233, 0.12041, 0.13092, 0.14673, 0.16866, 0.22576,
    0.60461, 0.74376, 0.79503, 0.80999, 0.81065, 0.79537, 0.77224, 0.74995,
    0.72608, 0.70011, 0.67134, 0.64915, 0.61716, 0.58332, 0.53990, 0.45550,
])  # fmt: skip
# ... and from straight below.
BELOW = np.array([
    0.24300, 0.21834, 0.20483, 0.19537, 0.19607, 0.19961, 0.20401, 0.21397,
    0.22384, 0.23878, 0.25504, 0.27174, 0.29865, 0.33343, 0.38167, 0.46622,
    0.60339, 0.66842, 0.68124, 0.68147, 0.65695, 0.62724, 0.59141, 0.56128,
    0.52572, 0.49351, 0.46334, 0.43445, 0.41075, 0.38199, 0.34891, 0.30246,
])  # fmt: skip


class StepCloud(NamedTuple):
    """What the Monte Carlo needs of a field: extinction where density is 1."""

    extinction_per_m: float = 18.0 / 250.0
    thickness_m: float = 250.0


@compiled
def density(field, x, z, height, width):  # type: ignore[no-untyped-def]
    """Density of the step cloud: the thin half first."""
    return 2.0 / 18.0 if x % 500.0 < 250.0 else 1.0


def phase_function(g=0.85):
    """Henyey and Greenstein's (nodes,), sr^-1."""
    squares = 1.0 + g * g - 2.0 * g * node_cosines()
    return (1.0 - g * g) / (4.0 * np.pi * squares**1.5)
