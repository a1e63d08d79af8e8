"""Air in front of near surfaces: one small table per picture instead of five for all air.

Near the eye the air of a direction is uniform, and its light depends on distance only. A scene of
streets or rooms has no farther surfaces but the ground.
"""

from pathlib import Path

import numpy as np

from vrut_lite.frame_part import PartGl, PartView, Screen
from vrut_lite.messages.air import AirVolume
from vrut_lite.sky.air_rows import grid_of
from vrut_lite.sky.air_volume import node_rays, slice_shares

NEAR_SAMPLERS = ("near_radiance", "near_extinction")
_SHADER = Path(__file__).parent / "shaders" / "near_air.frag"
# Limits of near air: optical depth in any channel, and relative change of extinction on the way. A
# picture then differs by less than a thousandth.
_MOST_OPTICAL_DEPTH, _MOST_CHANGE = 0.02, 0.1
_LEAST_EXTINCTION_PER_M, _LEAST_CHANGE_PER_M = 1e-15, 1e-15
# Nodes across the picture, fine enough for the sun's aureole.
_NODES = (64, 48)


class NearAirTable:
    """Made and used on the GL thread only."""

    def __init__(self, gl: PartGl):
        self._gl, self._context, context = gl, gl.context, gl.context
        self._units = tuple(map(gl.unit, NEAR_SAMPLERS))
        # By the bodies that light the air.
        self._screens: dict[tuple[str, ...], Screen] = {}
        self._textures = [context.texture(_NODES, 4, dtype="f4") for _ in "12"]
        for texture in self._textures:
            texture.filter = (context.LINEAR, context.LINEAR)
            texture.repeat_x = texture.repeat_y = False
        self._buffer = context.framebuffer(self._textures)
        self._reach_m: tuple[AirVolume | None, float] = None, 0.0

    def draw(self, volume: AirVolume, view: PartView) -> float:
        """Fill and bind the table of a view in bound air; returns its range (m), 0 without any."""
        if self._reach_m[0] is not volume:
            self._reach_m = volume, reach_m(volume)
        near_m = self._reach_m[1]
        if near_m <= 0.0:
            return 0.0
        # The outer nodes lie on the picture's edges, not half a pixel inside.
        to_edges = np.diag([*(n / (n - 1.0) for n in _NODES), 1.0, 1.0])
        ray_from_clip = np.linalg.inv(view.clip_from_eye) @ to_edges
        screen = self._screen_of(volume)
        screen.set("ray_from_clip", ray_from_clip.T.ravel())
        screen.set("metres", 0.5 * near_m)
        self._context.disable(
            self._context.DEPTH_TEST | self._context.CULL_FACE | self._context.BLEND
        )
        self._buffer.use()
        screen.draw()
        for unit, texture in zip(self._units, self._textures, strict=True):
            texture.use(location=unit)
        return near_m

    def release(self) -> None:
        """Free the GL objects."""
        self._gl.leave_framebuffers()
        for thing in (self._buffer, *self._textures):
            thing.release()

    def _screen_of(self, volume: AirVolume) -> Screen:
        defines = second_light(volume)
        if defines not in self._screens:
            self._screens[defines] = self._gl.screen(_SHADER, defines)
        return self._screens[defines]


def second_light(volume: AirVolume) -> tuple[str, ...]:
    """The define of a volume that two bodies light; empty for one body."""
    return () if volume.second is None else ("SECOND_LIGHT",)


def reach_m(volume: AirVolume) -> float:
    """Distance (m) from the eye up to which air is thin and uniform; 0 for an eye above the air."""
    if volume.observer_altitude_m > volume.top_altitude_m:
        return 0.0
    mean_per_m = np.maximum(volume.extinction.values[:2].astype(float), _LEAST_EXTINCTION_PER_M)
    spans_m = node_rays(grid_of(volume), volume.columns, volume.sun_direction[1]).span_m
    shares = slice_shares(volume.extinction.shape[0], volume.observer_altitude_m)
    changes = np.abs(mean_per_m[1] / mean_per_m[0] - 1.0) / (shares[1] * spans_m)[:, None]
    thin_m = _MOST_OPTICAL_DEPTH / float(np.max(mean_per_m))
    return min(thin_m, _MOST_CHANGE / max(float(np.max(changes)), _LEAST_CHANGE_PER_M))
