"""The light of a frame, as the shaders take it."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray


@dataclass(frozen=True)
class Light:
    """Sun, sky and shadow of one frame; world axes, linear sRGB, W m^-2 (sr^-1).

    `irradiance_sh` is (25, 3); `shadow_matrix` (4, 4) maps positions that count from the
    scene's centre to the shadow map's clip space; `shadow_texel_m` is the width of one of its
    texels.
    """

    sun_direction: tuple[float, float, float]
    sun_irradiance: tuple[float, float, float]
    irradiance_sh: NDArray
    sky_texture: Any
    sky_scale: float
    shadow_texture: Any
    shadow_matrix: NDArray
    shadow_texel_m: float
