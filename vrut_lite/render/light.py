"""The light of a frame, for the passes and shaders."""

from dataclasses import dataclass
from typing import Any, NamedTuple

from numpy.typing import NDArray


class SkyTexture(NamedTuple):
    """A cube texture and the factor to its radiance; `owner` keeps the texels from reuse.

    The ground in its lower half is bare, or shown `ground_through_air`.
    """

    texture: Any
    scale: float
    owner: Any
    ground_through_air: bool = False


@dataclass(frozen=True)
class Light:
    """Sun and sky of one frame; world axes, linear sRGB, W m^-2 (sr^-1).

    `sun_irradiance` is that of a plane facing the sun, before any layer; `irradiance_sh` (25, 3)
    is that of the sky with its layers, `clear_sh` of the clear sky. `sky` is seen behind the scene,
    before layers are drawn; `mirrored` has them in it. `sun_radius_rad` is that of an even disc.
    """

    sun_direction: tuple[float, float, float]
    sun_irradiance: tuple[float, float, float]
    irradiance_sh: NDArray
    clear_sh: NDArray
    sky: SkyTexture
    mirrored: SkyTexture
    sun_radius_rad: float


class Shadow(NamedTuple):
    """A depth texture from the sun, the width of its texels, and the matrix (4, 4) into it.

    The matrix maps positions that count from a centre (3,) in the world to clip space. `tint` is
    what glass leaves of the light, and the depth of the glass, None where there is none. `ranges`
    are those of `ShadowRanges`; `spread` is the radius of a penumbra, in texels, of what is the
    whole map's depth away; `aspect` the map's width over its depth.
    """

    texture: Any
    matrix: NDArray
    texel_m: float
    centre_m: NDArray
    tint: Any = None
    ranges: Any = None
    spread: float = 0.0
    aspect: float = 1.0


class StillShadow(NamedTuple):
    """A shadow map of squares, as `StillShadowMap` draws it: textures as in `Shadow`.

    `axes` (3, 3) are rows right, up and towards the sun. In metres along them from the eye are, of
    each square from the widest, `squares` (4, 3), its centre and 1 / half its width, and `depths`
    (4, 3), its middle, 1 / its depth, and what rounding may take, in shares of the depth. `spread`
    is the tangent of the sun's radius.
    """

    texture: Any
    ranges: Any
    tint: Any
    axes: NDArray
    squares: NDArray
    depths: NDArray
    spread: float


class Shadows(NamedTuple):
    """The shadows of all the scene, and finer ones around the eye where those are coarse.

    A finished still has `still` in their place, and those of the scene for shafts in its air.
    """

    scene: Shadow | None
    near: Shadow | None
    still: StillShadow | None = None


class Reflection(NamedTuple):
    """The sky filtered by roughness, the factor to its radiance, and the table of shares."""

    texture: Any
    scale: float
    reflectance: Any
