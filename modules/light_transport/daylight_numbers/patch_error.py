"""What patches err by: the same numbers by patches twice as wide."""

from collections.abc import Mapping

import numpy as np

from light_transport.daylight_numbers.now import daylight_factor
from light_transport.daylight_numbers.operator import operator_of
from light_transport.daylight_numbers.work import RAYS_SHARE, Work, baked
from light_transport.hour.illumination import Illumination
from vrut_lite.messages.glazing import Glazing
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import FloatArray

# Twice as wide: a quarter of the texels.
_SHARE_OF_TEXELS = 0.25
_MOST_SENSORS = 48


def patch_error(
    scene: SceneOpened,
    work: Work,
    glazing: Mapping[str, Glazing],
    tolerance: float,
    light: Illumination,
    factor: FloatArray,
) -> float:
    """How far daylight factors (P,) move with patches twice as wide: rms, a share of their mean.

    The error of the finer patches is about as large where it falls with their width, and smaller
    where it falls faster. Some evenly chosen sensors are asked; the noise of rays is in it.
    """
    chosen = np.arange(0, len(work.sensors), -(-len(work.sensors) // _MOST_SENSORS))
    bake = baked(scene, tolerance, _SHARE_OF_TEXELS, glazing=glazing)
    sensors = work.sensors.some(chosen)
    operator = operator_of(bake, work.glass, sensors, RAYS_SHARE * tolerance, bake.threads)
    coarser, _ = daylight_factor(bake, work.glass, operator, sensors, light)
    moved = np.sqrt(np.mean((coarser - factor[chosen]) ** 2))
    return float(moved / max(factor[chosen].mean(), 1e-12))
