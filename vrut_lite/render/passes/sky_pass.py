"""The sky and the sun's disc, drawn after opaque meshes or before them."""

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

# Least fraction of the sun left by an eclipse, to divide by.
_LEAST_LEFT = 1e-6
# Sine of an altitude that is surely above the horizon, which dips but never rises.
_OVER_HORIZON = 0.01


class VisibleSun:
    """The sun's visible disc: mean radiance (3,), radius, limb darkening (3, 6)."""

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
    """Draws with reversed depth into the bound framebuffer."""

    def __init__(self, context: Any):
        self._context = context
        self._screens: dict[Defines, FullScreen] = {}
        self._view = BackgroundView(context)
        self._samples = context.query(samples=True)

    def show_view(self, view: ViewShader | None) -> None:
        """Draw the background by a module's own shader, or with None from the cube map.

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
        """Draw the sky in all pixels, or in those that are still `only_uncovered`.

        Args:
            defines: further features of the shader.
            pictures: number of pictures, shifted by parts of a pixel, that are averaged: their mean
                has a horizon and an edge of the sun one pixel wide.
        """
        # Cleared depth, at infinity, equals the sky's exactly.
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
        """Samples drawn by the last pass; waits for the query."""
        return int(self._samples.samples)

    def _prepared(self, view: View, light: Light, disc: VisibleSun, defines: Defines) -> FullScreen:
        """The program that draws the background, with its uniforms set."""
        if light.polariser is not None:
            defines = (*defines, "POLARISER")
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
        if light.polariser is not None:
            assert light.polarised is not None
            light.polarised.bind()
            screen.set("polariser_axis", light.polariser)
            screen.set("polarisation_scale", light.polarised.scale)
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
    """The lowest row of a picture, counted from below, from which all rays point upwards.

    Directions above an altitude form a cone: a row with both ends inside is entirely inside.
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
    """Set the disc's flattening by refraction at the eye's height."""
    sun = np.asarray(sun_direction, dtype=float)
    right = np.cross(sun, [0.0, 1.0, 0.0])
    right /= max(float(np.linalg.norm(right)), 1e-9)
    elevation = float(np.arcsin(np.clip(sun[1], -1.0, 1.0)))
    height_m = max(float(np.asarray(eye_m)[1]), 0.0)
    screen.set("sun_upper", np.cross(right, sun))
    screen.set("flattening", flattening(elevation, radius_rad, height_m))
