"""The air of a frame on the GPU: tables as textures, and the block of numbers beside them.

Meshes and sky apply the air where they are shaded (shaders/air.glsl). Each fragment knows how
far it is, so that edges with several samples and meshes that let light through come out right,
and no pass over all samples has to read a depth buffer.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.air_volume import (
    BELOW_LEVEL_M,
    SHORTEST_SPAN_M,
    evenness,
    horizon_depth,
)
from vrut_lite.kernel.messages import AirVolume
from vrut_lite.render.gl_owner import rest
from vrut_lite.render.shader_files import Defines

# As air.glsl binds them.
_BLOCK, _RADIANCE_UNIT, _EXTINCTION_UNIT = 0, 12, 13
_BLOCK_BYTES = 4 * 44


class AirSurroundings(NamedTuple):
    """What else the air of a frame depends on.

    Attributes:
        eye_altitude_m: the eye's y.
        ground_level_m: y of the ground behind the scene, below the eye.
        ground_is_bare: whether that ground is still to be seen through air.
        shadow_from_eye: matrix (4, 4) into the shadow map, of positions relative to the eye.
    """

    eye_altitude_m: float
    ground_level_m: float
    ground_is_bare: bool
    shadow_from_eye: NDArray[np.float64]


class FrameAir(NamedTuple):
    """What the shaders of meshes and sky define, to do with air what a frame asks for."""

    mesh: Defines = ()
    sky: Defines = ()

    @classmethod
    def of(cls, around: AirSurroundings, shafts: bool) -> "FrameAir":
        """Of a frame with air; a sky that is seen through all of its air needs no more."""
        mesh = ("AIR", "LIGHT_SHAFTS") if shafts else ("AIR",)
        return cls(mesh, mesh if shafts or around.ground_is_bare else ())


class AirOnGpu:
    """The textures of one volume; made and used on the GL thread only."""

    def __init__(self, context: Any):
        self._context = context
        self._block = context.buffer(reserve=_BLOCK_BYTES)
        self._radiance: Any = None
        self._extinction: Any = None
        self.volume: AirVolume | None = None

    def show(self, volume: AirVolume | None) -> None:
        """Upload a volume in place of the last; None where there is no air to be seen."""
        self.volume = volume
        if volume is None:
            return
        parts = [volume.shaded, volume.direct, volume.aerosol]
        radiance = np.concatenate([np.asarray(part.values, np.float16) for part in parts])
        extinction = np.ascontiguousarray(volume.extinction.values, dtype=np.float32)
        if self._radiance is None or self._radiance.size != radiance.shape[2::-1]:
            self._release_textures()
            self._make_textures(radiance.shape[2::-1], extinction.shape[1::-1])
        self._radiance.write(radiance.tobytes(), alignment=1)
        self._extinction.write(extinction.tobytes(), alignment=1)

    def bind(self, around: AirSurroundings) -> None:
        """Hand volume and surroundings to all shaders that are drawn with next."""
        assert self.volume is not None
        self._block.write(_packed(self.volume, around).tobytes())
        self._block.bind_to_uniform_block(_BLOCK)
        self._radiance.use(location=_RADIANCE_UNIT)
        self._extinction.use(location=_EXTINCTION_UNIT)

    def release(self) -> None:
        """Free the GL objects."""
        self._release_textures()
        self._block.release()

    def _make_textures(self, size: tuple[int, ...], rows_by_slices: tuple[int, ...]) -> None:
        linear = (self._context.LINEAR, self._context.LINEAR)
        self._radiance = self._context.texture3d(size, 3, dtype="f2", alignment=1)
        self._extinction = self._context.texture(rows_by_slices, 3, dtype="f4", alignment=1)
        for texture in (self._radiance, self._extinction):
            texture.filter = linear
            texture.repeat_x = texture.repeat_y = False
        self._radiance.repeat_z = False

    def _release_textures(self) -> None:
        if self._radiance is not None:
            rest(self._context)
            self._radiance.release()
            self._extinction.release()
        self._radiance = self._extinction = None


def _packed(volume: AirVolume, around: AirSurroundings) -> NDArray[np.float32]:
    """The block `Air` of air.glsl."""
    slices, _, columns = volume.shaded.shape[:3]
    horizon, top = horizon_depth(volume)
    radius, altitude = volume.ground_radius_m, volume.observer_altitude_m
    start_m = min(altitude, volume.top_altitude_m)
    down_m, up_m = start_m + BELOW_LEVEL_M, volume.top_altitude_m - start_m
    ground_radius = radius + around.ground_level_m
    above_ground_m = max(around.eye_altitude_m - around.ground_level_m, 0.0)
    return np.array(
        [
            *volume.sun_direction, volume.reach_m,
            *_azimuth(volume), horizon, top - horizon,
            slices, volume.rows_above, volume.rows_below, columns,
            *volume.aerosol_phase, volume.radiance_scale,
            radius + altitude, radius + volume.top_altitude_m,
            altitude - volume.top_altitude_m, evenness(altitude),
            radius + start_m, down_m * (2.0 * radius + start_m - BELOW_LEVEL_M),
            up_m * (2.0 * radius + start_m + volume.top_altitude_m),
            min(SHORTEST_SPAN_M, volume.reach_m),
            ground_radius, above_ground_m,
            _horizon_height(ground_radius, above_ground_m) if around.ground_is_bare else 0.0,
            float(around.ground_is_bare),
            *around.shadow_from_eye.T.ravel(),
        ],
        np.float32,
    )  # fmt: skip


def _azimuth(volume: AirVolume) -> NDArray[np.float64]:
    """The sun's, as a unit vector (2,) (x, z); north for a sun in the zenith."""
    across = np.array(volume.sun_direction)[[0, 2]]
    length = np.linalg.norm(across)
    return across / length if length > 1e-12 else np.array([0.0, -1.0])


def _horizon_height(ground_radius_m: float, above_ground_m: float) -> float:
    """Sine of the elevation of the ground's horizon: 0 or below."""
    radius = ground_radius_m + above_ground_m
    return -float(np.sqrt(above_ground_m * (radius + ground_radius_m))) / radius
