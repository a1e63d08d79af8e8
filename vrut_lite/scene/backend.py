"""What the scene manager drives: something that can show a scene under a light."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.clouds import CloudsChanged
from vrut_lite.daylight.picture import SetExposure
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.scene.ground_disc import GroundDisc
from vrut_lite.scene.loading import LoadedScene


@dataclass(frozen=True)
class Picture:
    """A drawn frame.

    radiance (h, w, 3) float32 is linear sRGB in W m^-2 sr^-1, display (h, w, 3) uint8 is
    sRGB-encoded, row 0 at the top; `ev100` is the exposure that was used.
    """

    radiance: NDArray[np.float32]
    display: NDArray[np.uint8]
    ev100: float

    def luminance_cd_m2(self, x: int, y: int) -> float:
        """Luminance of a pixel in cd m^-2; x counts from the left, y from the top.

        Raises:
            ValueError: there is no such pixel.
        """
        height, width = self.radiance.shape[:2]
        if not (0 <= x < width and 0 <= y < height):
            raise ValueError(f"the picture has {width} x {height} pixels, none at ({x}, {y})")
        return float(luminance(self.radiance[y, x])) * LUMENS_PER_WATT


class SceneBackend(Protocol):
    """Shows one scene; every call may come in any order and replaces what it set before."""

    def show_scene(self, scene: LoadedScene, ground: GroundDisc | None) -> None:
        """Show this scene, on this ground if there is one."""

    def set_background(self, background: BackgroundChanged) -> None:
        """Show this sky."""

    def set_sun_light(self, light: KeyLightChanged) -> None:
        """Light with this sun."""

    def set_ambient(self, ambient: AmbientChanged) -> None:
        """Light with this sky."""

    def set_air(self, air: AirChanged) -> None:
        """Show the scene through this air."""

    def set_clouds(self, clouds: CloudsChanged) -> None:
        """Show these clouds."""

    def set_light_shafts(self, light_shafts: bool) -> None:
        """Whether the scene shades the air."""

    def set_ground_albedo(self, albedo_rgb: NDArray[np.float64]) -> None:
        """Paint the ground disc; (3,) linear sRGB."""

    def set_camera(self, camera: MoveCamera) -> None:
        """Look from here."""

    def set_sheltered(self, sheltered: bool) -> None:
        """Whether the camera is in a closed room, where sun and sky light nothing."""

    def set_exposure(self, exposure: SetExposure) -> None:
        """Expose like this."""

    def set_size(self, width_px: int, height_px: int) -> None:
        """Draw pictures of this size."""

    def draw(self, still: bool = True) -> Picture:
        """Draw a frame.

        A still is finished; in a frame of many, what changes slowly may lag behind.

        Raises:
            RuntimeError: scene, light or camera is still missing.
        """
