"""The sun behind the place's cloudless air, on the ground."""

import numpy as np

from vrut_lite.atmosphere.sunlight import whole_disc_rgb
from vrut_lite.messages.haze import SetHaze
from vrut_lite.numeric_types import FloatArray


def sun_irradiance_rgb(haze: SetHaze, apparent_elevation_rad: float) -> FloatArray:
    """Irradiance (3,) by the whole disc on a plane that faces it, linear sRGB, W m^-2.

    May lie below 0 outside the gamut. A sun below the horizon counts as on it.
    """
    sine = max(float(np.sin(apparent_elevation_rad)), 0.0)
    return whole_disc_rgb(0.0, sine, haze.aerosol_layers, haze.nitrogen_dioxide)
