"""The module's air, solved, and light looked up in its volume."""

from functools import lru_cache

import numpy as np
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solver import SourceField
from bruneton_sky.solver_job import solve_air

from vrut_lite.messages.air import AirVolume
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.air_volume import look_up_air


@lru_cache
def field(turbidity: float = 3.0) -> SourceField:
    """The module's own air, solved as for a picture."""
    air = atmosphere_of(BrunetonSkySettings(turbidity=turbidity, aerosol="one-lobe"))
    return solve_air(air)


def found(volume: AirVolume, view: FloatArray, metres: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Light added (n, 3) and transmittance (n, 3) of a volume, linear sRGB."""
    light = look_up_air(volume, np.broadcast_to(view, (metres.size, 3)), metres)
    return light.shaded + light.sunlit, light.transmittance
