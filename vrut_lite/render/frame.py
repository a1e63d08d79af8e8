"""One frame on the GL thread: shadow map, reflections, meshes, sky, resolve, tone map.

Radiance stays linear and in physical units until the tone map.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.air import AirVolume
from vrut_lite.daylight.clouds import CloudLayer
from vrut_lite.daylight.lamps import SceneLamps
from vrut_lite.daylight.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.daylight.night import MoonDiscChanged, StarsChanged
from vrut_lite.daylight.scene_state import FrameSkips, SceneState, Shown
from vrut_lite.daylight.sky import ViewShader
from vrut_lite.geometry.reflection import reflectance_table
from vrut_lite.geometry.sheen import sheen_table
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.pictures import exposure
from vrut_lite.pictures.picture import Picture
from vrut_lite.render.air import AirOnGpu, AirSurroundings, FrameAir
from vrut_lite.render.backdrop import Backdrop
from vrut_lite.render.clouds.frame_clouds import CLOUD_SHADOWS, FrameClouds
from vrut_lite.render.culling import in_view, part_of
from vrut_lite.render.device import Choices
from vrut_lite.render.gl_owner import bind_permanent_framebuffer
from vrut_lite.render.lamps import LampsOnGpu
from vrut_lite.render.light import Light, Reflection, Shadow, Shadows
from vrut_lite.render.moving_targets import MovingTargets
from vrut_lite.render.passes.draw_order import in_order
from vrut_lite.render.passes.mesh_renderer import MeshRenderer
from vrut_lite.render.passes.night_pass import NightPass
from vrut_lite.render.passes.reuse import Reuse
from vrut_lite.render.passes.shadow_map import ShadowMaps
from vrut_lite.render.passes.shadows_on_mesh import SHADOW_UNIT, shadow_from_eye
from vrut_lite.render.passes.sky_pass import SkyPass, SunDisc
from vrut_lite.render.passes.specular_filter import SpecularFilter, reflection_change
from vrut_lite.render.passes.tone_pass import TonePass
from vrut_lite.render.passes.triangles import PlacedSide, Run
from vrut_lite.render.passes.view import View
from vrut_lite.render.pieces import Patience, Piece, Pieces
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene
from vrut_lite.render.reversed_depth import reversed_depth
from vrut_lite.render.shader_files import Defines
from vrut_lite.render.size_cache import SizeCache
from vrut_lite.render.staleness import sky_level
from vrut_lite.render.surface_light import SurfaceLightOnGpu
from vrut_lite.render.surface_terms import needs_backdrop
from vrut_lite.render.targets import Targets
from vrut_lite.render.value_light import in_false_colours
from vrut_lite.scene.backend import IsGivenUp

_CUBE_MAP_SEAMLESS = 0x884F
# Slices of the filtered sky (of 24) in a frame that must not wait for them: a sixth of its time
# where slices are largest.
SLICES_A_FRAME = 2

# A finished still is the mean of pictures that are shifted so, right and up, in pixels. With one
# sample a pixel no hidden one is shaded: eight such pictures take half as long as four of four
# samples, and come nearer to 64.
_SHIFTS_PX = tuple(
    ((2 * i - 7) / 16, (2 * j - 7) / 16) for i, j in enumerate((2, 5, 0, 7, 3, 6, 1, 4))
)

Measure = Callable[[str], AbstractContextManager[Any]]


class Frame:
    """GL objects of the frame; made and used on the GL thread only.

    `measure` is entered around each pass, with its name; `ledger` counts what was done and
    what was skipped.
    """

    def __init__(self, context: Any, choices: Choices):
        self._context = context
        self._choices = choices
        self.ledger = Ledger()
        self._skips = FrameSkips()
        self.measure: Measure = lambda name: nullcontext()
        context.enable_direct(_CUBE_MAP_SEAMLESS)
        self._meshes = MeshRenderer()
        self._sky = SkyPass(context)
        self._night = NightPass(context, self.ledger)
        self._tone = TonePass(context)
        self._shadow = ShadowMaps(context, self.ledger)
        self._filter = SpecularFilter(context, self.ledger)
        self._air = AirOnGpu(context)
        self._patience = Patience(self.ledger)
        self._mesh_pieces = Pieces(self._patience)
        self._surface_light = SurfaceLightOnGpu(context)
        self._lamps = LampsOnGpu(context, self.ledger)
        self._backdrop = Backdrop(context)
        self._clouds = FrameClouds(context, self.ledger, self._patience)
        self._reflectance = _table_texture(context)
        self._targets = SizeCache(context, lambda size: Targets(context, size))
        self._single = SizeCache(context, lambda size: Targets(context, size, samples=1))
        self._moving = SizeCache(context, lambda size: MovingTargets(context, size))
        # The last finished picture, whose radiance its targets still hold.
        self._finished: tuple[SceneState, Targets, NDArray[np.float32]] | None = None
        self._reuse = Reuse(context)

    def show_view(self, view: ViewShader | None) -> None:
        """Set the background's shader; with None or after an error the cube map is drawn (see
        `SkyPass`)."""
        self._sky.show_view(view)

    def show_air(self, volume: AirVolume | None) -> None:
        """Draw this air from the next frame on; None where none is visible."""
        self._air.show(volume)

    def show_light_map(self, laid: LightMapLaid | None) -> None:
        """Look surfaces up in this map from the next light on; None where there is no map."""
        self._surface_light.lay_out(laid)

    def show_surface_light(self, light: SurfaceLightChanged | None) -> None:
        """Light surfaces by this from the next frame on; None: by the open sky."""
        self._surface_light.show(light)

    def show_lamps(self, lamps: SceneLamps | None) -> None:
        """Light surfaces by these too from the next frame on."""
        self._lamps.show(lamps)

    def show_clouds(self, layers: tuple[CloudLayer, ...]) -> None:
        """Draw these clouds from the next frame on, from low to high."""
        self._clouds.show(layers)

    def show_stars(self, stars: StarsChanged | None) -> None:
        """Draw these stars from the next frame on."""
        self._night.show_stars(stars)

    def show_moon(self, moon: MoonDiscChanged | None) -> None:
        """Draw this moon from the next frame on."""
        self._night.show_moon(moon)

    def draw(
        self,
        scene: PyrenderScene,
        view: View,
        light: Light,
        state: SceneState,
        still: bool = True,
        is_given_up: IsGivenUp | None = None,
    ) -> Picture:
        """Draw a scene, the sky and the sun, with the state's size, exposure and skips.

        A `still` is complete; otherwise slow work is done in slices.

        Raises:
            GivenUp: `is_given_up()` returned true; it is called repeatedly.
        """
        if still and (known := self._known(state)) is not None:
            self.ledger.skip("picture: the same but for its exposure")
            self._finished = state, *known
            return self._exposed(*known, view, state)
        # Its targets may be drawn into.
        self._finished = None
        self._patience.is_given_up = is_given_up
        self._skips = state.skips
        self._filter.change_seen = reflection_change(state.tolerance)
        assert state.key_light is not None
        # The moon has a face: it is drawn apart.
        of_moon = state.key_light.body == "moon" and self._night.has_moon
        disc = SunDisc(
            (0.0, 0.0, 0.0) if of_moon else light.sun_irradiance,
            state.key_light.angular_radius_rad,
            state.key_light.limb_darkening_rgb,
            state.moon_disc,
        )
        self._meshes.update(scene)
        self._meshes.section = state.section
        seen = self._seen(scene, view)
        self._surface_light.show_view(state.light_of_view if still else None)
        with self.measure("reflection"):
            reflection = self._reflection(light, seen, still)
        quick = not still and state.shows == "picture" and self._choices.takes_over
        with self.measure("shadow"):
            always = not self._skips.shadow
            finished = still and state.light_of_view is not None
            if finished:
                shafts = state.light_shafts and self._air.volume is not None
                shadows = self._shadow.of_still(
                    self._meshes, scene, seen, light, view, state.size_px, always, shafts
                )
            else:
                shadows = self._shadow.update(self._meshes, scene, light, view, always, quick)
        with self.measure("lamps"):
            self._lamps.update(self._meshes, scene, view.eye_m, always)
        air = self._air_before(scene, view, light, shadows.scene, state.light_shafts)
        with self.measure("cloud shadows"):
            air = self._clouds.prepare(scene, view, light, air, state.size_px, state.key_light)
        if quick:
            return self._draw_moving(
                scene, seen, view, light, disc, shadows, reflection, air, state
            )
        shifts = _SHIFTS_PX if finished else ((0.0, 0.0),)
        of_size = self._single if finished else self._targets
        targets = of_size.get(state.size_px)
        self._meshes.read_finer(scene, np.log2(len(shifts)) / 2.0)
        self.ledger.did("picture", len(shifts))
        self._meshes.picture_count = len(shifts)
        resolved: NDArray[np.float32] | None = None
        for sample, shift_px in enumerate(shifts):
            self._patience.check()
            self._meshes.picture_number = sample
            targets.multisampled.use()
            targets.multisampled.clear()
            shifted = view if len(shifts) == 1 else view.shifted(shift_px, targets.size)
            with reversed_depth():
                self._draw_seen(
                    targets,
                    scene,
                    seen,
                    shifted,
                    light,
                    disc,
                    shadows,
                    reflection,
                    air,
                    still,
                    state.shows,
                    sample,
                )
            with self.measure("resolve"):
                self._context.copy_framebuffer(targets.resolved, targets.multisampled)
            read = targets.read_resolved()
            resolved = read if resolved is None else resolved + read
        assert resolved is not None
        self._meshes.picture_number, self._meshes.picture_count = 0, 1
        if len(shifts) > 1:
            resolved /= np.float32(len(shifts))
        if state.shows != "picture":
            return in_false_colours(resolved, state.shows)
        radiance = np.ascontiguousarray(resolved[..., :3])
        if len(shifts) > 1:
            with self.measure("copy and meter"):
                targets.write_resolved(resolved)
        if still:
            self._finished = state, targets, radiance
        return self._exposed(targets, radiance, view, state)

    def _known(self, state: SceneState) -> tuple[Targets, NDArray[np.float32]] | None:
        """Targets and radiance of the last finished picture, if only the exposure is another."""
        if self._finished is None:
            return None
        drawn, targets, radiance = self._finished
        is_it = drawn.exposure != state.exposure and state.shares_all_but(drawn, "exposure")
        return (targets, radiance) if is_it and not targets.is_released else None

    def _exposed(
        self, targets: Targets, radiance: NDArray[np.float32], view: View, state: SceneState
    ) -> Picture:
        """The picture whose radiance (h, w, 3) the targets hold."""
        with self.measure("copy and meter"):
            ev100 = exposure.ev100_of(state.exposure, radiance)
        with self.measure("tone map"):
            pixel_rad = view.pixel_rad(targets.size)
            self._tone.draw(targets.radiance, targets.display, ev100, state.exposure, pixel_rad)
        return Picture(radiance, targets.read_display(), ev100, pixel_rad=pixel_rad)

    def release(self) -> None:
        """Free everything, on the GL thread."""
        bind_permanent_framebuffer(self._context)
        self._meshes.delete()
        for thing in (self._sky, self._night, self._tone, self._shadow, self._filter, self._air,
                      self._reflectance, self._surface_light, self._lamps, self._clouds,
                      self._backdrop, self._targets, self._single, self._moving,
                      self._reuse):  # fmt: skip
            thing.release()

    def _draw_seen(
        self,
        targets: Targets,
        scene: PyrenderScene,
        seen: list[PlacedPrimitive],
        view: View,
        light: Light,
        disc: SunDisc,
        shadows: Shadows,
        reflection: Reflection,
        air: FrameAir,
        still: bool,
        shows: Shown,
        sample: int,
    ) -> None:
        """Solid surfaces, the sky in what they leave, clouds, and what shows all these.

        Of values in false colours solid surfaces alone.
        """
        defines: Defines = (*air.mesh, *self._lamps.defines)
        if shows != "picture":
            shadows_of_clouds = tuple(set(air.mesh) & {CLOUD_SHADOWS})
            of_light = (*shadows_of_clouds, *self._lamps.defines)
            defines = ("ILLUMINANCE", *(of_light if shows == "illuminance" else ("MAP_VALUES",)))

        def draw_meshes(placed: list[PlacedPrimitive], blended: bool = False) -> None:
            def draw(piece: Piece) -> None:
                within = placed
                if self._skips.meshes and piece[2:] != targets.size:
                    part = part_of(view, targets.size, piece)
                    within = [p for p in placed if in_view(p, part)]
                shown: dict[PlacedSide, tuple[Run, ...]] = {}
                if not blended:
                    if targets.samples_a_pixel > 1:
                        shown = self._meshes.draw_depth_first(within, view)
                    else:
                        self._meshes.draw_depth_of_solid(within, view)
                    # Where two are equally near the last one shows: the nearer mesh.
                    within = within[::-1]
                self._meshes.draw(
                    scene,
                    within,
                    view,
                    light,
                    shadows,
                    reflection,
                    self._surface_light,
                    defines,
                    blended,
                    shown,
                )

            if placed:
                self._mesh_pieces.draw(targets.size, draw)

        solid, blended = in_order(seen, view.eye_m)
        if shows != "picture":
            with self.measure("mesh"):
                draw_meshes(solid)
            return
        if not self._skips.sky:
            self._draw_sky(targets, view, light, disc, air)
        with self.measure("mesh"):
            draw_meshes(solid)
        if self._skips.sky:
            self._draw_sky(targets, view, light, disc, air)
        with self.measure("night"):
            self._night.draw(targets.size, view)
        with self.measure("clouds"):
            self._clouds.draw(scene, targets, view, air, still, sample)
        if any(needs_backdrop(placed.primitive.material) for placed in blended):
            with self.measure("backdrop"):
                self._backdrop.take(targets.multisampled, targets.size)
            self.ledger.did("backdrop")
        with self.measure("blended mesh"):
            draw_meshes(blended, blended=True)

    def _draw_moving(
        self,
        scene: PyrenderScene,
        seen: list[PlacedPrimitive],
        view: View,
        light: Light,
        disc: SunDisc,
        shadows: Shadows,
        reflection: Reflection,
        air: FrameAir,
        state: SceneState,
    ) -> Picture:
        """A picture of one sample a pixel, of which much is taken over from the one before."""
        targets = self._moving.get(state.size_px)
        solid, blended = in_order(seen, view.eye_m)
        self._meshes.read_finer(scene, 0.0)
        self.ledger.did("picture")
        defines: Defines = (*air.mesh, *self._lamps.defines)

        def draw_meshes(placed: list[PlacedPrimitive], blended: bool) -> None:
            self._meshes.draw(
                scene, placed, view, light, shadows, reflection, self._surface_light, defines,
                blended,
            )  # fmt: skip

        # For the viewport.
        targets.multisampled.use()
        targets.front.bind()
        with reversed_depth():
            with self.measure("depth"):
                self._meshes.draw_depth_of_solid(solid, view)
            with self.measure("reuse"):
                self._reuse.begin(targets, view, state, reflection.texture)
            with self.measure("mesh"):
                draw_meshes(solid[::-1], blended=False)
            with self.measure("sky"):
                self._sky.draw_remaining(targets.size, view, light, disc, air.sky)
            if blended or self._clouds.are_drawn:
                targets.draw_over()
                with self.measure("clouds"):
                    self._clouds.draw(scene, targets, view, air, still=False)
                with self.measure("blended mesh"):
                    if any(needs_backdrop(placed.primitive.material) for placed in blended):
                        self._backdrop.take(targets.multisampled, targets.size)
                    draw_meshes(blended, blended=True)
        with self.measure("copy and meter"):
            radiance = targets.read_radiance()
            ev100 = exposure.ev100_of(state.exposure, radiance)
        with self.measure("tone map"):
            pixel_rad = view.pixel_rad(targets.size)
            self._tone.draw(targets.radiance, targets.toned, ev100, state.exposure, pixel_rad)
        with self.measure("edges"):
            display = targets.read_display()
        return Picture(radiance, display, ev100, pixel_rad=pixel_rad)

    def _air_before(
        self, scene: PyrenderScene, view: View, light: Light, shadow: Shadow | None, shafts: bool
    ) -> FrameAir:
        """Bind the air of this frame; returns the shaders' defines."""
        if self._air.volume is None:
            self.ledger.skip("air: none to be seen")
            return FrameAir()
        shafts = shafts and any(light.sun_irradiance)
        around = AirSurroundings(
            eye_altitude_m=float(view.eye_m[1]),
            ground_level_m=scene.ground_level_m,
            ground_is_bare=not light.sky.ground_through_air,
            shadow_from_eye=np.eye(4) if shadow is None else shadow_from_eye(shadow, view),
        )
        self._air.bind(around)
        if shafts:
            assert shadow is not None
            shadow.texture.use(location=SHADOW_UNIT)
            self.ledger.did("light shafts")
        self.ledger.did("air")
        return FrameAir.of(around, shafts)

    def _draw_sky(
        self, targets: Targets, view: View, light: Light, disc: SunDisc, air: FrameAir
    ) -> None:
        with self.measure("sky"):
            counted = self._sky.draw(targets.size, view, light, disc, self._skips.sky, air.sky)
        drawn = targets.samples if counted is None else counted
        self.ledger.did("sky sample", drawn)
        self.ledger.skip("sky sample: covered", targets.samples - drawn)

    def _seen(self, scene: PyrenderScene, view: View) -> list[PlacedPrimitive]:
        """Meshes that may be in the picture."""
        if not self._skips.meshes:
            seen = scene.placed
        else:
            seen = [placed for placed in scene.placed if in_view(placed, view)]
        self.ledger.did("mesh", len(seen))
        self.ledger.skip("mesh: out of view", len(scene.placed) - len(seen))
        return seen

    def _reflection(self, light: Light, seen: list[PlacedPrimitive], still: bool) -> Reflection:
        """The sky for the surfaces that mirror it."""
        glossy = [placed for placed in seen if not placed.primitive.material.matte]
        mirrors = self._surface_light.upload_mirrors(seen)
        if mirrors:
            self.ledger.did("mirror", mirrors)
        else:
            self.ledger.skip("mirror: none in view")
        if glossy and self._skips.unlit and not any(map(self._surface_light.sees_sky, glossy)):
            self.ledger.skip("reflection: no sky reaches what is seen")
        elif glossy or not self._skips.reflection:
            slices = None if still else SLICES_A_FRAME
            always = not self._skips.reflection
            self._filter.update(light.mirrored, slices, always, sky_level(light))
        else:
            self.ledger.skip("reflection: nothing in view mirrors")
        filtered = self._filter.texture
        if filtered is None:
            # A texture must be bound; no shader reads it.
            return Reflection(light.mirrored.texture, light.mirrored.scale, self._reflectance)
        return Reflection(filtered, self._filter.scale, self._reflectance)


def _table_texture(context: Any) -> Any:
    """The tables of shares and of fibres, for linear look-up between their nodes."""
    table = np.dstack([reflectance_table(), sheen_table()])
    texture = context.texture(table.shape[1::-1], 4, table.tobytes(), dtype="f4")
    texture.filter = (context.LINEAR, context.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    return texture
