"""The window without OpenGL: the sky alone, drawn on the CPU from its cube map.

Scenes are opened and light is computed as ever; meshes are not drawn.
"""

import numpy as np
from numpy.typing import NDArray

from vrut_lite.app.engine.stage import GlStage, Stage, WatchedBackend
from vrut_lite.array import Array
from vrut_lite.daylight.daylight_kernel import daylight_kernel, demand_light
from vrut_lite.daylight.picture import SetExposure
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.errors import UserError
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.render.display import display_picture
from vrut_lite.render.exposure import automatic_ev100
from vrut_lite.render.light_meter import Illuminance, pixel_direction
from vrut_lite.render.patience import IsGivenUp
from vrut_lite.render.rays import Hit
from vrut_lite.render.white_balance import white_balance_matrix
from vrut_lite.scene.backend import Picture
from vrut_lite.scene.manager import SceneManager
from vrut_lite.scene.recording_backend import RecordingBackend

_CUBE_SIZE = 128
# A sky is smooth: more pixels would show no more.
_MOST_PIXELS = 320 * 240


class CpuSkyBackend(RecordingBackend):
    """A `SceneBackend` that draws the background and the sun's disc, and no scene."""

    def draw(self, still: bool = True) -> Picture:
        """The sky in the camera's view, at `_MOST_PIXELS` at most."""
        (width, height), (camera,) = self.latest["set_size"], self.latest["set_camera"]
        step = max(1.0, float(np.sqrt(width * height / _MOST_PIXELS)))
        size = (round(width / step), round(height / step))
        directions = pixel_direction(camera, size, np.arange(size[0]), np.arange(size[1])[:, None])
        radiance = self._radiance(directions)
        (wish,) = self.latest.get("set_exposure", (SetExposure(),))
        ev100 = wish.ev100 if wish.mode == "manual" else automatic_ev100(radiance)
        ev100 -= wish.compensation_ev
        balance = white_balance_matrix(wish.white_temperature_k, wish.white_duv)
        display = display_picture(radiance, ev100, wish.tone_map, balance)
        return Picture(radiance, display.astype(np.uint8), ev100)

    def _radiance(self, directions: NDArray[np.float64]) -> NDArray[np.float32]:
        background: BackgroundChanged = self.latest["set_background"][0]
        assert isinstance(background.cube, Array)
        cube = decode_float16(background.cube.values, background.radiance_scale)
        radiance = sample_sky(cube, directions)
        sun: KeyLightChanged = self.latest["set_sun_light"][0]
        cosine = directions @ np.asarray(sun.direction)
        solid_angle = 2.0 * np.pi * (1.0 - np.cos(sun.angular_radius_rad))
        inside = (cosine >= np.cos(sun.angular_radius_rad)) & (directions[..., 1] > 0.0)
        radiance[inside] += np.asarray(sun.irradiance_rgb) / solid_angle
        return radiance.astype(np.float32)


class CpuSkyStage:
    """A kernel with its modules and a scene manager; no OpenGL anywhere."""

    def __init__(self, reason: str):
        self.kernel: Kernel
        self.kernel, failures = daylight_kernel()
        self.failures = [*failures, f"the sky alone is drawn, on the CPU: {reason}"]
        self.watched = WatchedBackend(CpuSkyBackend())
        self.kernel.add_module(SceneManager, backend=self.watched)
        demand_light(self.kernel, SceneManager.manifest.name, _CUBE_SIZE)
        self.renderer = "CPU, sky alone"
        self.pass_seconds: dict[str, float] = {}
        self.frame_ledger = Ledger()

    def draw(
        self, size: tuple[int, int], still: bool, is_given_up: IsGivenUp | None = None
    ) -> Picture:
        """Draw the present state; quick enough that it is never given up."""
        return self.watched.draw_sized(size, lambda: self.watched.draw(still))

    def light_at_pixel(self, x: int, y: int) -> Illuminance | None:
        """There is nothing but sky."""
        return None

    def surface_at_pixel(self, x: int, y: int) -> Hit | None:
        """There is nothing but sky."""
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
