"""One frame on the GL thread: shadow map, reflection and parts, then a still or a moving picture.

Radiance stays linear and in physical units until the tone map.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

import numpy as np

from vrut_lite.errors import GivenUp
from vrut_lite.frame_part import MeshChart, PartFrame, PartShadow
from vrut_lite.geometry.reflection import reflectance_table
from vrut_lite.geometry.sheen import sheen_table
from vrut_lite.installed_parts import PartsHeard
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.night import MoonDiscChanged
from vrut_lite.messages.sky import ViewShader, mean_level
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.pictures.picture import Picture
from vrut_lite.render.card_pictures import CardPictures, DrawnPicture
from vrut_lite.render.context_loss import loss
from vrut_lite.render.culling import has_glow, in_view
from vrut_lite.render.device import Choices
from vrut_lite.render.eye_pictures import EyePictures, EyesDrawn
from vrut_lite.render.frame_parts import PartFailed
from vrut_lite.render.gl_owner import bind_permanent_framebuffer
from vrut_lite.render.light import Light, Reflection, Shadows
from vrut_lite.render.passes.caster_renderer import SceneCasters
from vrut_lite.render.passes.shadow_map import SHADOW_SIZE, ShadowMaps, quick_size
from vrut_lite.render.passes.shadows_on_mesh import shadow_from_eye
from vrut_lite.render.passes.sky_pass import VisibleSun
from vrut_lite.render.passes.specular_filter import SpecularFilter, reflection_change
from vrut_lite.render.passes.view import View
from vrut_lite.render.picture_passes import FrameInputs, Measure, PicturePasses
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene
from vrut_lite.render.software.moving_picture import MovingPictures
from vrut_lite.render.still_picture import StillPictures
from vrut_lite.scene.backend import IsGivenUp
from vrut_lite.scene.scene_state import FrameSkips, SceneState

T = TypeVar("T")
_CUBE_MAP_SEAMLESS = 0x884F
# Slices of the filtered sky (of 24) in a frame that must not wait for them: a sixth of its time
# where slices are largest.
SLICES_A_FRAME = 2


class EyeInputs(NamedTuple):
    """Inputs of one eye of a frame: the state has its camera and size."""

    view: View
    light: Light
    state: SceneState
    texture: int


class _SharedLight(NamedTuple):
    """Inputs that all views of a frame share: meshes visible in any, reflected sky, and shadows.

    `in_air`: whether shadows may be visible in the air; `shafts`: whether all of them are.
    """

    seen: list[PlacedPrimitive]
    reflection: Reflection
    shadows: Shadows
    in_air: bool
    shafts: bool


class Frame:
    """GL objects of the frame; made and used on the GL thread only.

    `counters` counts done and skipped work.
    """

    def __init__(self, context: Any, choices: Choices, part_failed: PartFailed):
        self._context = context
        self._choices = choices
        self.counters = WorkCounters()
        context.enable_direct(_CUBE_MAP_SEAMLESS)
        self._passes = PicturePasses.made(context, self.counters, part_failed)
        self._stills = StillPictures(self._passes, several_samples=not choices.takes_over)
        self._moving: MovingPictures | CardPictures
        if choices.takes_over:
            self._moving = MovingPictures(self._passes)
        else:
            self._moving = CardPictures(self._passes, self._stills.draw_once)
        # Made with a headset's first frame.
        self._eyes: EyePictures | None = None
        self._shadow = ShadowMaps(context, self.counters)
        self._filter = SpecularFilter(context, self.counters, compares=choices.takes_over)
        self._casters: SceneCasters | None = None
        self._reflectance = _table_texture(context)

    def measure_passes(self, measure: Measure) -> None:
        """Enter this around each pass, with its name."""
        self._passes.measure = measure

    def begin(self, scene: PyrenderScene) -> None:
        """Upload a scene's meshes, materials and textures before their first frame."""
        self._passes.meshes.update(scene)

    def show_view(self, view: ViewShader | None) -> None:
        """Set the background's shader; with None or after an error the cube map is drawn (see
        `SkyPass`)."""
        self._passes.sky.show_view(view)

    def show_parts(self, heard: PartsHeard) -> Sequence[MeshChart | None] | None:
        """Let frame parts draw these messages from the next frame on.

        Returns the charts of the scene's parts, where they are cut up for it.
        """
        self._passes.parts.show(heard)
        return self._passes.parts.charts

    def draw(
        self,
        scene: PyrenderScene,
        view: View,
        light: Light,
        state: SceneState,
        still: bool = True,
        is_given_up: IsGivenUp | None = None,
    ) -> Picture | DrawnPicture:
        """Draw a scene, the sky and the sun, with the state's size, exposure and skips.

        A `still` is complete; otherwise slow work is done in slices, and a card may still be
        drawing when this returns.

        Raises:
            GivenUp: `is_given_up()` returned true; it is called repeatedly.
        """
        if still and (known := self._stills.exposed_again(state, view)) is not None:
            return known
        self._stills.forget()
        return self._without_broken_glsl(
            scene, lambda: self._drawn(scene, view, light, state, still, is_given_up)
        )

    def draw_eyes(self, scene: PyrenderScene, eyes: Sequence[EyeInputs]) -> EyesDrawn:
        """Draw the same scene for several eyes, into a texture of each; returns before the card is
        done.

        Their states differ in camera and size alone.
        """
        return self._without_broken_glsl(scene, lambda: self._drawn_eyes(scene, eyes))

    def _without_broken_glsl(self, scene: PyrenderScene, draw: Callable[[], T]) -> T:
        """Draw, and again without parts whose GLSL does not compile."""
        try:
            return draw()
        except GivenUp:
            raise
        except Exception as error:
            # A shader with a part's GLSL that does not compile shows nothing at all, nor does a
            # lost context.
            if loss(error) or not self._passes.parts.drop_broken_glsl(scene.placed):
                raise
            return draw()

    def _drawn(
        self,
        scene: PyrenderScene,
        view: View,
        light: Light,
        state: SceneState,
        still: bool,
        is_given_up: IsGivenUp | None,
    ) -> Picture | DrawnPicture:
        self._passes.patience.is_given_up = is_given_up
        quick = not still and state.shows == "picture" and self._choices.takes_over
        finished = still and not state.shows_map and state.has_finished_light
        shared = self._shared(scene, [view], light, state, still, finished, quick)
        shot = self._shot(scene, view, light, state, still, shared)
        if isinstance(self._moving, CardPictures):
            by_card = not still and self._moving.can_draw(shot)
            return self._moving.draw(shot) if by_card else self._stills.draw(shot, still, finished)
        return self._moving.draw(shot) if quick else self._stills.draw(shot, still, finished)

    def _drawn_eyes(self, scene: PyrenderScene, eyes: Sequence[EyeInputs]) -> EyesDrawn:
        self._passes.patience.is_given_up = None
        if self._eyes is None:
            several = not self._choices.takes_over
            self._eyes = EyePictures(self._passes, self._stills.draw_once, several)
        views, (_, light, state, _) = [eye.view for eye in eyes], eyes[0]
        quick = self._choices.takes_over
        shared = self._shared(scene, views, light, state, False, False, quick)
        return self._eyes.draw(
            # A part prepares an eye after the one before was drawn.
            (
                self._shot(scene, eye.view, eye.light, eye.state, False, shared, number == 0)
                for number, eye in enumerate(eyes)
            ),
            [eye.texture for eye in eyes],
        )

    def _shared(
        self,
        scene: PyrenderScene,
        views: Sequence[View],
        light: Light,
        state: SceneState,
        still: bool,
        finished: bool,
        quick: bool,
    ) -> _SharedLight:
        """Upload the scene, and draw what does not depend on the view; shadows near the first."""
        passes = self._passes
        passes.meshes.update(scene)
        passes.meshes.section = state.section
        seen = self._seen(scene, views, state.skips)
        with passes.measure("reflection"):
            reflection = self._reflection(light, seen, still, state)
        with passes.measure("shadow"):
            always = not state.skips.shadow
            has_sunlit_air = passes.parts.fill_air and any(light.sun_irradiance)
            shafts = has_sunlit_air and state.light_shafts
            glow = any(has_glow(view, light.sun_direction) for view in views)
            in_air = shafts or (has_sunlit_air and glow)
            if finished:
                shadows = self._shadow.of_still(
                    passes.meshes, scene, seen, light, views[0], state.size_px, always, in_air
                )
            else:
                size = quick_size(state.size_px[0]) if quick else SHADOW_SIZE
                shadows = self._shadow.update(passes.meshes, scene, light, views[0], always, size)
        if always or self._casters is None or self._casters.scene is not scene:
            self._casters = SceneCasters(passes.meshes, scene)
        return _SharedLight(seen, reflection, shadows, in_air, shafts)

    def _shot(
        self,
        scene: PyrenderScene,
        view: View,
        light: Light,
        state: SceneState,
        still: bool,
        shared: _SharedLight,
        is_first: bool = True,
    ) -> FrameInputs:
        """The inputs of a view's picture, for which parts have prepared."""
        assert state.key_light is not None
        assert self._casters is not None
        seen, reflection, shadows, in_air, shafts = shared
        shadow = None
        if in_air:
            assert shadows.scene is not None
            shadow = PartShadow(shadows.scene.texture, shadow_from_eye(shadows.scene, view))
        parts = _part_frame(scene, view, seen, light, shadow, shafts, state, still, self._casters)
        with self._passes.measure("parts before surfaces"):
            parts = replace(parts, is_first_view=is_first)
            defines = self._passes.parts.prepare(parts)
        parts = replace(parts, air=defines.air)
        disc = self._disc(light, state.key_light, state.shown(MoonDiscChanged))
        return FrameInputs(
            scene, seen, view, light, disc, shadows, reflection, defines, parts, state
        )

    def release(self) -> None:
        """Free everything, on the GL thread."""
        bind_permanent_framebuffer(self._context)
        if self._eyes is not None:
            self._eyes.release()
        for thing in (self._passes, self._stills, self._moving, self._shadow, self._filter,
                      self._reflectance):  # fmt: skip
            thing.release()

    def _disc(self, light: Light, key: KeyLightChanged, moon: MoonDiscChanged | None) -> VisibleSun:
        # The moon's disc has a texture and is drawn separately.
        of_moon = key.body == "moon" and moon is not None
        sun = (0.0, 0.0, 0.0) if of_moon else light.sun_irradiance
        return VisibleSun(sun, key.angular_radius_rad, key.limb_darkening_rgb, moon)

    def _seen(
        self, scene: PyrenderScene, views: Sequence[View], skips: FrameSkips
    ) -> list[PlacedPrimitive]:
        """Meshes that may be visible in any of the views."""
        seen = scene.placed
        if skips.meshes:
            seen = [each for each in seen if any(in_view(each, view) for view in views)]
        self.counters.did("mesh", len(seen))
        self.counters.skip("mesh: out of view", len(scene.placed) - len(seen))
        return seen

    def _reflection(
        self, light: Light, seen: list[PlacedPrimitive], still: bool, state: SceneState
    ) -> Reflection:
        """The sky for reflections."""
        skips = state.skips
        self._filter.change_seen = reflection_change(state.tolerance)
        glossy = [placed for placed in seen if not placed.primitive.material.matte]
        if glossy and skips.unlit and not any(map(self._passes.parts.sees_sky, glossy)):
            self.counters.skip("reflection: no sky reaches what is seen")
        elif glossy or not skips.reflection:
            slices = None if still else SLICES_A_FRAME
            always = not skips.reflection
            self._filter.update(light.mirrored, slices, always, mean_level(light.irradiance_sh))
        else:
            self.counters.skip("reflection: nothing in view mirrors")
        filtered = self._filter.texture
        if filtered is None:
            # A texture must be bound; no shader reads it.
            return Reflection(light.mirrored.texture, light.mirrored.scale, self._reflectance)
        return Reflection(filtered, self._filter.scale, self._reflectance)


def _part_frame(
    scene: PyrenderScene,
    view: View,
    seen: list[PlacedPrimitive],
    light: Light,
    shadow: PartShadow | None,
    light_shafts: bool,
    state: SceneState,
    still: bool,
    casters: SceneCasters,
) -> PartFrame:
    assert state.camera is not None
    assert state.key_light is not None
    assert state.ambient is not None
    assert state.sky_light is not None
    return PartFrame(
        view=view,
        camera=state.camera,
        shows=state.shows,
        seen=seen,
        size_px=state.size_px,
        is_still=still,
        highest_m=float(scene.centre_m[1] + scene.radius_m),
        ground_level_m=scene.ground_level_m,
        key_light=state.key_light,
        clear_sky=state.ambient,
        whole_sky=state.sky_light.ambient,
        ground_is_bare=not light.sky.ground_through_air,
        casters=casters,
        shadow=shadow,
        light_shafts=light_shafts,
    )


def _table_texture(context: Any) -> Any:
    """Texture of the reflectance table, with the sheen table as fourth channel; linear filter."""
    table = np.dstack([reflectance_table(), sheen_table()])
    texture = context.texture(table.shape[1::-1], 4, table.tobytes(), dtype="f4")
    texture.filter = (context.LINEAR, context.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    return texture
