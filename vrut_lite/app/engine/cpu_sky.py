"""The window without OpenGL: the sky alone, drawn on the CPU from its cube map.

Scenes are opened and light is computed; meshes are not drawn.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.app.engine.stage import GlStage, Stage
from vrut_lite.app.engine.window_jobs import WindowJobs
from vrut_lite.array import Array
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.errors import UserError
from vrut_lite.frame_part import Hit
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.camera import pixel_rays
from vrut_lite.pictures.display import developed
from vrut_lite.pictures.picture import Picture
from vrut_lite.render.device import Device
from vrut_lite.render.light_meter import Illuminance
from vrut_lite.scene.backend import IsGivenUp, SceneView
from vrut_lite.scene.manager import SceneManager
from vrut_lite.scene.scene_state import SceneState

_CUBE_SIZE = 128
# A sky is smooth: more pixels would show no more.
_MOST_PIXELS = 320 * 240


class CpuSkyBackend:
    """A `SceneBackend` that draws the background and the sun's disc, and no scene."""

    def prepare(self, state: SceneState) -> None:
        """Do nothing: no background's own shader runs here."""

    def draw(
        self, state: SceneState, still: bool = True, is_given_up: IsGivenUp | None = None
    ) -> Picture:
        """Draw the visible sky, with at most `_MOST_PIXELS` pixels."""
        state.check_drawable()
        width, height = state.size_px
        step = max(1.0, float(np.sqrt(width * height / _MOST_PIXELS)))
        radiance = self._radiance(state, (round(width / step), round(height / step)))
        assert state.camera is not None
        pixel_rad = state.camera.pixel_rad(len(radiance))
        return developed(radiance, state.exposure, pixel_rad, state.white_card)

    def _radiance(self, state: SceneState, size_px: tuple[int, int]) -> NDArray[np.float32]:
        camera, light = state.camera, state.sky_light
        assert camera is not None
        assert light is not None
        background, sun = light.background, light.key_light
        irradiance = background.seen_sun_irradiance_rgb or sun.irradiance_rgb
        assert isinstance(background.cube, Array)
        directions = pixel_rays(camera, size_px, *np.meshgrid(*map(np.arange, size_px)))
        cube = decode_float16(background.cube.values, background.radiance_scale)
        radiance = sample_sky(cube, directions)
        cosine = directions @ np.asarray(sun.direction)
        solid_angle = 2.0 * np.pi * (1.0 - np.cos(sun.angular_radius_rad))
        inside = (cosine >= np.cos(sun.angular_radius_rad)) & (directions[..., 1] > 0.0)
        radiance[inside] += np.asarray(irradiance) / solid_angle
        return radiance.astype(np.float32)


class CpuSkyStage:
    """A kernel with its modules and a scene manager; no OpenGL anywhere."""

    def __init__(self, reason: str):
        self.kernel: Kernel
        self.kernel, failures = daylight_kernel(WindowJobs())
        self.failures = [*failures, f"the sky alone is drawn, on the CPU: {reason}"]
        self._backend = CpuSkyBackend()
        self._view = SceneView(self.kernel, self._backend)
        self.kernel.add_module(
            SceneManager, view=self._view, cube_size=_CUBE_SIZE, lights_surfaces=False
        )
        self.renderer = f"CPU, sky alone ({reason})"
        self.device: Device | None = None
        self.pass_seconds: dict[str, float] = {}
        self.frame_counters = WorkCounters()

    def measure_next(self) -> None:
        """Nothing: there are no passes."""

    @property
    def state(self) -> SceneState:
        """The state of the last whole revision."""
        return self._view.state

    @property
    def revision(self) -> int:
        """The number of that revision."""
        return self._view.revision

    def draw(self, state: SceneState, still: bool, is_given_up: IsGivenUp | None = None) -> Picture:
        """Draw a state; `is_given_up` is not asked, since this is quick."""
        return self._backend.draw(state, still)

    def light_at_pixel(self, x: int, y: int) -> Illuminance | None:
        """None: this stage draws no surfaces."""
        return None

    def surface_at_pixel(self, x: int, y: int) -> Hit | None:
        """None: this stage draws no surfaces."""
        return None

    def close(self) -> None:
        """Cancel background jobs."""
        self.kernel.close()


def best_stage() -> Stage:
    """A stage with OpenGL if it is available, else one with the sky alone."""
    try:
        return GlStage()
    except UserError as error:
        return CpuSkyStage(str(error))
