"""The scene manager: opens scenes, frames them, and tells a backend how they are lit."""

from typing import Annotated, Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite import __version__
from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.clouds import CloudsChanged
from vrut_lite.daylight.picture import Resize, SetExposure
from vrut_lite.daylight.scene import LoadScene, SceneLoaded, SceneNeeds
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.messages import Demand, Derived, SlotChanged
from vrut_lite.kernel.module import Link, Manifest, Module, handles
from vrut_lite.numeric_types import Vector
from vrut_lite.scene.backend import SceneBackend
from vrut_lite.scene.camera import camera_from_pose, frame_bounds
from vrut_lite.scene.darkness import no_ambient, no_background, no_sun
from vrut_lite.scene.ground import has_own_ground
from vrut_lite.scene.ground_disc import disc_under
from vrut_lite.scene.loading import LoadedScene, load_scene
from vrut_lite.scene.needs import air_reach_m, cloud_reach_m, visible_faces
from vrut_lite.scene.shelter import Shelter

NAME = "scene"
LIGHT: tuple[type[Derived], ...] = (BackgroundChanged, KeyLightChanged, AmbientChanged)
_UP = np.array([0.0, 1.0, 0.0])
# Darker than this, what ground and light say of each other is rounding.
_DARKEST_IRRADIANCE = 1e-12
_NO_AIR = AirChanged(volume=None, source=NAME)
_NO_CLOUDS = CloudsChanged(layer=None, source=NAME)


class SceneSettings(msgspec.Struct, frozen=True):
    """What is drawn besides the scene itself."""

    air: Annotated[bool, msgspec.Meta(description="Whether the scene is seen through the air.")] = (
        True
    )
    light_shafts: Annotated[
        bool, msgspec.Meta(description="Whether the scene's shadows are seen in the air.")
    ] = False


class SceneManager(Module):
    """Hands scene, light and camera to a `SceneBackend`; knows nothing of how it draws."""

    manifest = Manifest(name=NAME, title="Scene", version=__version__)
    settings_type = SceneSettings

    def __init__(self, link: Link, settings: Any, backend: SceneBackend):
        super().__init__(link, settings)
        self._backend = backend
        self._scene: LoadedScene | None = None
        self._shelter: Shelter | None = None
        self._sheltered = False
        self._wanted_light: dict[type[Derived], Demand] = {}
        self._ground_level_m = 0.0
        self._wants_air = False
        self._wants_clouds = False
        self._clouds = _NO_CLOUDS
        self._camera: MoveCamera | None = None
        self._size = Resize(width_px=960, height_px=540)
        self._background: BackgroundChanged | None = None
        self._sun: KeyLightChanged | None = None
        self._ambient: AmbientChanged | None = None

    @handles(LoadScene)
    def on_load(self, message: LoadScene) -> None:
        """Open the file and look through its own camera; the old scene stays until it is read."""
        scene = load_scene(message.path)
        ground = None if has_own_ground(scene) else disc_under(scene.lower_m, scene.upper_m)
        self._backend.show_scene(scene, ground)
        self._scene, self._camera, self._shelter = scene, None, None
        if ground is None:
            self.ledger.skip("search for closed rooms: the scene is a land")
        else:
            self._shelter = Shelter(scene)
        self._ground_level_m = 0.0 if ground is None else ground.height_m
        self.link.post(
            SceneLoaded(
                path=message.path,
                lower_m=_vector(scene.lower_m),
                upper_m=_vector(scene.upper_m),
                triangles=scene.triangles,
            )
        )
        self._paint_ground()
        self._show_camera()

    @handles(MoveCamera)
    def on_camera(self, message: MoveCamera) -> None:
        """Look from there instead of the scene's own or the framing camera."""
        self._camera = message
        self._show_camera()

    @handles(Resize)
    def on_resize(self, message: Resize) -> None:
        """Draw pictures of this size."""
        self._size = message
        self._backend.set_size(message.width_px, message.height_px)
        self._show_camera()

    @handles(Demand)
    def on_demand(self, message: Demand) -> None:
        """Remember what light is wanted for the picture, to ask for it again after a room."""
        for kind in LIGHT:
            if message.consumer == NAME and message.message == kind.__name__ and message.size != 0:
                self._wanted_light[kind] = message

    @handles(SetExposure)
    def on_exposure(self, message: SetExposure) -> None:
        """Expose like this."""
        self._backend.set_exposure(message)

    @handles(BackgroundChanged)
    def on_background(self, message: BackgroundChanged) -> None:
        """Show this sky."""
        self._background = message
        self._backend.set_background(message)
        self._paint_ground()

    @handles(KeyLightChanged)
    def on_sun_light(self, message: KeyLightChanged) -> None:
        """Light with this sun."""
        self._sun = message
        self._backend.set_sun_light(message)
        self._paint_ground()

    @handles(AmbientChanged)
    def on_ambient(self, message: AmbientChanged) -> None:
        """Light with this sky."""
        self._ambient = message
        self._backend.set_ambient(message)
        self._paint_ground()

    @handles(AirChanged)
    def on_air(self, message: AirChanged) -> None:
        """Show the scene through this air."""
        if self._wants_air:
            self._backend.set_air(message)

    @handles(CloudsChanged)
    def on_clouds(self, message: CloudsChanged) -> None:
        """Show these clouds; the air before them reaches farther than the scene's."""
        if not self._wants_clouds:
            return
        others = _altitudes(message) != _altitudes(self._clouds)
        self._clouds = message
        self._backend.set_clouds(message)
        if others:
            self._show_camera()

    @handles(SlotChanged)
    def on_slot(self, message: SlotChanged) -> None:
        """Keep no air of another sky than the one that is shown."""
        if message.name == AirChanged.slot and self.link.last(AirChanged) is None:
            self._backend.set_air(_NO_AIR)

    def settings_changed(self, name: str) -> None:
        """Switch air or light shafts."""
        if name == "light_shafts":
            self._backend.set_light_shafts(self.settings.light_shafts)
        self._show_camera()

    def _paint_ground(self) -> None:
        """Give the ground the albedo that makes its radiance that of the sky's lower half."""
        if self._scene and self._background and self._sun and self._ambient:
            albedo = ground_albedo(self._background, self._sun, self._ambient)
            self._backend.set_ground_albedo(albedo)

    def _show_camera(self) -> None:
        camera = self._camera or self._own_camera()
        if camera is None:
            return
        self._backend.set_camera(camera)
        self._go_inside(self._shelter is not None and self._shelter.holds(camera.eye_m))
        aspect = self._size.width_px / self._size.height_px
        faces, sky_in_view = visible_faces(camera, aspect)
        outside = not self._sheltered
        self._want_air(outside and self._scene is not None)
        self._want_clouds(outside and self._scene is not None)
        self.link.post(
            SceneNeeds(
                sky_in_view=sky_in_view and outside,
                visible_faces=faces if outside else (),
                receives_light=self._scene is not None and outside,
                air_reach_m=self._air_reach_m(camera, aspect),
                eye_height_m=camera.eye_m[1],
            )
        )

    def _air_reach_m(self, camera: MoveCamera, aspect: float) -> float:
        if self._scene is None or not self._wants_air:
            return 0.0
        bounds = self._scene.lower_m, self._scene.upper_m
        scene_m = air_reach_m(camera, aspect, *bounds, self._ground_level_m)
        layer = self._clouds.layer
        return scene_m if layer is None else max(scene_m, cloud_reach_m(camera, layer))

    def _want_clouds(self, useful: bool) -> None:
        """Ask for clouds outside; show none inside."""
        if useful == self._wants_clouds:
            return
        self._wants_clouds = useful
        self.link.demand(CloudsChanged, None if useful else 0)
        self._clouds = (self.link.last(CloudsChanged) if useful else None) or _NO_CLOUDS
        if self._clouds.layer is not None or not useful:
            self._backend.set_clouds(self._clouds)

    def _want_air(self, useful: bool) -> None:
        """Ask for air where it is seen, unless it is switched off; show none where it is not."""
        if useful and not self.settings.air:
            self.ledger.skip("air: switched off")
        wanted = useful and self.settings.air
        if wanted == self._wants_air:
            return
        self._wants_air = wanted
        self.link.demand(AirChanged, None if wanted else 0)
        told = self.link.last(AirChanged) if wanted else None
        self._backend.set_air(told or _NO_AIR)

    def _go_inside(self, sheltered: bool) -> None:
        """In a closed room ask nobody for light; outside, ask again."""
        if sheltered == self._sheltered:
            return
        self._sheltered = sheltered
        self._backend.set_sheltered(sheltered)
        for kind, wanted in self._wanted_light.items():
            size = 0 if sheltered else wanted.size
            self.link.demand(kind, size, wanted.encoding)
        if sheltered:
            self.ledger.skip("light: in a closed room", len(self._wanted_light))
            self._darken()

    def _darken(self) -> None:
        """Stand in for light that never came: a frame is to be drawn without it."""
        if self._background is None:
            self._backend.set_background(no_background())
        if self._sun is None:
            self._backend.set_sun_light(no_sun())
        if self._ambient is None:
            self._backend.set_ambient(no_ambient())

    def _own_camera(self) -> MoveCamera | None:
        """The camera that the scene brings, or one that frames it."""
        if self._scene is None:
            return None
        own = self._scene.camera
        if own is not None:
            return camera_from_pose(own.world_from_camera, own.vertical_field_of_view_rad)
        aspect = self._size.width_px / self._size.height_px
        return frame_bounds(self._scene.lower_m, self._scene.upper_m, aspect)


def ground_albedo(
    background: BackgroundChanged, sun: KeyLightChanged, ambient: AmbientChanged
) -> NDArray[np.float64]:
    """Albedo (3,) of the ground that a sky was computed with: pi L / E at the nadir.

    Taken from the messages themselves, so that it holds for whichever module made them and
    the ground disc meets the sky's lower half without an edge.
    """
    radiance = np.asarray(background.ground_radiance_rgb)
    direct = np.asarray(sun.irradiance_rgb) * max(0.0, sun.direction[1])
    irradiance = evaluate_irradiance(ambient.irradiance_sh_rgb.values, _UP) + direct
    return np.clip(np.pi * radiance / np.maximum(irradiance, _DARKEST_IRRADIANCE), 0.0, 1.0)


def _altitudes(clouds: CloudsChanged) -> tuple[float, float] | None:
    layer = clouds.layer
    return None if layer is None else (layer.base_m, layer.thickness_m)


def _vector(values: NDArray) -> Vector:
    return (float(values[0]), float(values[1]), float(values[2]))
