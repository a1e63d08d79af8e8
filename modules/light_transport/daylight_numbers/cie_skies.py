"""CIE's standard skies that daylight factors are told for (ISO 15469:2004), as light of an hour.

Luminance is relative; a daylight factor is a ratio.
"""

from typing import Literal, get_args

import numpy as np

from light_transport.hour.illumination import Illumination
from vrut_lite.atmosphere.cie_skies import OVERCAST, general_sky
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.numeric_types import FloatArray

CieSky = Literal["16", "1", "5"]
CIE_SKIES: tuple[CieSky, ...] = get_args(CieSky)
TITLES = {
    "16": "CIE sky type 16, traditional overcast",
    "1": "CIE sky type 1, overcast, steep gradation",
    "5": "CIE sky type 5, uniform luminance",
}
_CUBE = 64
_RADIANCE = 100.0


def relative_luminance(sky: CieSky, sine: FloatArray) -> FloatArray:
    """Luminance over that of the zenith at directions whose height has this sine, 0 to 1."""
    shape = OVERCAST if sky == "16" else general_sky(int(sky))
    zenith = shape.relative_luminance(1.0, 0.0)
    return np.asarray(shape.relative_luminance(sine, 0.0) / zenith)


def cie_hour(sky: CieSky, ground_albedo: float) -> Illumination:
    """A white sky without sun, over ground of this albedo that all of the sky lights."""
    sine = texel_directions(_CUBE)[..., 1]
    luminance = _RADIANCE * relative_luminance(sky, np.maximum(sine, 0.0))
    steps = (np.arange(20_000) + 0.5) / 20_000
    level = 2.0 * np.pi * float(np.mean(_RADIANCE * relative_luminance(sky, steps) * steps))
    ground = ground_albedo * level / np.pi
    cube = np.where(sine >= 0.0, luminance, ground)
    cube = np.repeat(cube[..., None], 3, axis=-1).astype(np.float32)
    return Illumination(
        sky=cube,
        ground_radiance_rgb=(ground,) * 3,
        ground_albedo_rgb=(ground_albedo,) * 3,
        key_direction=(0.0, 1.0, 0.0),
        key_irradiance_rgb=(0.0, 0.0, 0.0),
        open_sky=irradiance_coefficients(cube),
    )
