"""The scene backend on pyrender: keeps what it was told, and draws it on the GL thread."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.shadow import light_matrix
from vrut_lite.scene.backend import Picture
from vrut_lite.scene.camera import look_at, perspective
from vrut_lite.scene.ground_disc import GroundDisc
from vrut_lite.scene.loading import LoadedScene


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

    def show_scene(self, scene: LoadedScene, ground: GroundDisc | None) -> None:
        """Build the pyrender scene; its buffers reach the GPU with the next frame."""
        self._told.scene = PyrenderScene(scene, ground)

    def set_background(self, background: BackgroundChanged) -> None:
        """Upload the cube map, with the mip levels that blurred reflections look up."""
        self._told.background = background
        self._owner.call(lambda context: self._upload_sky(context, background))

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
        if self._sky_texture is not None:
            self._sky_texture.release()
            self._sky_texture = None

    def _upload_sky(self, context: Any, background: BackgroundChanged) -> None:
        faces = background.cube.values
        size = faces.shape[1]
        if self._sky_texture is None or self._sky_texture.size != (size, size):
            if self._sky_texture is not None:
                self._sky_texture.release()
            self._sky_texture = context.texture_cube((size, size), 4, dtype="f2")
        rgba = np.ones((size, size, 4), np.float16)
        for index, face in enumerate(faces):
            rgba[..., :3] = face
            self._sky_texture.write(index, rgba.tobytes())
        self._sky_texture.build_mipmaps()
        self._sky_texture.filter = (context.LINEAR_MIPMAP_LINEAR, context.LINEAR)

    def _draw(self, context: Any) -> Picture:
        told = self._told
        missing = [name for name, value in vars(told).items() if value is None]
        if told.scene is None or told.camera is None or told.sun is None or missing:
            raise RuntimeError(f"nothing to draw yet: no {', no '.join(missing)}")
        width, height = told.size
        near_m, far_m = _depth_range(told.scene, told.camera)
        return self._frame.draw(
            scene=told.scene.scene,
            casters=told.scene.casters,
            view=look_at(told.camera.eye_m, told.camera.target_m),
            projection=perspective(
                told.camera.vertical_field_of_view_rad, width / height, near_m, far_m
            ),
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
            shadow_matrix=light_matrix(sun.direction, scene.centre_m, scene.radius_m),
            shadow_texel_m=2 * scene.radius_m / SHADOW_SIZE,
        )


def _depth_range(scene: PyrenderScene, camera: MoveCamera) -> tuple[float, float]:
    """Near and far plane in metres: around the scene, and out to the rim of its ground."""
    distance = float(np.linalg.norm(np.asarray(camera.eye_m) - scene.centre_m))
    far = distance + 1.05 * scene.radius_m
    if scene.ground is not None:
        far = max(far, distance + 1.05 * scene.ground.radius_m)
    near = max(distance - 1.05 * scene.radius_m, 0.01 * scene.radius_m)
    # A camera near the ground sees it closer than the scene's sphere.
    if scene.ground is not None:
        near = min(near, max(0.2 * abs(camera.eye_m[1] - scene.ground.height_m), 1e-5 * far))
    return max(near, 1e-6 * far), far
