"""The light map as pictures in false colours: light, texel size and noise. No Qt here."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from light_transport.drawing.texel_values import noise_of_pair, texel_edges_m
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.false_colours import coloured, scale_of
from vrut_lite.messages.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import FloatArray


class FalseColours(NamedTuple):
    """sRGB pixels (h, w, 3) uint8, and the values of the darkest and the brightest colour."""

    pixels: NDArray[np.uint8]
    low: float
    high: float


def light_picture(light: SurfaceLightChanged) -> FalseColours:
    """Illuminance by all but the key light's own light, in lux, on a scale by ratios."""
    rgb = light.texels.values[..., :3].astype(float) * light.radiance_scale
    return _picture(luminance(rgb) * LUMENS_PER_WATT)


def error_picture(finer: SurfaceLightChanged, coarser: SurfaceLightChanged) -> FalseColours:
    """Noise that the finer's rays leave, as a share of the light: see `texel_values.noise`."""
    return _picture(noise_of_pair(finer, coarser))


def density_picture(laid: LightMapLaid, scene: SceneOpened) -> FalseColours:
    """The edge of the texels in metres."""
    return _picture(texel_edges_m(laid, scene))


def _picture(values: FloatArray) -> FalseColours:
    scale = scale_of(values)
    return FalseColours(coloured(values, scale), scale.low, scale.high)
