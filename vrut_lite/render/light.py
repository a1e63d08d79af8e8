"""The light of a frame, for the passes and shaders."""

from dataclasses import dataclass
from typing import Any, NamedTuple

from numpy.typing import NDArray


class SkyTexture(NamedTuple):
    """A cube texture and its factor to radiance; `owner` keeps the texels from reuse.

    The ground in its lower half is bare, or seen `ground_through_air`.
    """

    texture: Any
    scale: float
    owner: Any
    ground_through_air: bool = False


class PolarisedSky(NamedTuple):
    """Cube textures of Q and U, and their factor to radiance."""

    q: Any
    u: Any
    scale: float

    def bind(self) -> None:
        """Bind both to their texture units in polarised_sky.glsl."""
        self.q.use(location=12)
        self.u.use(location=13)


@dataclass(frozen=True)
class Light:
    """Sun and sky of one frame; world axes, linear sRGB, W m^-2 (sr^-1).

    `sun_irradiance` falls on a plane facing the sun, unattenuated by layers. `irradiance_sh`
    (25, 3) is that of the sky with its layers, `clear_sh` that of the clear sky. `sky` is the
    background without layers, `mirrored` includes them. `sun_radius_rad` is of a uniform disc.
    `polarised` and `mirrored_polarised` are the polarisation of `sky` and of `mirrored`, None where
    nothing uses it. `polariser` is the vibration (3,) that a filter before the lens passes.
    """

    sun_direction: tuple[float, float, float]
    sun_irradiance: tuple[float, float, float]
    irradiance_sh: NDArray
    clear_sh: NDArray
    sky: SkyTexture
    mirrored: SkyTexture
    sun_radius_rad: float
    polarised: PolarisedSky | None = None
    mirrored_polarised: PolarisedSky | None = None
    polariser: NDArray | None = None


class Shadow(NamedTuple):
    """A depth texture from the sun, its texel width, and the matrix (4, 4) into it.

    The matrix maps positions relative to a centre (3,), in world axes, to clip space. `tint` holds
    the transmittance and the depth of glass, None without glass. `ranges` are those of
    `ShadowRanges`; `spread` is the penumbra radius (texels) of a caster at a distance of the map's
    depth; `aspect` the map's width over its depth.
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

    The rows of `axes` (3, 3) point right, up and towards the sun. `squares` (4, 3) are centre and
    1 / half width of each square from the widest, `depths` (4, 3) middle, 1 / depth and rounding
    error as a fraction of the depth, in metres along the axes from the eye. `spread` is the tangent
    of the sun's radius.
    """

    texture: Any
    ranges: Any
    tint: Any
    axes: NDArray
    squares: NDArray
    depths: NDArray
    spread: float


class Shadows(NamedTuple):
    """Shadow maps of the whole scene, and a finer one around the eye in large scenes.

    A finished still has `still` instead, and the scene's map if its air shows shadows.
    """

    scene: Shadow | None
    near: Shadow | None
    still: StillShadow | None = None


class Reflection(NamedTuple):
    """The sky filtered by roughness, its factor to radiance, and the reflectance table."""

    texture: Any
    scale: float
    reflectance: Any
