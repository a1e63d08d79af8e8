"""The scene backend on pyrender and moderngl: uploads changes and draws on the GL thread."""

import logging
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import replace
from functools import partial
from time import perf_counter, sleep
from typing import Any, TypeVar

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.array import Array
from vrut_lite.frame_part import Hit
from vrut_lite.geometry.polarisation import polariser_axis
from vrut_lite.installed_parts import PartsHeard, extra_irradiance, irradiance_at, sun_share
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.camera import (
    MoveCamera,
    look_at,
    off_axis_perspective,
    perspective,
    pixel_rays,
)
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import BackgroundChanged, SkyPolarisationChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.pictures.picture import Picture
from vrut_lite.render.card_pictures import DrawnPicture
from vrut_lite.render.card_targets import LONGEST_S, no_answer
from vrut_lite.render.context_loss import ContextLostError
from vrut_lite.render.eye_pictures import EyesDrawn, HeadsetEye
from vrut_lite.render.frame import EyeInputs, Frame
from vrut_lite.render.frame_parts import PartFailed, warn_of_part
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.light import Light, PolarisedSky, SkyTexture
from vrut_lite.render.light_meter import Illuminance, illuminance
from vrut_lite.render.passes.view import View
from vrut_lite.render.picture_passes import Measure
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.rays import SceneRays
from vrut_lite.scene.backend import IsGivenUp
from vrut_lite.scene.scene_state import NO_PARTS, SceneState

T = TypeVar("T")
_NEAR_M, _NEAR_RADII = 0.02, 1e-3
# Time between two looks at a picture that a card draws.
_POLL_S = 3e-4
# A picture is begun again after so many resets, of which the last leads to a software renderer.
_MOST_RESETS = 3
_log = logging.getLogger(__name__)
_UNPOLARISED = np.zeros((2, 6, 1, 1, 3), np.float16)


class _LostPictureError(Exception):
    """The context of a picture that is being drawn was lost, and has been replaced."""


class PyrenderBackend:
    """A `SceneBackend`; GL work goes to the owner's thread. UserError without OpenGL.

    The counters count "upload" of a part of the state, and skips "upload: unchanged".
    """

    def __init__(self, owner: GlOwner, part_failed: PartFailed = warn_of_part):
        self._owner = owner
        self._part_failed = part_failed
        choices = owner.opened.device.choices
        # The GL thread creates it while the caller continues.
        self._made = owner.submit(lambda context: Frame(context, choices, part_failed))
        # The background last: only its shader may fail to compile.
        self._uploads: dict[str, Callable[[Any, Any], None]] = {
            "scene": self._upload_scene,
            "parts": self._upload_parts,
            "polarisation": self._upload_polarisation,
            "sky_light": self._upload_sky_light,
            "background": self._upload_background,
        }
        self._rays: tuple[SceneOpened, SceneRays] | None = None
        self._begin_empty()
        owner.on_reset(self._rebuild)

    def _begin_empty(self) -> None:
        """Nothing is uploaded."""
        # The uploaded parts; keeping a message keeps its GPU texture valid.
        nothing = {**dict.fromkeys(self._uploads), "parts": NO_PARTS}
        self._uploaded: dict[str, Any] = nothing
        self._scene: PyrenderScene | None = None
        self._sky_texture: Any = None
        self._own_cube = _OwnCube()
        # The sky with its layers, where it has any.
        self._summed_cube = _OwnCube()
        self._mirrored: SkyTexture | None = None
        # Q and U of the clear sky, and of the sky with its layers.
        self._polarised, self._mirrored_polarised = _OwnPolarisation(), _OwnPolarisation()

    def _rebuild(self, context: Any) -> None:
        """After a reset: a new frame, to which the next picture uploads all it needs."""
        self._begin_empty()
        made: Future[Frame] = Future()
        self._made = made
        choices = self._owner.opened.device.choices
        made.set_result(Frame(context, choices, self._part_failed))

    @property
    def _frame(self) -> Frame:
        return self._made.result()

    def begin(self, scene: SceneOpened) -> None:
        """Upload a scene while the caller continues, before its light is available."""
        self._owner.submit(lambda context: self._begin(context, scene))

    def prepare(self, state: SceneState) -> None:
        """Upload the parts of the state that have changed, by identity.

        Raises:
            UserError: the background's own shader does not compile; its cube map is drawn.
        """
        self._despite_resets(lambda: self._owner.call(lambda context: self._upload(context, state)))

    def draw(
        self, state: SceneState, still: bool = True, is_given_up: IsGivenUp | None = None
    ) -> Picture:
        """Draw a frame; again where the graphics driver was reset meanwhile.

        Raises:
            RuntimeError: scene, light or camera is still missing.
            GivenUp: `is_given_up()`, called repeatedly on the GL thread, returned true.
        """
        state.check_drawable()
        if state.shows_map:
            assert state.key_light is not None
            sun = msgspec.structs.replace(state.key_light, irradiance_rgb=(0.0, 0.0, 0.0))
            state = replace(state, key_light=sun)
        picture = self._despite_resets(lambda: self._drawn(state, still, is_given_up))
        if (reset := self._owner.untold_reset()) is not None:
            _log.warning(
                "the graphics driver failed: %s; %s shows the picture again after %.1f s",
                reset.why,
                reset.renderer,
                perf_counter() - reset.at_s,
            )
        return picture

    def _drawn(self, state: SceneState, still: bool, is_given_up: IsGivenUp | None) -> Picture:
        resets = self._owner.resets
        drawn = self._owner.call(lambda context: self._draw(context, state, still, is_given_up))
        if isinstance(drawn, Picture):
            return drawn

        def taken(_context: Any) -> Picture | None:
            if perf_counter() > end_s:
                raise no_answer()
            if self._owner.resets != resets:
                raise _LostPictureError("a picture was lost with its context")
            return drawn.taken(self._owner.call)

        # The GL thread does other work, such as modules' jobs, while the card draws.
        end_s = perf_counter() + LONGEST_S
        while (picture := self._owner.call(taken)) is None:
            sleep(_POLL_S)
        return picture

    def _despite_resets(self, work: Callable[[], T]) -> T:
        """Do work, and again in the context that took the place of a lost one."""
        for _ in range(_MOST_RESETS):
            with suppress(ContextLostError, _LostPictureError):
                return work()
        return work()

    def draw_eyes(self, state: SceneState, eyes: Sequence[HeadsetEye]) -> EyesDrawn:
        """Draw the scene for a headset's eyes, whose textures the card may still fill on return.

        On the GL thread only. The state's exposure holds for all eyes, its camera and size for
        none; nor have they glare, or values in false colours.

        Raises:
            RuntimeError: scene, light or camera is still missing.
        """
        state.check_drawable()
        context = self._owner.opened.context
        self._upload(context, state)
        scene = self._scene
        assert scene is not None
        scene.paint_ground(state.ground_albedo_rgb)
        inputs = []
        for eye in eyes:
            view = _view_of_eye(eye, scene.radius_m)
            own = replace(state, moved_camera=eye.camera, size_px=eye.size_px, shows="picture")
            inputs.append(EyeInputs(view, self._light(own, view), own, eye.texture))
        return self._frame.draw_eyes(scene, inputs)

    def illuminance(self, state: SceneState, point_m: ArrayLike, normal: ArrayLike) -> Illuminance:
        """Illuminance (lx) of a plane with this normal (3,) at a point (3,), world axes."""
        if state.key_light is None or state.sky_light is None or state.camera is None:
            raise RuntimeError("nothing to measure yet: no light or no scene")
        ambient = state.sky_light.ambient
        return illuminance(
            self._scene_rays(state),
            state.key_light,
            ambient,
            point_m,
            normal,
            partial(sun_share, state.parts),
            partial(extra_irradiance, state.parts, state.camera),
            partial(irradiance_at, state.parts, sky=ambient),
        )

    def surface_at_pixel(self, state: SceneState, x: int, y: int) -> Hit | None:
        """The surface in the middle of a pixel, None for the sky; y counts from the top."""
        if state.camera is None:
            raise RuntimeError("nothing to look at yet: no camera")
        ray, eye = pixel_rays(state.camera, state.size_px, x, y), np.array(state.camera.eye_m)
        if state.section is None:
            return self._scene_rays(state).first_hit(eye, ray)
        start_m, end_m = state.section.seen_part(eye, ray)
        if start_m == np.inf:
            return None
        hit = self._scene_rays(state).first_hit(eye + start_m * ray, ray)
        return None if hit is None or (hit.point_m - eye) @ ray > end_m else hit

    def _scene_rays(self, state: SceneState) -> SceneRays:
        if state.scene is None:
            raise RuntimeError("nothing to look at yet: no scene")
        if self._rays is None or self._rays[0] is not state.scene:
            self._rays = state.scene, SceneRays(state.scene)
        return self._rays[1]

    @property
    def counters(self) -> WorkCounters:
        """Counts of work that frames did and skipped."""
        return self._frame.counters

    def measure_passes(self, measure: Measure) -> None:
        """Enter `measure(name)` around each pass, on the GL thread."""
        self._frame.measure_passes(measure)

    def close(self) -> None:
        """Free the GL objects."""
        self._owner.call(lambda context: self._release())
        self._owner.forget(self._rebuild)

    def _release(self) -> None:
        self._frame.release()
        self._own_cube.release()
        self._summed_cube.release()
        self._polarised.release()
        self._mirrored_polarised.release()

    # --- on the GL thread ----------------------------------------------------------------

    def _upload(self, context: Any, state: SceneState) -> None:
        for name, upload in self._uploads.items():
            part = getattr(state, name)
            if part is self._uploaded[name]:
                self.counters.skip("upload: unchanged")
                continue
            # Recorded first, so that a failing shader is reported once and not with every frame.
            self._uploaded[name] = part
            self.counters.did("upload")
            upload(context, part)

    def _begin(self, context: Any, scene: SceneOpened) -> None:
        self._upload_scene(context, scene)
        assert self._scene is not None
        self._frame.begin(self._scene)
        # Recorded last: a failed upload is repeated with the picture, which reports the error.
        self._uploaded["scene"] = scene
        self.counters.did("upload")

    def _upload_scene(self, context: Any, scene: SceneOpened) -> None:
        # Its buffers reach the GPU with the next frame.
        self._scene = PyrenderScene(scene)
        # Its meshes are not yet cut into charts.
        self._uploaded["parts"] = None

    def _upload_parts(self, context: Any, heard: PartsHeard) -> None:
        charts = self._frame.show_parts(heard)
        if self._scene is not None:
            self._scene.lay_out(charts)

    def _upload_background(self, context: Any, background: BackgroundChanged) -> None:
        """Upload the cube map, or use the texture that is on the GPU already."""
        cube = background.cube
        if isinstance(cube, GpuTexture):
            texture = cube.opaque
        else:
            texture = self._own_cube.holding(context, cube)
        texture.filter = (context.LINEAR, context.LINEAR)
        self._sky_texture = texture
        self._frame.show_view(background.view)

    def _upload_polarisation(self, context: Any, message: SkyPolarisationChanged | None) -> None:
        """Upload Q and U of the clear sky."""
        self._polarised.show(context, message)

    def _upload_sky_light(self, context: Any, light: SkyLightChanged | None) -> None:
        """Upload the sky with its layers, for reflections; a clear sky is the background."""
        if light is None or not light.layers:
            self._mirrored = None
            return
        radiance = light.radiance
        assert radiance is not None
        self._mirrored_polarised.show(context, light.polarisation)
        seen = light.background
        if isinstance(seen.cube, GpuTexture):
            # Made by the card, as seen from the ground.
            self._mirrored = SkyTexture(seen.cube.opaque, seen.radiance_scale, seen)
        else:
            texture = self._summed_cube.holding(context, radiance.cube)
            self._mirrored = SkyTexture(texture, radiance.radiance_scale, radiance)
        self._mirrored.texture.filter = (context.LINEAR, context.LINEAR)

    def _draw(
        self, context: Any, state: SceneState, still: bool, is_given_up: IsGivenUp | None
    ) -> Picture | DrawnPicture:
        self._upload(context, state)
        scene, camera = self._scene, state.camera
        assert scene is not None
        assert camera is not None
        scene.paint_ground(state.ground_albedo_rgb)
        view = _view(camera, scene.radius_m, state.aspect)
        light = self._light(state, view)
        return self._frame.draw(scene, view, light, state, still, is_given_up)

    def _light(self, state: SceneState, view: View) -> Light:
        background, sun, ambient = state.background, state.key_light, state.ambient
        assert background is not None
        assert sun is not None
        assert ambient is not None
        assert state.sky_light is not None
        sky = SkyTexture(
            self._sky_texture,
            background.radiance_scale,
            background,
            background.ground_through_air,
        )
        clear = ambient.irradiance_sh_rgb.values
        summed = state.sky_light.ambient.irradiance_sh_rgb.values
        mirrored = self._mirrored or sky
        radius_rad = sun.even_radius_rad
        polarised = self._polarised.shown
        behind = self._mirrored_polarised.shown if self._mirrored else polarised
        polariser = None
        if state.polariser_deg is not None and polarised is not None:
            polariser = polariser_axis(view.rotation, state.polariser_deg)
        return Light(
            sun.direction, sun.irradiance_rgb, summed, clear, sky, mirrored, radius_rad,
            polarised, behind, polariser,
        )  # fmt: skip


class _OwnCube:
    """A texture for cube maps that come as arrays."""

    def __init__(self) -> None:
        self._texture: Any = None

    def holding(self, context: Any, cube: Array) -> Any:
        """The texture, with these texels (6, n, n, 3)."""
        size = cube.shape[1]
        if self._texture is None or self._texture.size != (size, size):
            self.release()
            self._texture = context.texture_cube((size, size), 4, dtype="f2")
        rgba = np.ones((size, size, 4), np.float16)
        for index, face in enumerate(cube.values):
            # By channel: numpy copies rows of three slowly.
            for channel in range(3):
                rgba[..., channel] = face[..., channel]
            self._texture.write(index, rgba.tobytes())
        return self._texture

    def release(self) -> None:
        """Free the texture."""
        if self._texture is not None:
            self._texture.release()
        self._texture = None


class _OwnPolarisation:
    """Textures for Q and U of a sky."""

    def __init__(self) -> None:
        self._cubes = _OwnCube(), _OwnCube()
        self.shown: PolarisedSky | None = None

    def show(self, context: Any, message: SkyPolarisationChanged | None) -> None:
        """Upload the message; a sky that knows none is unpolarised."""
        self.shown = None
        if message is None:
            return
        cubes = _UNPOLARISED if message.cube is None else message.cube.values
        q, u = (
            own.holding(context, Array(cube)) for own, cube in zip(self._cubes, cubes, strict=True)
        )
        q.filter = u.filter = (context.LINEAR, context.LINEAR)
        self.shown = PolarisedSky(q, u, message.radiance_scale)

    def release(self) -> None:
        """Free the textures."""
        for cube in self._cubes:
            cube.release()


def _near_m(scene_radius_m: float) -> float:
    """Distance of the near plane: 2 cm, less in a tiny scene."""
    return min(_NEAR_M, _NEAR_RADII * scene_radius_m)


def _view_of_eye(eye: HeadsetEye, scene_radius_m: float) -> View:
    """An eye's matrices."""
    rotation = np.eye(4)
    rotation[:3, :3] = eye.rotation.T
    return View(
        eye_m=eye.eye_m,
        rotation=rotation,
        projection=off_axis_perspective(eye.tangents, _near_m(scene_radius_m)),
    )


def _view(camera: MoveCamera, scene_radius_m: float, aspect: float) -> View:
    """The camera's matrices."""
    eye_m = np.asarray(camera.eye_m, dtype=float)
    return View(
        eye_m=eye_m,
        rotation=look_at(np.zeros(3), np.asarray(camera.target_m) - eye_m),
        projection=perspective(
            camera.vertical_field_of_view_rad,
            aspect,
            near_m=_near_m(scene_radius_m),
        ),
    )
