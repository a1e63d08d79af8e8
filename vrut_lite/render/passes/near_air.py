"""The air before what stands near: one small table of a picture, in place of five of all air.

Near the eye the air's light grows with distance alone, by what the air in a direction is. A scene
of streets or rooms has no farther surfaces but the ground.
"""

from typing import Any, NamedTuple

import numpy as np

from vrut_lite.messages.air import AirVolume
from vrut_lite.render.passes.full_screen import FullScreen
from vrut_lite.render.passes.view import View
from vrut_lite.render.pyrender_scene import PlacedPrimitive
from vrut_lite.render.shader_files import Defines
from vrut_lite.sky.air_rows import grid_of
from vrut_lite.sky.air_volume import node_rays, slice_shares

# Defined in shaders of air that two bodies light.
SECOND_LIGHT = "SECOND_LIGHT"
# As near_air.glsl has it.
NEAR_AIR_UNIT = 36
# Of what is near, in any channel, and by which share the air may change on the way: a picture
# differs by less than a thousandth then.
_MOST_OPTICAL_DEPTH, _MOST_CHANGE = 0.02, 0.1
_LEAST_EXTINCTION_PER_M, _LEAST_CHANGE_PER_M = 1e-15, 1e-15
# Nodes across the picture; the sun's aureole is the sharpest that they must follow.
_NODES = (64, 48)


class NearAir(NamedTuple):
    """Up to where the table holds, from the eye; the size of the picture that it is of."""

    reach_m: float
    size_px: tuple[int, int]

    def holds(self, placed: PlacedPrimitive, view: View) -> bool:
        """Whether all of a mesh is near."""
        away_m = float(np.linalg.norm(placed.centre_m - view.eye_m))
        return away_m + placed.radius_m <= self.reach_m


class NearAirTable:
    """Made and used on the GL thread only."""

    def __init__(self, context: Any):
        self._context = context
        # By the bodies that light the air.
        self._screens: dict[Defines, FullScreen] = {}
        self._textures = [context.texture(_NODES, 4, dtype="f4") for _ in "12"]
        for texture in self._textures:
            texture.filter = (context.LINEAR, context.LINEAR)
            texture.repeat_x = texture.repeat_y = False
        self._buffer = context.framebuffer(self._textures)
        self._reach_m: tuple[AirVolume | None, float] = None, 0.0

    def draw(self, volume: AirVolume, view: View, size_px: tuple[int, int]) -> NearAir | None:
        """Fill the table for a view in air that is bound, and bind it; None where none is near."""
        if self._reach_m[0] is not volume:
            self._reach_m = volume, reach_m(volume)
        near = NearAir(self._reach_m[1], size_px)
        if near.reach_m <= 0.0:
            return None
        # From a picture's edge to its edge, where pixels lie between these.
        to_edges = np.diag([*(n / (n - 1.0) for n in _NODES), 1.0, 1.0])
        ray_from_clip = np.linalg.inv(view.clip_from_eye) @ to_edges
        screen = self._screen_of(volume)
        screen.set("ray_from_clip", ray_from_clip.T.ravel())
        screen.set("metres", 0.5 * near.reach_m)
        self._context.disable(
            self._context.DEPTH_TEST | self._context.CULL_FACE | self._context.BLEND
        )
        self._buffer.use()
        screen.draw()
        for number, texture in enumerate(self._textures):
            texture.use(location=NEAR_AIR_UNIT + number)
        return near

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        for thing in (self._buffer, *self._textures, *self._screens.values()):
            thing.release()

    def _screen_of(self, volume: AirVolume) -> FullScreen:
        defines = second_light(volume)
        if defines not in self._screens:
            self._screens[defines] = FullScreen(self._context, "near_air.frag", defines)
        return self._screens[defines]


def second_light(volume: AirVolume) -> Defines:
    """The define of a volume that two bodies light; none of one body's."""
    return () if volume.second is None else (SECOND_LIGHT,)


def reach_m(volume: AirVolume) -> float:
    """How far from the eye all air is thin and alike, in m; 0 for an eye above the air."""
    if volume.observer_altitude_m > volume.top_altitude_m:
        return 0.0
    mean_per_m = np.maximum(volume.extinction.values[:2].astype(float), _LEAST_EXTINCTION_PER_M)
    spans_m = node_rays(grid_of(volume), volume.columns, volume.sun_direction[1]).span_m
    shares = slice_shares(volume.extinction.shape[0], volume.observer_altitude_m)
    changes = np.abs(mean_per_m[1] / mean_per_m[0] - 1.0) / (shares[1] * spans_m)[:, None]
    thin_m = _MOST_OPTICAL_DEPTH / float(np.max(mean_per_m))
    return min(thin_m, _MOST_CHANGE / max(float(np.max(changes)), _LEAST_CHANGE_PER_M))
