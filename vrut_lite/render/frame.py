"""One frame on the GL thread: shadow map, sky, meshes, resolve, exposure, tone map.

Radiance stays linear and in physical units, in 32-bit floats, until the tone map: the sun's
disc is brighter than half precision can hold.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import LUMINANCE_WEIGHTS
from vrut_lite.kernel.messages import SetExposure
from vrut_lite.render import exposure, tone_map
from vrut_lite.render.gl_owner import rest
from vrut_lite.render.light import Light
from vrut_lite.render.mesh_renderer import SHADERS, MeshRenderer, View
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.reversed_depth import FloatDepth, reversed_depth
from vrut_lite.scene.backend import Picture

SAMPLES = 4
SHADOW_SIZE = 4096
_CUBE_MAP_SEAMLESS = 0x884F


class Frame:
    """GL objects of the frame; made and used on the GL thread only."""

    def __init__(self, context: Any):
        self._context = context
        self.meshes = MeshRenderer()
        self._sky_program = _full_screen_program(context, "sky.frag")
        self._tone_program = _full_screen_program(context, "tone_map.frag")
        self._sky_triangle = context.vertex_array(self._sky_program, [])
        self._tone_triangle = context.vertex_array(self._tone_program, [])
        self._targets: _Targets | None = None
        self.shadow_texture = context.depth_texture((SHADOW_SIZE, SHADOW_SIZE))
        self.shadow_texture.compare_func = "<="
        self.shadow_texture.filter = (context.LINEAR, context.LINEAR)
        self._shadow_buffer = context.framebuffer(depth_attachment=self.shadow_texture)
        context.enable_direct(_CUBE_MAP_SEAMLESS)
        _set_tone_curve(self._tone_program)

    def draw(
        self,
        scene: PyrenderScene,
        view: View,
        light: Light,
        disc: "SunDisc",
        wish: SetExposure,
        size: tuple[int, int],
    ) -> Picture:
        """Draw a scene, the sky and the sun; size is (width, height) in pixels."""
        targets = self._targets_of(size)
        self.meshes.update(scene)
        if any(light.sun_irradiance):
            self._draw_shadow(scene, light)
        targets.multisampled.use()
        targets.multisampled.clear()
        with reversed_depth():
            self._draw_sky(view, light, disc)
            self.meshes.draw(scene, view, light)
        self._context.copy_framebuffer(targets.resolved, targets.multisampled)
        radiance = targets.read_radiance()
        ev100 = wish.ev100 if wish.mode == "manual" else exposure.automatic_ev100(radiance)
        ev100 -= wish.compensation_ev
        return Picture(radiance, self._tone_mapped(targets, ev100), ev100)

    def release(self) -> None:
        """Free everything, on the GL thread."""
        rest(self._context)
        self.meshes.delete()
        for thing in (self._sky_triangle, self._tone_triangle, self._sky_program,
                      self._tone_program, self._shadow_buffer, self.shadow_texture):  # fmt: skip
            thing.release()
        if self._targets is not None:
            self._targets.release()

    def _targets_of(self, size: tuple[int, int]) -> "_Targets":
        if self._targets is None or self._targets.size != size:
            if self._targets is not None:
                rest(self._context)
                self._targets.release()
            self._targets = _Targets(self._context, size)
        return self._targets

    def _draw_shadow(self, scene: PyrenderScene, light: Light) -> None:
        self._shadow_buffer.use()
        self._shadow_buffer.clear()
        self.meshes.draw_depth(scene, light.shadow_matrix)

    def _draw_sky(self, view: View, light: Light, disc: "SunDisc") -> None:
        program = self._sky_program
        ray_from_clip = np.linalg.inv(view.projection @ view.rotation)
        _set(program, "ray_from_clip", ray_from_clip.T.ravel())
        _set(program, "sky_scale", light.sky_scale)
        _set(program, "sun_direction", light.sun_direction)
        _set(program, "sun_disc_radiance", disc.mean_radiance)
        _set(program, "sun_angular_radius", disc.angular_radius_rad)
        program["limb_darkening"].value = [tuple(row) for row in disc.limb_darkening.T]
        light.sky_texture.use(location=0)
        program["sky"].value = 0
        self._context.disable(self._context.DEPTH_TEST | self._context.CULL_FACE)
        self._context.depth_mask = False
        self._sky_triangle.render(vertices=3)
        self._context.depth_mask = True

    def _tone_mapped(self, targets: "_Targets", ev100: float) -> NDArray[np.uint8]:
        targets.display.use()
        targets.radiance.use(location=0)
        _set(self._tone_program, "exposure_scale", exposure.scale_of(ev100))
        self._context.disable(self._context.DEPTH_TEST | self._context.CULL_FACE)
        self._tone_triangle.render(vertices=3)
        width, height = targets.size
        pixels = np.frombuffer(targets.display.read(components=3, alignment=1), np.uint8)
        return pixels.reshape(height, width, 3)[::-1].copy()


class SunDisc:
    """The sun as it is seen: mean radiance (3,), radius, limb darkening (3, 6)."""

    def __init__(
        self,
        irradiance: tuple[float, float, float],
        angular_radius_rad: float,
        limb_darkening_rgb: tuple[tuple[float, ...], ...],
    ):
        # 2 sin^2(r / 2) is 1 - cos(r) without its cancellation.
        solid_angle = 4 * np.pi * np.sin(0.5 * angular_radius_rad) ** 2
        self.mean_radiance = np.asarray(irradiance) / solid_angle
        self.angular_radius_rad = angular_radius_rad
        self.limb_darkening = np.zeros((3, 6))
        for channel, polynomial in enumerate(limb_darkening_rgb):
            self.limb_darkening[channel, : len(polynomial)] = polynomial


class _Targets:
    """Framebuffers of one picture size."""

    def __init__(self, context: Any, size: tuple[int, int]):
        self.size = size
        self._colour = context.renderbuffer(size, 4, samples=SAMPLES, dtype="f4")
        self.multisampled = context.framebuffer([self._colour])
        self._depth = FloatDepth(self.multisampled, size, SAMPLES)
        self.radiance = context.texture(size, 4, dtype="f4")
        self.resolved = context.framebuffer([self.radiance])
        self._display = context.texture(size, 4)
        self.display = context.framebuffer([self._display])

    def read_radiance(self) -> NDArray[np.float32]:
        """The resolved picture (h, w, 3), row 0 at the top."""
        width, height = self.size
        pixels = np.frombuffer(self.radiance.read(), np.float32)
        return pixels.reshape(height, width, 4)[::-1, :, :3].copy()

    def release(self) -> None:
        for thing in (self.multisampled, self.resolved, self.display, self._colour, self._depth,
                      self.radiance, self._display):  # fmt: skip
            thing.release()


def _full_screen_program(context: Any, fragment_shader: str) -> Any:
    return context.program(
        vertex_shader=(SHADERS / "full_screen.vert").read_text(),
        fragment_shader=(SHADERS / fragment_shader).read_text(),
    )


def _set(program: Any, name: str, value: Any) -> None:
    """Set a uniform, unless the compiler found it unused."""
    if name in program:
        program[name].value = value if isinstance(value, float) else tuple(map(float, value))


def _set_tone_curve(program: Any) -> None:
    _set(program, "inset", tone_map.INSET.T.ravel())
    _set(program, "outset", tone_map.OUTSET.T.ravel())
    _set(program, "darkest_log2", tone_map.DARKEST_LOG2)
    _set(program, "brightest_log2", tone_map.BRIGHTEST_LOG2)
    _set(program, "contrast", tone_map.CONTRAST)
    _set(program, "saturation", tone_map.SATURATION)
    _set(program, "luminance_weights", LUMINANCE_WEIGHTS)
    program["sigmoid"].value = list(tone_map.SIGMOID)
