"""The sky and the sun's disc, behind everything or under it."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from OpenGL import GL

from vrut_lite.atmosphere.refraction import flattening
from vrut_lite.messages.night import NO_ECLIPSE, MoonDiscChanged
from vrut_lite.messages.sky import ViewShader
from vrut_lite.render.light import Light
from vrut_lite.render.passes.background_view import BackgroundView
from vrut_lite.render.passes.full_screen import FullScreen
from vrut_lite.render.passes.view import View
from vrut_lite.render.shader_files import Defines

# Less of the sun than can be told from none.
_LEAST_LEFT = 1e-6
# Sine of the altitude from where on the horizon is surely below: it dips, but never rises.
_OVER_HORIZON = 0.01


class VisibleSun:
    """The sun as it is seen: mean radiance (3,), radius, limb darkening (3, 6)."""

    def __init__(
        self,
        irradiance: tuple[float, float, float],
        angular_radius_rad: float,
        limb_darkening_rgb: tuple[tuple[float, ...], ...],
        hidden_by: MoonDiscChanged | None = None,
    ):
        # An eclipse hides a part of the disc and dims nothing of the rest.
        self.hidden_by = None
        if hidden_by is not None and hidden_by.sun_left_rgb != NO_ECLIPSE:
            self.hidden_by = hidden_by
            left = np.maximum(hidden_by.sun_left_rgb, _LEAST_LEFT)
            irradiance = tuple((np.asarray(irradiance) / left).tolist())
        # 2 sin^2(r / 2) is 1 - cos(r) without its cancellation.
        solid_angle = 4 * np.pi * np.sin(0.5 * angular_radius_rad) ** 2
        self.solid_angle = float(solid_angle)
        self.mean_radiance = np.asarray(irradiance) / solid_angle
        self.angular_radius_rad = angular_radius_rad
        self.limb_darkening = np.zeros((3, 6))
        for channel, polynomial in enumerate(limb_darkening_rgb):
            self.limb_darkening[channel, : len(polynomial)] = polynomial


class SkyPass:
    """Draws with reversed depth into the framebuffer that is bound."""

    def __init__(self, context: Any):
        self._context = context
        self._screens: dict[Defines, FullScreen] = {}
        self._view = BackgroundView(context)
        self._samples = context.query(samples=True)

    def show_view(self, view: ViewShader | None) -> None:
        """Draw the background by a module's own shader, or from the cube map again.

        Raises:
            UserError: the shader does not compile; the cube map is drawn.
        """
        self._view.show(view)

    def draw(
        self,
        size: tuple[int, int],
        view: View,
        light: Light,
        disc: VisibleSun,
        only_uncovered: bool,
        defines: Defines,
        pictures: int = 1,
    ) -> None:
        """Draw the sky, also where something was drawn unless `only_uncovered`.

        Args:
            defines: further features of the shader.
            pictures: of how many, shifted by parts of a pixel, this is one: all together they make
                the horizon and the sun's edge as wide as a pixel.
        """
        # At infinity, where nothing was drawn, depth is exactly the sky's.
        GL.glDepthFunc(GL.GL_GEQUAL if only_uncovered else GL.GL_ALWAYS)
        self._context.enable(self._context.DEPTH_TEST)
        self._context.disable(self._context.CULL_FACE | self._context.BLEND)
        self._context.depth_mask = False
        (width, height), lowest = size, rows_over_horizon(size, view)
        GL.glEnable(GL.GL_SCISSOR_TEST)
        with self._samples:
            for lower, upper, also in ((0, lowest, ()), (lowest, height, ("OVER_HORIZON",))):
                if upper > lower:
                    screen = self._prepared(view, light, disc, (*defines, *also))
                    screen.set("edge_px", 1.0 / pictures)
                    GL.glScissor(0, lower, width, upper - lower)
                    screen.draw()
        GL.glDisable(GL.GL_SCISSOR_TEST)
        self._context.depth_mask = True
        GL.glDepthFunc(GL.GL_GREATER)

    def count_samples(self) -> int:
        """Samples that were drawn last; waits for them."""
        return int(self._samples.samples)

    def _prepared(self, view: View, light: Light, disc: VisibleSun, defines: Defines) -> FullScreen:
        """The program that draws the background, with its uniforms set."""
        seen = self._view.screen(defines)
        screen = seen or self._screen(defines)
        ray_from_clip = np.linalg.inv(view.clip_from_eye)
        screen.set("ray_from_clip", ray_from_clip.T.ravel())
        screen.set("sky_scale", light.sky.scale)
        screen.set("sun_direction", light.sun_direction)
        screen.set("sun_disc_radiance", disc.mean_radiance)
        screen.set("sun_solid_angle", disc.solid_angle)
        screen.set("sun_angular_radius", disc.angular_radius_rad)
        _set_flattening(screen, light.sun_direction, disc.angular_radius_rad, view.eye_m)
        hiding = disc.hidden_by
        screen.set("hiding_moon", (0.0, -1.0, 0.0) if hiding is None else hiding.direction)
        screen.set("hiding_radius", 0.0 if hiding is None else hiding.angular_radius_rad)
        screen.program["limb_darkening"].value = [tuple(row) for row in disc.limb_darkening.T]
        if seen is None:
            light.sky.texture.use(location=0)
            screen.program["sky"].value = 0
        return screen

    def _screen(self, defines: Defines) -> FullScreen:
        if defines not in self._screens:
            self._screens[defines] = FullScreen(self._context, "sky.frag", defines)
        return self._screens[defines]

    def release(self) -> None:
        """Free the GL objects."""
        self._view.release()
        for screen in self._screens.values():
            screen.release()


def rows_over_horizon(size: tuple[int, int], view: View) -> int:
    """The lowest row of a picture from which on all rays look up, counted from below.

    Directions over a level form a cone: where both ends of a row are in it, all of the row is.
    """
    height = size[1]
    y = np.arange(height + 1) / height * 2.0 - 1.0
    clip = np.stack([np.stack([np.full_like(y, x), y, y**0, y**0], axis=-1) for x in (-1.0, 1.0)])
    ray = clip @ np.linalg.inv(view.clip_from_eye).T
    up = ray[..., 1] / ray[..., 3] > _OVER_HORIZON * np.linalg.norm(
        ray[..., :3] / ray[..., 3:], axis=-1
    )
    below = np.flatnonzero(~up.all(axis=0))
    return int(below[-1] + 1) if len(below) else 0


def _set_flattening(
    screen: FullScreen, sun_direction: ArrayLike, radius_rad: float, eye_m: ArrayLike
) -> None:
    """What refraction does to the disc, seen from the eye's height."""
    sun = np.asarray(sun_direction, dtype=float)
    right = np.cross(sun, [0.0, 1.0, 0.0])
    right /= max(float(np.linalg.norm(right)), 1e-9)
    elevation = float(np.arcsin(np.clip(sun[1], -1.0, 1.0)))
    height_m = max(float(np.asarray(eye_m)[1]), 0.0)
    screen.set("sun_upper", np.cross(right, sun))
    screen.set("flattening", flattening(elevation, radius_rad, height_m))
