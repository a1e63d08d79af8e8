"""The scene manager: opens scenes, demands light and parts' messages, owns the `SceneState`."""

from dataclasses import replace
from types import MappingProxyType
from typing import Any

import msgspec

from vrut_lite import __version__
from vrut_lite.frame_part import FramePart, Heard
from vrut_lite.installed_parts import (
    PartsHeard,
    frame_parts,
    heard_by_parts,
    heard_with,
    heard_without,
    part_reach_m,
)
from vrut_lite.kernel.messages import ClockMoved, Demand, Derived, SlotChanged
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.ground import NO_DISC, SetGround
from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.picture import Resize, SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene, SceneNeeds, SceneOpened
from vrut_lite.messages.section import SectionChanged, section_of
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged, SkyPolarisationChanged
from vrut_lite.messages.sky_light import LIGHT, SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.messages.tolerance import SetTolerance, tolerance_of
from vrut_lite.messages.view_light import StillAsked, ViewLightChanged
from vrut_lite.place_time import second_of_day
from vrut_lite.scene.backend import SceneView
from vrut_lite.scene.loading import OpenScene
from vrut_lite.scene.needs import air_reach_m, polarises, visible_faces
from vrut_lite.scene.packing import packed
from vrut_lite.scene.scene_state import SceneState
from vrut_lite.scene.settings import SCENE, SceneSettings


class SceneManager(Module):
    """Owns the state of a `SceneView`; draws nothing itself.

    It demands light (the sky's cube map in `cube_size` texels, if given) and the messages of frame
    parts; those of the part that lights surfaces only with `lights_surfaces`.
    """

    manifest = Manifest(name=SCENE, title="Scene", version=__version__)
    settings_type = SceneSettings

    def __init__(
        self,
        link: Link,
        settings: Any,
        view: SceneView | None = None,
        cube_size: int | None = None,
        lights_surfaces: bool = True,
    ):
        super().__init__(link, settings)
        self._view = view or SceneView()
        self._animated: OpenScene | None = None
        self._time_s: float | None = None
        # The ground below the scene, also while it is not drawn.
        self._disc: GroundDisc | None = None
        self._lights_surfaces = lights_surfaces
        self._empty_slots: set[str] = set()
        self._polarised = False
        # The source of the background's shader that was compiled last.
        self._prepared = ""
        # Demanded messages of the parts that are switched on.
        self._demanded: dict[type[Derived], None] = {}
        self._change(tolerance=tolerance_of(link))
        self._follow_settings()
        for kind in (*LIGHT, SkyLightChanged):
            self.link.demand(kind, cube_size)
        self._want_parts()

    @property
    def state(self) -> SceneState:
        """The pending state of the view, of which some parts may be earlier than others."""
        return self._view.pending

    # --- scene and camera -------------------------------------------------

    @handles(LoadScene)
    def on_load(self, message: LoadScene) -> None:
        """Open the files and look through their own camera; a bad file leaves the old scene."""
        opened = OpenScene(
            message.path,
            placement=message.placement,
            beside=message.beside,
            camera=message.camera,
            luminaires=dict(message.luminaires),
            variant=message.variant,
            glazing=dict(message.glazing),
        )
        moves = opened.duration_s > 0.0
        time_s = self._animation_time_s() if moves else None
        scene = packed(opened.at(time_s))
        self._disc = scene.ground
        if (said := self.link.last(SetGround)) is not None and said.ground == NO_DISC:
            scene = msgspec.structs.replace(scene, ground=None)
        self._animated, self._time_s = opened if moves else None, time_s
        self._show(scene, moved_camera=None)

    def _show(self, scene: SceneOpened, moved_camera: MoveCamera | None) -> None:
        parts = heard_with(self.state.parts, scene)
        self._change(scene=scene, moved_camera=moved_camera, parts=parts)
        self._want_polarisation()
        self._cut()
        self.link.post(scene)
        self._look()

    @handles(SetGround)
    def on_ground(self, message: SetGround) -> None:
        """Take the ground disc away, or lay it again."""
        scene = self.state.scene
        if scene is None:
            return
        ground = self._disc if message.ground != NO_DISC else None
        if ground != scene.ground:
            self._show(msgspec.structs.replace(scene, ground=ground), self.state.moved_camera)

    @handles(ClockMoved)
    def on_clock(self, message: ClockMoved) -> None:
        """Move animations with the clock."""
        self._move()

    def _move(self) -> None:
        """Show the scene's animations at their present time, if it has changed."""
        if self._animated is None or self._animation_time_s() == self._time_s:
            return
        self._time_s = self._animation_time_s()
        posed = packed(self._animated.at(self._time_s))
        if self.state.scene is not None:
            # Moving objects change neither the framing nor the ground.
            ground, border_rgb = self.state.scene.ground, self.state.scene.border_rgb
            posed = msgspec.structs.replace(posed, ground=ground, border_rgb=border_rgb)
        # The scene's own camera may move by itself.
        looks_through = self.state.moved_camera is None and posed.camera is not None
        self._show(posed, moved_camera=None if looks_through else self.state.camera)

    def _animation_time_s(self) -> float | None:
        """The time of the animations; None at rest."""
        if self.settings.animation == "rest":
            return None
        if self.settings.animation == "time":
            return float(self.settings.animation_time_s)
        clock, place = self.link.last(ClockMoved), self.link.last(SetPlace)
        return 0.0 if clock is None else second_of_day(clock.instant, place)

    @handles(MoveCamera)
    def on_camera(self, message: MoveCamera) -> None:
        """Look from there instead of the scene's own or the framing camera."""
        self._view.look(moved_camera=message)
        self._look()

    @handles(Resize)
    def on_resize(self, message: Resize) -> None:
        """Draw pictures of this size."""
        self._view.look(size_px=(message.width_px, message.height_px))
        self._look()

    @handles(SetExposure)
    def on_exposure(self, message: SetExposure) -> None:
        """Set the exposure."""
        self._view.look(exposure=message)

    @handles(SetTolerance)
    def on_tolerance(self, message: SetTolerance) -> None:
        """Set the tolerance of frames."""
        self._change(tolerance=message.tolerance)

    @handles(SkyPolarisationChanged)
    def on_polarisation(self, message: SkyPolarisationChanged) -> None:
        """Show the polarisation of the clear sky."""
        self._change(polarisation=message)

    def _want_polarisation(self) -> None:
        """Demand the sky's polarisation for a polariser, and for smooth dielectrics."""
        scene = self.state.scene
        filtered = self.settings.polariser_deg is not None
        wanted = filtered or (scene is not None and polarises(scene.materials))
        if wanted == self._polarised:
            return
        self._polarised = wanted
        self.link.demand(SkyPolarisationChanged, None if wanted else 0)
        if not wanted:
            self._change(polarisation=None)

    def settings_changed(self, name: str) -> None:
        """Apply a changed setting to animations, picture or section."""
        if name.startswith("animation"):
            self._move()
        else:
            self._follow_settings()
            self._look()

    def _follow_settings(self) -> None:
        said = self.settings
        self._change(
            light_shafts=said.light_shafts, shows=said.shows, polariser_deg=said.polariser_deg
        )
        self._want_polarisation()
        self._cut()

    def _cut(self) -> None:
        said = self.settings
        scene, section = self.state.scene, None
        if scene is not None and said.section != "off":
            axis = "xyz".index(said.section)
            lower_m, upper_m = scene.lower_m[axis], scene.upper_m[axis]
            at_m = lower_m + said.section_at * (upper_m - lower_m)
            section = section_of(said.section, at_m, said.section_keeps)
        if section != self.state.section:
            self._view.look(section=section)
            normal, offset_m = section or (None, 0.0)
            self.link.post(SectionChanged(normal=normal, offset_m=offset_m))

    # --- its light and its parts --------------------------------------------------------

    @handles(BackgroundChanged)
    def on_background(self, message: BackgroundChanged) -> None:
        """Show this sky.

        Raises:
            UserError: its own shader does not compile; its cube map is shown.
        """
        self._take_light(background=message)
        # Only its first use compiles the shader, for which the message waits.
        if message.view is not None and message.view.source != self._prepared:
            self._prepared = message.view.source
            self._view.prepare()

    @handles(KeyLightChanged)
    def on_key_light(self, message: KeyLightChanged) -> None:
        """Set the light that casts shadows."""
        self._take_light(key_light=message)

    @handles(AmbientChanged)
    def on_ambient(self, message: AmbientChanged) -> None:
        """Set the irradiance of the clear sky."""
        self._take_light(ambient=message)

    def _take_light(self, **light: Any) -> None:
        self._view.pending = self.state.with_light(**light)

    @handles(SkyLightChanged)
    def on_sky_light(self, message: SkyLightChanged) -> None:
        """Light and reflect with the sky and its layers."""
        self._change(sky_light=message)

    @handles(*heard_by_parts())
    def on_part(self, message: Derived) -> None:
        """Pass it to the frame parts that hear it; the air's range may follow theirs."""
        self._take_parts(heard_with(self.state.parts, message))

    @handles(Demand)
    def on_demand(self, message: Demand) -> None:
        """Post the camera when a consumer demands light for that view."""
        if message.message == ViewLightChanged.__name__:
            self._ask_for_still()

    def _ask_for_still(self) -> None:
        camera = self.state.camera
        if camera is not None and self.link.wanted(ViewLightChanged) is not None:
            self.link.post(StillAsked(camera=camera, size_px=self.state.size_px))

    @handles(SlotChanged)
    def on_slot(self, message: SlotChanged) -> None:
        """Drop what an earlier holder of the slot posted for parts."""
        (self._empty_slots.discard if message.holder else self._empty_slots.add)(message.name)
        if message.name in frame_parts():
            self._look()

        def is_outdated(kind: type[Derived]) -> bool:
            return kind.slot == message.name and not (message.holder and self.link.last(kind))

        self._take_parts(heard_without(self.state.parts, is_outdated))

    def _take_parts(self, parts: PartsHeard) -> None:
        camera, before = self.state.camera, self.state.parts
        if parts is before:
            return
        self._change(parts=parts)
        if camera and part_reach_m(parts, camera) != part_reach_m(before, camera):
            self._look()

    def _change(self, **parts: Any) -> None:
        self._view.pending = replace(self.state, **parts)

    # --- needs of the view ---------------------------------------------------------------

    def _look(self) -> None:
        """Post the light and the reach of the air that this camera needs."""
        camera, aspect = self.state.camera, self.state.aspect
        if camera is None:
            return
        faces, sky_in_view = visible_faces(camera, aspect)
        has_scene = self.state.scene is not None
        self._want_parts()
        self.link.post(
            SceneNeeds(
                sky_in_view=sky_in_view,
                visible_faces=faces,
                receives_light=has_scene,
                air_reach_m=self._air_reach_m(camera, aspect),
                eye_height_m=camera.eye_m[1],
            )
        )
        self._ask_for_still()

    def _air_reach_m(self, camera: MoveCamera, aspect: float) -> float:
        scene = self.state.scene
        on = self.state.parts
        if scene is None or not any(frame_parts()[name].through_air for name in on):
            return 0.0
        ground_level_m = 0.0 if scene.ground is None else scene.ground.height_m
        reach_m = air_reach_m(camera, aspect, scene.lower_m, scene.upper_m, ground_level_m)
        return max(reach_m, part_reach_m(self.state.parts, camera))

    def _want_parts(self) -> None:
        """Switch frame parts on and off, and demand the messages of those that are on."""
        before, installed = self.state.parts, frame_parts()
        on = {name: part for name, part in installed.items() if self._is_on(name, part)}
        if on.keys() != before.keys():
            parts = {
                name: before[name] if name in before else self._heard(part)
                for name, part in on.items()
            }
            self._change(parts=MappingProxyType(parts))
        # In the order of the parts: a set's order differs between processes, and so would journals.
        kinds = [kind for part in on.values() for kind in part.hears if part.demands(kind)]
        demanded = dict.fromkeys(kinds)
        for kind in self._demanded:
            if kind not in demanded:
                self.link.demand(kind, 0)
        for kind in demanded:
            if kind not in self._demanded:
                self.link.demand(kind)
        self._demanded = demanded

    def _is_on(self, name: str, part: type[FramePart]) -> bool:
        has_scene = self.state.scene is not None
        if part.irradiance and not (has_scene and self._lights_surfaces):
            return False
        if part.switch:
            if has_scene and not getattr(self.settings, part.switch):
                self.counters.skip(f"{part.switch}: switched off")
                return False
            if not has_scene:
                return False
        return name not in self._empty_slots

    def _heard(self, part: type[FramePart]) -> Heard:
        """The latest messages of a part that is switched on."""
        heard: Heard = MappingProxyType({})
        for kind in part.hears:
            last = self.state.scene if kind is SceneOpened else self.link.last(kind)
            if last is not None and kind.slot not in self._empty_slots:
                heard = part.hear(heard, last)
        return heard
