"""The scene backend on pyrender: keeps what it was told, and draws it on the GL thread."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.array import Array
from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.clouds import CloudLayer, CloudsChanged
from vrut_lite.daylight.picture import SetExposure
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.gpu_texture import GpuTexture
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.render.frame import Frame, Measure
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.light import Light, Sky
from vrut_lite.render.light_meter import Illuminance, illuminance, surface_at
from vrut_lite.render.mesh_renderer import View
from vrut_lite.render.patience import IsGivenUp
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.rays import Hit, SceneRays
from vrut_lite.render.skips import FrameSkips
from vrut_lite.render.sky_pass import SunDisc
from vrut_lite.scene.backend import Picture
from vrut_lite.scene.camera import look_at, perspective
from vrut_lite.scene.ground_disc import GroundDisc
from vrut_lite.scene.loading import LoadedScene

_NEAR_M, _NEAR_RADII = 0.02, 1e-3


@dataclass
class _Told:
    """What the scene manager has said so far."""

    scene: PyrenderScene | None = None
    background: BackgroundChanged | None = None
    sun: KeyLightChanged | None = None
    ambient: AmbientChanged | None = None
    camera: MoveCamera | None = None
    sheltered: bool = False
    light_shafts: bool = False
    exposure: SetExposure = field(default_factory=SetExposure)
    size: tuple[int, int] = (960, 540)


class PyrenderBackend:
    """A `SceneBackend`; calls may come from any one thread, GL work goes to the owner's."""

    def __init__(self, owner: GlOwner):
        self._owner = owner
        self._told = _Told()
        self._frame: Frame = owner.call(Frame)
        self._sky_texture: Any = None
        self._uploaded: Any = None
        self._loaded: tuple[LoadedScene, GroundDisc | None] | None = None
        self._rays: SceneRays | None = None
        self._clouds: CloudLayer | None = None

    def show_scene(self, scene: LoadedScene, ground: GroundDisc | None) -> None:
        """Build the pyrender scene; its buffers reach the GPU with the next frame."""
        self._told.scene = PyrenderScene(scene, ground)
        self._loaded, self._rays = (scene, ground), None

    def set_background(self, background: BackgroundChanged) -> None:
        """Upload the cube map, or take the texture that has never left the GPU as it is.

        Raises:
            UserError: the background's own shader does not compile; its cube map is shown.
        """
        self._told.background = background
        self._owner.call(lambda context: self._show_sky(context, background.cube))
        self._owner.call(lambda context: self._frame.show_view(background.view))

    def set_sun_light(self, light: KeyLightChanged) -> None:
        """Light with this sun."""
        self._told.sun = light

    def set_ambient(self, ambient: AmbientChanged) -> None:
        """Light with this sky."""
        self._told.ambient = ambient

    def set_air(self, air: AirChanged) -> None:
        """Upload the air, if there is any to be seen."""
        self._owner.call(lambda context: self._frame.show_air(air.volume))

    def set_clouds(self, clouds: CloudsChanged) -> None:
        """Upload the clouds, if there are any."""
        self._clouds = clouds.layer
        self._owner.call(lambda context: self._frame.show_clouds(clouds.layer))

    def set_light_shafts(self, light_shafts: bool) -> None:
        """Let the scene shade the air, or not."""
        self._told.light_shafts = light_shafts

    def set_ground_albedo(self, albedo_rgb: NDArray[np.float64]) -> None:
        """Paint the ground disc."""
        if self._told.scene is not None:
            self._told.scene.paint_ground(albedo_rgb)

    def set_camera(self, camera: MoveCamera) -> None:
        """Look from here."""
        self._told.camera = camera

    def set_sheltered(self, sheltered: bool) -> None:
        """Light with nothing, or with sun and sky again."""
        self._told.sheltered = sheltered

    def set_exposure(self, exposure: SetExposure) -> None:
        """Expose like this."""
        self._told.exposure = exposure

    def set_size(self, width_px: int, height_px: int) -> None:
        """Draw pictures of this size."""
        self._told.size = (width_px, height_px)

    @property
    def ledger(self) -> Ledger:
        """What frames did, and what they skipped."""
        return self._frame.ledger

    @property
    def skips(self) -> FrameSkips:
        """What frames may skip."""
        return self._frame.skips

    @skips.setter
    def skips(self, skips: FrameSkips) -> None:
        self._frame.skips = skips

    def set_tolerance(self, tolerance: float) -> None:
        """How far radiance may be off in frames, as a share."""
        self._frame.set_tolerance(tolerance)

    def measure_passes(self, measure: Measure) -> None:
        """Enter `measure(name)` around each pass, on the GL thread."""
        self._frame.measure = measure

    def draw(self, still: bool = True, is_given_up: IsGivenUp | None = None) -> Picture:
        """Draw a frame; RuntimeError names what is still missing.

        Raises:
            GivenUp: `is_given_up()`, asked on the GL thread again and again, said so.
        """
        return self._owner.call(lambda context: self._draw(still, is_given_up))

    def surface_at(self, x: int, y: int) -> Hit | None:
        """The surface in the middle of a pixel, None if it is the sky; y counts from the top."""
        if self._told.camera is None:
            raise RuntimeError("nothing to look at yet: no camera")
        return surface_at(self._scene_rays(), self._told.camera, self._told.size, x, y)

    def illuminance(self, point_m: ArrayLike, normal: ArrayLike) -> Illuminance:
        """Lux on a plane with this normal (3,) at a point (3,), world axes."""
        told = self._told
        if told.sun is None or told.ambient is None:
            raise RuntimeError("nothing to measure yet: no light")
        rays = self._scene_rays()
        return illuminance(rays, told.sun, told.ambient, point_m, normal, self._clouds)

    def _scene_rays(self) -> SceneRays:
        if self._loaded is None:
            raise RuntimeError("nothing to look at yet: no scene")
        if self._rays is None:
            self._rays = SceneRays(*self._loaded)
        return self._rays

    def close(self) -> None:
        """Free the GL objects."""
        self._owner.call(lambda context: self._release())

    def _release(self) -> None:
        self._frame.release()
        self._release_uploaded()

    def _release_uploaded(self) -> None:
        if self._uploaded is not None:
            self._uploaded.release()
        self._uploaded = self._sky_texture = None

    def _show_sky(self, context: Any, cube: Array | GpuTexture) -> None:
        # A texture of the GPU's stays ours for as long as the message that is kept holds it.
        texture = cube.opaque if isinstance(cube, GpuTexture) else self._upload(context, cube)
        texture.filter = (context.LINEAR, context.LINEAR)
        self._sky_texture = texture

    def _upload(self, context: Any, cube: Array) -> Any:
        size = cube.shape[1]
        if self._uploaded is None or self._uploaded.size != (size, size):
            self._release_uploaded()
            self._uploaded = context.texture_cube((size, size), 4, dtype="f2")
        rgba = np.ones((size, size, 4), np.float16)
        for index, face in enumerate(cube.values):
            rgba[..., :3] = face
            self._uploaded.write(index, rgba.tobytes())
        return self._uploaded

    def _draw(self, still: bool, is_given_up: IsGivenUp | None) -> Picture:
        told = self._told
        missing = [name for name, value in vars(told).items() if value is None]
        if told.scene is None or told.camera is None or told.sun is None or missing:
            raise RuntimeError(f"nothing to draw yet: no {', no '.join(missing)}")
        light = self._light(told.sun)
        return self._frame.draw(
            scene=told.scene,
            view=_view(told.camera, told.scene, told.size),
            light=light,
            disc=SunDisc(
                light.sun_irradiance, told.sun.angular_radius_rad, told.sun.limb_darkening_rgb
            ),
            wish=told.exposure,
            size=told.size,
            still=still,
            light_shafts=told.light_shafts,
            is_given_up=is_given_up,
        )

    def _light(self, sun: KeyLightChanged) -> Light:
        told = self._told
        assert told.background is not None
        assert told.ambient is not None
        harmonics = told.ambient.irradiance_sh_rgb.values
        sky = Sky(
            self._sky_texture,
            told.background.radiance_scale,
            told.background,
            told.background.ground_through_air,
        )
        if told.sheltered:
            return Light(sun.direction, (0.0, 0.0, 0.0), 0.0 * harmonics, sky._replace(scale=0.0))
        return Light(sun.direction, sun.irradiance_rgb, harmonics, sky)


def _view(camera: MoveCamera, scene: PyrenderScene, size: tuple[int, int]) -> View:
    """The camera's matrices; its near plane is 2 cm away, nearer in a tiny scene."""
    eye_m = np.asarray(camera.eye_m, dtype=float)
    return View(
        eye_m=eye_m,
        rotation=look_at(np.zeros(3), np.asarray(camera.target_m) - eye_m),
        projection=perspective(
            camera.vertical_field_of_view_rad,
            size[0] / size[1],
            near_m=min(_NEAR_M, _NEAR_RADII * scene.radius_m),
        ),
    )
