"""The air of a picture on the GPU: tables as textures, and the block of numbers beside them."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from air.block import AIR, BLOCK
from vrut_lite.frame_part import SUN_GLOW_RAD, PartFrame, PartGl
from vrut_lite.messages.air import AirVolume
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.numeric_types import Vector
from vrut_lite.sky.air_rows import BELOW_LEVEL_M, horizon_depth, rows_below
from vrut_lite.sky.air_volume import SHORTEST_SPAN_M, evenness, log_extinction

SAMPLERS = ("air_radiance", "air_extinction", "air_phase")


class AirOnGpu:
    """The textures of one volume; made and used on the GL thread only."""

    def __init__(self, gl: PartGl):
        self._gl, self._context = gl, gl.context
        self._block, self._binding = (
            gl.context.buffer(reserve=AIR.size_bytes),
            gl.block(BLOCK).binding,
        )
        self._units = tuple(map(gl.unit, SAMPLERS))
        self._uploaded: Any = None
        self._radiance: Any = None
        self._extinction: Any = None
        self._phase: Any = None
        self.volume: AirVolume | None = None

    def show(self, volume: AirVolume | None) -> None:
        """Upload a volume in place of the last; None where no air is visible.

        Light that is a GPU texture is used directly.
        """
        self.volume = volume
        if volume is None:
            return
        extinction = _padded(log_extinction(volume), np.float32)
        self._extinction = self._written(self._extinction, extinction, extinction.shape[1::-1])
        phase = _padded(volume.aerosol_phase.values, np.float32)
        self._phase = self._written(self._phase, phase, (len(phase), 1))
        if isinstance(volume.light, GpuTexture):
            # The texture is valid while the kept volume refers to it.
            self._radiance = _between_nodes(self._context, volume.light.opaque)
            return
        light = _padded(volume.light.values, np.float32)
        if (second := volume.second) is not None:
            assert second.light is not None
            of_second = _padded(second.light.values, np.float32)
            of_second *= np.float32(second.radiance_scale / volume.radiance_scale)
            light = np.concatenate([light, of_second])
        kinds, slices, rows, columns, _ = light.shape
        self._uploaded = self._written(self._uploaded, light, (columns, rows, kinds * slices))
        self._radiance = self._uploaded

    def bind(self, frame: PartFrame) -> None:
        """Hand the volume to all shaders that a picture is drawn with."""
        assert self.volume is not None
        self._block.write(_packed(self.volume, frame))
        self._block.bind_to_uniform_block(self._binding)
        textures = self._radiance, self._extinction, self._phase
        for unit, texture in zip(self._units, textures, strict=True):
            texture.use(location=unit)

    def release(self) -> None:
        """Free the GL objects."""
        self._release(self._uploaded)
        self._release(self._extinction)
        self._release(self._phase)
        self._uploaded = self._extinction = self._phase = self._radiance = None
        self._block.release()

    def _written(self, texture: Any, values: NDArray[Any], size: tuple[int, ...]) -> Any:
        """Values in a texture of that size: the one given, or a new one in its place."""
        if texture is None or texture.size != size:
            self._release(texture)
            make = self._context.texture3d if len(size) == 3 else self._context.texture
            dtype = f"f{values.itemsize}"
            texture = _between_nodes(self._context, make(size, 4, dtype=dtype, alignment=1))
        texture.write(values.tobytes(), alignment=1)
        return texture

    def _release(self, texture: Any) -> None:
        if texture is not None:
            self._gl.leave_framebuffers()
            texture.release()


def _padded(values: NDArray[Any], dtype: Any) -> NDArray[Any]:
    """RGB with a fourth number: texels that software renderers fetch whole."""
    padded = np.zeros((*values.shape[:-1], 4), dtype)
    # By channel: numpy is slow at rows of three.
    for channel in range(3):
        padded[..., channel] = values[..., channel]
    return padded


def _between_nodes(context: Any, texture: Any) -> Any:
    """The texture, to be looked up between its nodes, and at its edges past them."""
    texture.filter = (context.LINEAR, context.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    if len(texture.size) == 3:
        texture.repeat_z = False
    return texture


def _packed(volume: AirVolume, frame: PartFrame) -> bytes:
    """The uniform block `AIR`."""
    horizon, top = horizon_depth(volume)
    radius, altitude = volume.ground_radius_m, volume.observer_altitude_m
    start_m = min(altitude, volume.top_altitude_m)
    down_m, up_m = start_m + BELOW_LEVEL_M, volume.top_altitude_m - start_m
    ground_radius = radius + frame.ground_level_m
    above_ground_m = max(float(frame.view.eye_m[1]) - frame.ground_level_m, 0.0)
    bare = frame.ground_is_bare
    second = volume.sun_direction if volume.second is None else volume.second.direction
    return AIR.packed(
        sun_direction=volume.sun_direction,
        reach_m=volume.reach_m,
        sun_azimuth=_azimuth(volume.sun_direction),
        second_direction=second,
        second_azimuth=_azimuth(second),
        horizon_depth=horizon,
        depth_above_horizon=top - horizon,
        slices=volume.extinction.shape[0],
        rows_above=volume.rows_above,
        rows_below=volume.rows_below,
        columns=volume.columns,
        radiance_scale=volume.radiance_scale,
        observer_radius_m=radius + altitude,
        top_radius_m=radius + volume.top_altitude_m,
        above_top_m=altitude - volume.top_altitude_m,
        evenness=evenness(altitude),
        start_radius_m=radius + start_m,
        tangent_below_m2=down_m * (2.0 * radius + start_m - BELOW_LEVEL_M),
        tangent_above_m2=up_m * (2.0 * radius + start_m + volume.top_altitude_m),
        shortest_span_m=min(SHORTEST_SPAN_M, volume.reach_m),
        ground_radius_m=ground_radius,
        above_ground_m=above_ground_m,
        horizon_height=_horizon_height(ground_radius, above_ground_m) if bare else 0.0,
        ground_is_bare=float(bare),
        rows_down=rows_below(volume),
        picture_px=frame.size_px,
        glow_cosines=(math.cos(SUN_GLOW_RAD), math.cos(0.5 * SUN_GLOW_RAD)),
        shadow_from_eye=np.eye(4) if frame.shadow is None else frame.shadow.clip_from_eye,
    )


def _azimuth(direction: Vector) -> NDArray[np.float64]:
    """A body's, as a unit vector (2,) (x, z); north for one in the zenith."""
    across = np.array(direction)[[0, 2]]
    length = np.linalg.norm(across)
    return across / length if length > 1e-12 else np.array([0.0, -1.0])


def _horizon_height(ground_radius_m: float, above_ground_m: float) -> float:
    """Sine of the elevation of the ground's horizon: 0 or below."""
    radius = ground_radius_m + above_ground_m
    return -float(np.sqrt(above_ground_m * (radius + ground_radius_m))) / radius
