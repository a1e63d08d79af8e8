"""One frame on the GL thread: shadow map, reflections, meshes, sky, resolve, tone map.

Radiance stays linear and in physical units until the tone map.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

from vrut_lite.kernel.ledger import Ledger
from vrut_lite.kernel.messages import SetExposure
from vrut_lite.render import exposure
from vrut_lite.render.culling import in_view
from vrut_lite.render.gl_owner import rest
from vrut_lite.render.light import Light, Reflection, Shadow
from vrut_lite.render.mesh_renderer import MeshRenderer, View, in_order
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene
from vrut_lite.render.reflection import reflectance_table
from vrut_lite.render.reversed_depth import reversed_depth
from vrut_lite.render.shadow_map import ShadowMap
from vrut_lite.render.skips import FrameSkips
from vrut_lite.render.sky_pass import SkyPass, SunDisc
from vrut_lite.render.specular_filter import SpecularFilter
from vrut_lite.render.targets import Targets
from vrut_lite.render.tone_pass import TonePass
from vrut_lite.scene.backend import Picture

_CUBE_MAP_SEAMLESS = 0x884F
# Of the 24 slices of the filtered sky, in a frame that is not to wait for them: a sixth of its
# time where slices are largest.
SLICES_A_FRAME = 2

Measure = Callable[[str], AbstractContextManager[Any]]


class Frame:
    """GL objects of the frame; made and used on the GL thread only.

    `measure` is entered around each pass, with its name; `ledger` counts what was done and
    what was skipped, `skips` says what may be.
    """

    def __init__(self, context: Any):
        self._context = context
        self.ledger = Ledger()
        self.skips = FrameSkips()
        self.measure: Measure = lambda name: nullcontext()
        context.enable_direct(_CUBE_MAP_SEAMLESS)
        self._meshes = MeshRenderer()
        self._sky = SkyPass(context)
        self._tone = TonePass(context)
        self._shadow = ShadowMap(context, self.ledger)
        self._filter = SpecularFilter(context, self.ledger)
        self._reflectance = _table_texture(context)
        self._targets: Targets | None = None

    def draw(
        self,
        scene: PyrenderScene,
        view: View,
        light: Light,
        disc: SunDisc,
        wish: SetExposure,
        size: tuple[int, int],
        still: bool = True,
    ) -> Picture:
        """Draw a scene, the sky and the sun; size is (width, height) in pixels.

        A `still` is finished in every respect; otherwise what may lag is done in slices.
        """
        targets = self._targets_of(size)
        self._meshes.update(scene)
        seen = self._seen(scene, view)
        with self.measure("reflection"):
            reflection = self._reflection(light, seen, still)
        with self.measure("shadow"):
            shadow = self._shadow.update(self._meshes, scene, light, not self.skips.shadow)
        targets.multisampled.use()
        targets.multisampled.clear()
        with reversed_depth():
            self._draw_seen(scene, seen, view, light, disc, shadow, reflection)
        with self.measure("resolve"):
            self._context.copy_framebuffer(targets.resolved, targets.multisampled)
        with self.measure("copy and meter"):
            radiance = targets.read_radiance()
            ev100 = wish.ev100 if wish.mode == "manual" else exposure.automatic_ev100(radiance)
        ev100 -= wish.compensation_ev
        with self.measure("tone map"):
            self._tone.draw(targets, ev100, wish)
        return Picture(radiance, targets.read_display(), ev100)

    def release(self) -> None:
        """Free everything, on the GL thread."""
        rest(self._context)
        self._meshes.delete()
        for thing in (self._sky, self._tone, self._shadow, self._filter, self._reflectance):
            thing.release()
        if self._targets is not None:
            self._targets.release()

    def _draw_seen(
        self,
        scene: PyrenderScene,
        seen: list[PlacedPrimitive],
        view: View,
        light: Light,
        disc: SunDisc,
        shadow: Shadow,
        reflection: Reflection,
    ) -> None:
        """Opaque meshes, the sky in what they leave, and what lets both through."""
        opaque, blended = in_order(seen, view.eye_m)
        if not self.skips.sky:
            self._draw_sky(view, light, disc)
        with self.measure("mesh"):
            self._meshes.draw(scene, opaque, view, light, shadow, reflection)
        if self.skips.sky:
            self._draw_sky(view, light, disc)
        with self.measure("blended mesh"):
            self._meshes.draw(scene, blended, view, light, shadow, reflection)

    def _draw_sky(self, view: View, light: Light, disc: SunDisc) -> None:
        assert self._targets is not None
        if light.is_none and self.skips.unlit:
            self.ledger.skip("sky sample: in a closed room", self._targets.samples)
            return
        with self.measure("sky"):
            drawn = self._sky.draw(view, light, disc, only_uncovered=self.skips.sky)
        self.ledger.did("sky sample", drawn)
        self.ledger.skip("sky sample: covered", self._targets.samples - drawn)

    def _seen(self, scene: PyrenderScene, view: View) -> list[PlacedPrimitive]:
        """What may be in the picture."""
        if not self.skips.meshes:
            seen = scene.placed
        else:
            seen = [placed for placed in scene.placed if in_view(placed, view)]
        self.ledger.did("mesh", len(seen))
        self.ledger.skip("mesh: out of view", len(scene.placed) - len(seen))
        return seen

    def _reflection(self, light: Light, seen: list[PlacedPrimitive], still: bool) -> Reflection:
        """The sky for the surfaces that mirror it."""
        glossy = any(not placed.primitive.material.matte for placed in seen)
        if light.is_none and self.skips.unlit:
            self.ledger.skip("reflection: in a closed room")
        elif glossy or not self.skips.reflection:
            slices = None if still else SLICES_A_FRAME
            self._filter.update(light.sky, slices, not self.skips.reflection)
        else:
            self.ledger.skip("reflection: nothing in view mirrors")
        filtered = self._filter.texture
        if filtered is None:
            # Something must be bound; nobody looks at it.
            return Reflection(light.sky.texture, light.sky.scale, self._reflectance)
        return Reflection(filtered, self._filter.scale, self._reflectance)

    def _targets_of(self, size: tuple[int, int]) -> Targets:
        if self._targets is None or self._targets.size != size:
            if self._targets is not None:
                rest(self._context)
                self._targets.release()
            self._targets = Targets(self._context, size)
        return self._targets


def _table_texture(context: Any) -> Any:
    """The table of shares, for linear look-up between its nodes."""
    table = reflectance_table()
    texture = context.texture(table.shape[1::-1], 3, table.tobytes(), dtype="f4")
    texture.filter = (context.LINEAR, context.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    return texture
