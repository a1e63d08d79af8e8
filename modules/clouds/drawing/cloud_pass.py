"""Clouds over sky and meshes: marched into a separate picture, then blended into the frame.

Each sample of the frame gets the clouds before the sky or those before its mesh, by its own depth:
edges with several samples stay smooth. A moving picture takes clouds over from the one before.
"""

import os
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from clouds.drawing.layer_textures import SHADERS, CloudsOnGpu
from vrut_lite.frame_part import PartGl, PartTarget, PartView, Screen, Size

# Pixels of the frame to one of the clouds' while something moves, along each side; a still has one
# for each in the end.
COARSER = 2
# Clouds are softer than edges: of the pictures that a finished still is the mean of these march
# through them, and each other one shows the clouds before, less than half a pixel off, and in the
# mean less than a tenth.
MARCHED = (0, 3, 4, 7)
# Pixels below the clouds take no time, pixels among them do: a piece of the former must not set the
# size of the next. Two for each thread that a software renderer may have.
_MOST_TILES = 2 * (os.cpu_count() or 1)
Defines = tuple[str, ...]
# As cloud_take_over.glsl has them.
_OLD_SKY_UNIT, _OLD_MESH_UNIT, _OLD_DISTANCES_UNIT = 8, 10, 11
# Which blocks are marched in a picture, each once in four. What moves by whole blocks a picture
# would meet the blocks of one order never; with these it waits for 12 pictures at most.
_TURNS = (0, 1, 2, 3, 0, 1, 3, 2, 1, 2, 0, 3)


class _Before(NamedTuple):
    """A picture of the clouds: what it shows, whence, and in which light."""

    target: Any
    view: PartView
    drift_m: tuple[float, float]
    defines: Defines
    light: int


class CloudPass:
    """Draws with reversed depth into the target; on the GL thread only."""

    def __init__(self, gl: PartGl):
        self._gl, self._context = gl, gl.context
        self._tiles = gl.tiles(_MOST_TILES)
        self._programs: dict[tuple[str, Defines], Screen] = {}
        self._composite: Screen | None = None
        self._targets = gl.by_size(lambda size: _CloudTarget(gl.context, size))
        self._others = gl.by_size(lambda size: _CloudTarget(gl.context, size))
        self._depths = gl.by_size(gl.depth_copy)
        self._before: _Before | None = None
        # Result of an interrupted still.
        self._known: _Before | None = None
        self._shown: _CloudTarget | None = None
        self._turn = 0

    def draw(
        self,
        clouds: CloudsOnGpu,
        target: PartTarget,
        view: PartView,
        air: Defines,
        before_meshes: bool,
        light: int | None,
        sample: int,
    ) -> None:
        """March through the clouds and blend them in.

        Args:
            air: defines of `through_air.glsl`, none without air.
            before_meshes: whether clouds may stand before meshes.
            light: while something moves, a number of the light on them: pictures of the same light
                are taken over. None: the picture is a still.
            sample: of a still's pictures, which; the first comes first.
        """
        depth = self._depths.get(target.size)
        depth.copy(target.buffer)
        depth.use(location=4)
        if light is None:
            self._before = None
            self._shown = self._still(clouds, view, air, target.size, sample)
        else:
            self._shown = self._moving(clouds, view, air, target.size, light)
        target.buffer.use()
        self.draw_again(before_meshes)

    def draw_again(self, before_meshes: bool) -> None:
        """Blend in the clouds that were marched last."""
        assert self._shown is not None
        self._blend(self._shown.before_sky, only_sky=True)
        if before_meshes:
            self._blend(self._shown.before_mesh, only_sky=False)

    def _moving(
        self,
        clouds: CloudsOnGpu,
        view: PartView,
        defines: Defines,
        size: Size,
        light: int,
    ) -> "_CloudTarget":
        """A coarser picture that reuses pixels of the one before."""
        before, self._before = self._before, None
        target = self._targets.get(_coarser(size))
        if before is not None and before.target is target:
            target = self._others.get(target.size)
        now = _picture(target, clouds, view, defines, light)
        if before is not None and _holds(before, now):
            self._turn = (self._turn + 1) % len(_TURNS)
            self._program("cloud_known.frag", ("TAKE_OVER",)).set("turn", _TURNS[self._turn])
            self._march(clouds, now, COARSER, before, ("TAKE_OVER",))
        else:
            self._march(clouds, now, COARSER, None)
        self._before = now
        return target

    def _still(
        self,
        clouds: CloudsOnGpu,
        view: PartView,
        defines: Defines,
        size: Size,
        sample: int,
    ) -> "_CloudTarget":
        """Every pixel marched that a coarser picture, or that of the first sample, does not say."""
        target = (self._others if sample else self._targets).get(size)
        now = _picture(target, clouds, view, defines, 0)
        if not sample:
            coarser = self._targets.get(_coarser(size))
            self._known = _picture(coarser, clouds, view, defines, 0)
            self._march(clouds, self._known, COARSER, None)
        self._march(clouds, now, 1, self._known, ("TAKE_OVER", "INTERPOLATE"))
        if not sample:
            self._known = now
        return target

    def release(self) -> None:
        """Free the GL objects."""
        self._before = self._known = self._shown = None
        self._targets.release()
        self._others.release()
        self._depths.release()

    def _take_over(self, known: Screen, before: _Before, now: _Before) -> None:
        """Set what the march takes over."""
        before.target.before_sky.use(location=_OLD_SKY_UNIT)
        before.target.before_mesh.use(location=_OLD_MESH_UNIT)
        before.target.distances_m.use(location=_OLD_DISTANCES_UNIT)
        known.set("old_clip_from_axes", (before.view.projection @ before.view.rotation).T.ravel())
        known.set("moved_m", _moved_m(before, now))

    def _program(self, shader: str, defines: Defines) -> Screen:
        program = shader, defines
        if program not in self._programs:
            self._programs[program] = self._gl.screen(SHADERS / shader, defines)
        return self._programs[program]

    def _march(
        self,
        clouds: CloudsOnGpu,
        now: _Before,
        pixels: int,
        before: _Before | None,
        take_over: Defines = (),
    ) -> None:
        """Draw a picture, of which another may know a part."""
        known = self._program("cloud_known.frag", take_over)
        # A still's march begins where the coarser picture's met clouds.
        guided: Defines = ("GUIDED",) if "INTERPOLATE" in take_over else ()
        march = self._program("clouds.frag", (*now.defines, *guided))
        if before is not None:
            self._take_over(known, before, now)
        for program in (known, march):
            view = now.view
            program.set("ray_from_clip", np.linalg.inv(view.projection @ view.rotation).T.ravel())
            program.set("near_m", float(view.projection[2, 3]))
            program.set("view_axis", -view.rotation[2, :3])
            program.set("mesh_pixels", pixels)
            program.set("picture_px", now.target.size)
        context, gl = self._context, self._gl.gl
        now.target.buffer.use()
        clouds.bind_noises()
        context.disable(context.BLEND | context.CULL_FACE)
        context.enable(context.DEPTH_TEST)
        gl.glClearBufferfv(gl.GL_DEPTH, 0, np.zeros(1, np.float32))
        gl.glDepthRange(1.0, 1.0)
        gl.glDepthFunc(gl.GL_ALWAYS)
        # A picture that is given up leaves the next one the usual range of depth.
        try:
            known.draw()
            gl.glDepthFunc(gl.GL_GREATER)
            self._tiles.draw(now.target.size, lambda piece: march.draw())
        finally:
            gl.glDepthRange(0.0, 1.0)
            context.disable(context.DEPTH_TEST)

    def _blend(self, cloud: Any, only_sky: bool) -> None:
        """Blend over samples of the sky, at infinite depth, or over samples of meshes."""
        if self._composite is None:
            self._composite = self._gl.screen(SHADERS / "cloud_composite.frag")
        cloud.use(location=0)
        self._composite.set("cloud", 0)
        context, gl = self._context, self._gl.gl
        context.enable(context.DEPTH_TEST | context.BLEND)
        gl.glBlendFuncSeparate(gl.GL_ONE, gl.GL_SRC_ALPHA, gl.GL_ZERO, gl.GL_ONE)
        gl.glDepthFunc(gl.GL_GEQUAL if only_sky else gl.GL_LESS)
        gl.glDepthRange(self._gl.before_sky, 1.0)
        context.depth_mask = False
        self._composite.draw()
        context.depth_mask = True
        gl.glDepthRange(0.0, 1.0)
        gl.glDepthFunc(gl.GL_GREATER)
        context.disable(context.BLEND)


def _picture(
    target: Any, clouds: CloudsOnGpu, view: PartView, defines: Defines, light: int
) -> _Before:
    assert clouds.layer is not None
    return _Before(target, view, clouds.layer.drift_m, defines, light)


def _coarser(size: tuple[int, int]) -> tuple[int, int]:
    return -(-size[0] // COARSER), -(-size[1] // COARSER)


def _holds(before: _Before, now: _Before) -> bool:
    """Whether a picture serves the next."""
    same = (before.light, before.defines, before.target.size)
    return same == (now.light, now.defines, now.target.size)


def _moved_m(before: _Before, now: _Before) -> NDArray[np.float64]:
    """From the eye then to the eye now, less the wind's drift."""
    drift = np.subtract(now.drift_m, before.drift_m)
    moved: NDArray[np.float64] = now.view.eye_m - before.view.eye_m
    return moved - np.array([drift[0], 0.0, drift[1]])


class _CloudTarget:
    """Radiance and transmittance of the clouds before the sky, and before the meshes; distances."""

    def __init__(self, context: Any, size: tuple[int, int]):
        self.size = size
        self.before_sky, self.before_mesh = (context.texture(size, 4, dtype="f4") for _ in "12")
        for texture in (self.before_sky, self.before_mesh):
            texture.filter = (context.LINEAR, context.LINEAR)
            texture.repeat_x = texture.repeat_y = False
        self.distances_m = context.texture(size, 2, dtype="f4")
        self.distances_m.filter = (context.NEAREST, context.NEAREST)
        self.distances_m.repeat_x = self.distances_m.repeat_y = False
        # Pixels that need not be marched have a depth.
        self._known = context.depth_renderbuffer(size)
        self.buffer = context.framebuffer(
            [self.before_sky, self.before_mesh, self.distances_m], self._known
        )

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        textures = self.before_sky, self.before_mesh, self.distances_m
        for thing in (self.buffer, self._known, *textures):
            thing.release()
