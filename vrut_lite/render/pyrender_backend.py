"""The scene backend on pyrender: keeps what it was told, and draws it on the GL thread."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.kernel.array import Array
from vrut_lite.kernel.gpu_texture import GpuTexture
from vrut_lite.kernel.messages import (
    AmbientChanged,
    BackgroundChanged,
    MoveCamera,
    SetExposure,
    SunLightChanged,
)
from vrut_lite.render.frame import SHADOW_SIZE, Frame, SunDisc
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.light import Light
from vrut_lite.render.mesh_renderer import View
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.shadow import light_matrix
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
    sun: SunLightChanged | None = None
    ambient: AmbientChanged | None = None
    camera: MoveCamera | None = None
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

    def show_scene(self, scene: LoadedScene, ground: GroundDisc | None) -> None:
        """Build the pyrender scene; its buffers reach the GPU with the next frame."""
        self._told.scene = PyrenderScene(scene, ground)

    def set_background(self, background: BackgroundChanged) -> None:
        """Upload the cube map, or take the texture that has never left the GPU as it is.

        Both get the mip levels that blurred reflections look up.
        """
        self._told.background = background
        self._owner.call(lambda context: self._show_sky(context, background.cube))

    def set_sun_light(self, light: SunLightChanged) -> None:
        """Light with this sun."""
        self._told.sun = light

    def set_ambient(self, ambient: AmbientChanged) -> None:
        """Light with this sky."""
        self._told.ambient = ambient

    def set_ground_albedo(self, albedo_rgb: NDArray[np.float64]) -> None:
        """Paint the ground disc."""
        if self._told.scene is not None:
            self._told.scene.paint_ground(albedo_rgb)

    def set_camera(self, camera: MoveCamera) -> None:
        """Look from here."""
        self._told.camera = camera

    def set_exposure(self, exposure: SetExposure) -> None:
        """Expose like this."""
        self._told.exposure = exposure

    def set_size(self, width_px: int, height_px: int) -> None:
        """Draw pictures of this size."""
        self._told.size = (width_px, height_px)

    def draw(self) -> Picture:
        """Draw a frame; RuntimeError names what is still missing."""
        return self._owner.call(self._draw)

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
        texture.build_mipmaps()
        texture.filter = (context.LINEAR_MIPMAP_LINEAR, context.LINEAR)
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

    def _draw(self, context: Any) -> Picture:
        told = self._told
        missing = [name for name, value in vars(told).items() if value is None]
        if told.scene is None or told.camera is None or told.sun is None or missing:
            raise RuntimeError(f"nothing to draw yet: no {', no '.join(missing)}")
        return self._frame.draw(
            scene=told.scene,
            view=_view(told.camera, told.scene, told.size),
            light=self._light(told.scene, told.sun),
            disc=SunDisc(
                told.sun.irradiance_rgb, told.sun.angular_radius_rad, told.sun.limb_darkening_rgb
            ),
            wish=told.exposure,
            size=told.size,
        )

    def _light(self, scene: PyrenderScene, sun: SunLightChanged) -> Light:
        told = self._told
        assert told.background is not None
        assert told.ambient is not None
        return Light(
            sun_direction=sun.direction,
            sun_irradiance=sun.irradiance_rgb,
            irradiance_sh=told.ambient.irradiance_sh_rgb.values,
            sky_texture=self._sky_texture,
            sky_scale=told.background.radiance_scale,
            shadow_texture=self._frame.shadow_texture,
            shadow_matrix=light_matrix(sun.direction, scene.radius_m),
            shadow_texel_m=2 * scene.radius_m / SHADOW_SIZE,
        )


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
