"""Clouds over sky and meshes: marched into a picture of their own, then blended into the frame.

Each sample of the frame gets the clouds before the sky or those before its mesh, by its own depth:
edges with several samples stay smooth.
"""

import os
from typing import Any

import numpy as np

from vrut_lite.render.clouds.layer_textures import CloudsOnGpu
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.moving_targets import MovingTargets
from vrut_lite.render.passes.full_screen import FullScreen
from vrut_lite.render.passes.view import View
from vrut_lite.render.pieces import Patience, Pieces
from vrut_lite.render.reversed_depth import DepthTexture
from vrut_lite.render.shader_files import Defines
from vrut_lite.render.size_cache import SizeCache
from vrut_lite.render.targets import Targets

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)

# Pixels of the frame to one of the clouds', along each side; a still has one for each.
COARSER = 2
# Pixels below the clouds take no time, pixels among them do: a piece of the former must not set the
# size of the next. Two for each thread that a software renderer may have.
_MOST_TILES = 2 * (os.cpu_count() or 1)
_BEFORE_SKY = 1e-20


class CloudPass:
    """Draws with reversed depth into the multisampled target; on the GL thread only."""

    def __init__(self, context: Any, patience: Patience):
        self._context = context
        self._pieces = Pieces(patience, _MOST_TILES)
        self._marches: dict[Defines, FullScreen] = {}
        self._composite: FullScreen | None = None
        self._targets = SizeCache(context, lambda size: _CloudTarget(context, size))
        self._depths = SizeCache(context, DepthTexture)

    def draw(
        self,
        clouds: CloudsOnGpu,
        targets: Targets | MovingTargets,
        view: View,
        air: Defines,
        pixels: int,
        before_meshes: bool,
    ) -> None:
        """March through the clouds and blend them in.

        Args:
            pixels: of the frame to one of the clouds', along each side.
            before_meshes: whether clouds may stand before meshes.
        """
        width, height = targets.size
        target = self._targets.get((-(-width // pixels), -(-height // pixels)))
        defines = (*(name for name in air if name == "AIR"),)
        if before_meshes:
            defines = (*defines, "BEFORE_MESHES")
            depth = self._depths.get(targets.size)
            depth.copy(targets.multisampled)
            depth.use(location=4)
        self._march(clouds, view, defines, target, pixels)
        targets.multisampled.use()
        self._blend(target.before_sky, only_sky=True)
        if before_meshes:
            self._blend(target.before_mesh, only_sky=False)

    def release(self) -> None:
        """Free the GL objects."""
        for screen in (*self._marches.values(), self._composite):
            if screen is not None:
                screen.release()
        self._targets.release()
        self._depths.release()

    def _march(
        self, clouds: CloudsOnGpu, view: View, defines: Defines, target: Any, pixels: int
    ) -> None:
        if defines not in self._marches:
            self._marches[defines] = FullScreen(self._context, "clouds.frag", defines)
        march = self._marches[defines]
        march.set("ray_from_clip", np.linalg.inv(view.projection @ view.rotation).T.ravel())
        march.set("near_m", float(view.projection[2, 3]))
        march.set("view_axis", -view.rotation[2, :3])
        march.set("mesh_pixels", float(pixels))
        target.buffer.use()
        clouds.bind_noises()
        self._context.disable(self._context.DEPTH_TEST | self._context.BLEND)
        self._context.disable(self._context.CULL_FACE)
        self._pieces.draw(target.size, lambda piece: march.draw())

    def _blend(self, cloud: Any, only_sky: bool) -> None:
        """Blend over samples of the sky, at infinite depth, or over samples of meshes."""
        if self._composite is None:
            self._composite = FullScreen(self._context, "cloud_composite.frag")
        cloud.use(location=0)
        self._composite.set("cloud", 0)
        context = self._context
        context.enable(context.DEPTH_TEST | context.BLEND)
        GL.glBlendFuncSeparate(GL.GL_ONE, GL.GL_SRC_ALPHA, GL.GL_ZERO, GL.GL_ONE)
        GL.glDepthFunc(GL.GL_GEQUAL if only_sky else GL.GL_LESS)
        # Before the depths that pictures of one sample give the sky, behind all else.
        GL.glDepthRange(_BEFORE_SKY, 1.0)
        context.depth_mask = False
        self._composite.draw()
        context.depth_mask = True
        GL.glDepthRange(0.0, 1.0)
        GL.glDepthFunc(GL.GL_GREATER)
        context.disable(context.BLEND)


class _CloudTarget:
    """Radiance and transmittance of the clouds before the sky, and before the meshes."""

    def __init__(self, context: Any, size: tuple[int, int]):
        self.size = size
        self.before_sky, self.before_mesh = (context.texture(size, 4, dtype="f4") for _ in "12")
        for texture in (self.before_sky, self.before_mesh):
            texture.filter = (context.LINEAR, context.LINEAR)
            texture.repeat_x = texture.repeat_y = False
        self.buffer = context.framebuffer([self.before_sky, self.before_mesh])

    def release(self) -> None:
        """Free everything; another framebuffer must be bound."""
        for thing in (self.buffer, self.before_sky, self.before_mesh):
            thing.release()
