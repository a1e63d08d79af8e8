"""Light between two of the solver's suns, whose source functions are interpolated by lines.

Below the horizon light falls by a factor with every degree: lines are too bright between nodes.
"""

import math

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.solver.wavelength_groups import LANES
from vrut_lite.numeric_types import FloatArray

SingleArray = NDArray[np.float32]
# Most negative curvature of light between two suns.
_MOST_BENT = 0.5
_LOW_MU_S = 0.25
# Light that grows by exp(d) from a sun to the next bends more near the darker one: over that of
# lines it is 1 - b k (1 - k) (1 + (1 - 2 k) d / 3) at the place k between them, with b = d^2 / 2
# (Bernoulli's cumulants). So the tilt d / 3 is this times sqrt(b).
SUN_TILT = math.sqrt(2.0) / 3.0


def sun_bend(rayleigh: SingleArray, mie: SingleArray, mu_s: FloatArray) -> SingleArray:
    """How the light bends between a sun and the next: see `Source.bend`; 0 for high suns, whose
    light bends otherwise in each direction."""
    light = rayleigh[:, 0] if rayleigh.size else _mean_of_directions(mie)
    shape = len(light), light.shape[1] // LANES, LANES
    light = np.maximum(light.reshape(shape).sum(axis=2), 0.0)
    second = np.zeros_like(light)
    low = (mu_s < _LOW_MU_S).astype(np.float32)
    second[:, 1:-1] = light[:, 2:] - 2.0 * light[:, 1:-1] + light[:, :-2]
    bend, both = np.zeros_like(light), light[:, 1:] + light[:, :-1]
    between = 0.5 * (second[:, 1:] + second[:, :-1]) * low[1:]
    # Light that is next to none beside its neighbours' bends by the limit, 4.
    with np.errstate(over="ignore"):
        np.divide(between, both, out=bend[:, :-1], where=both > 0.0)
    # Exact halfway for light that falls by a constant factor from node to node: 1 / cosh there.
    return np.asarray(4.0 - 4.0 / np.sqrt(1.0 + 0.5 * np.maximum(bend, -_MOST_BENT)), np.float32)


def light_over_lines(bend: FloatArray, far: FloatArray) -> FloatArray:
    """The light (...,) at places `far` in [0, 1] between two suns over that of lines."""
    tilted = 1.0 + SUN_TILT * np.sqrt(np.maximum(bend, 0.0)) * (1.0 - 2.0 * far)
    return np.asarray(1.0 - bend * tilted * far * (1.0 - far))


def _mean_of_directions(mie: SingleArray) -> SingleArray:
    """Mean (altitudes, suns * 4) over the sphere, by trapezoids."""
    turn = 2.0 * np.arcsin(np.linspace(0.0, 1.0, mie.shape[2]))
    by_mu = np.trapezoid(mie, turn / np.pi, axis=2)
    return np.asarray(np.trapezoid(by_mu, np.linspace(0.0, 1.0, mie.shape[1]), axis=1), np.float32)
