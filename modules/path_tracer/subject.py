"""What a picture is of: everything the tracer needs, told once and never changed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.scene.ground_disc import GroundDisc
from vrut_lite.scene.loading import LoadedScene

# The scene's own radius in units of the tracer, whose ray offsets are made for such sizes:
# a watch and a city are traced alike.
_SCENE_UNITS = 100.0
_SMALLEST_RADIUS_M = 1e-6


@dataclass(frozen=True, eq=False)
class Subject:
    """A scene, its light, and a camera; world axes, metres, linear sRGB in W m^-2 (sr^-1).

    `sheltered`: sun and sky light nothing, as in a closed room. `size` is (width, height).
    """

    scene: LoadedScene
    ground: GroundDisc | None
    ground_albedo: NDArray[np.float64]
    background: BackgroundChanged
    sun: KeyLightChanged
    camera: MoveCamera
    sheltered: bool
    size: tuple[int, int]

    @property
    def radius_m(self) -> float:
        """Half the diagonal of the scene's bounds."""
        diagonal_m = float(np.linalg.norm(self.scene.upper_m - self.scene.lower_m))
        return max(0.5 * diagonal_m, _SMALLEST_RADIUS_M)

    @property
    def units_per_m(self) -> float:
        """Length of a metre in the tracer."""
        return _SCENE_UNITS / self.radius_m

    def units_from_world(self) -> NDArray[np.float64]:
        """Matrix (4, 4) from world axes to the tracer's units, counted from the eye.

        In double precision: what is left for the tracer's single precision is small near the
        eye, wherever the scene lies.
        """
        matrix = np.eye(4) * self.units_per_m
        matrix[:3, 3] = -self.units_per_m * np.asarray(self.camera.eye_m, dtype=float)
        matrix[3, 3] = 1.0
        return matrix

    def reach_units(self) -> float:
        """Distance from the eye to the farthest there is, the ground's rim included."""
        centre_m = 0.5 * (self.scene.lower_m + self.scene.upper_m)
        reach_m = float(np.linalg.norm(centre_m - self.camera.eye_m)) + self.radius_m
        if self.ground is not None:
            x, z = self.ground.centre_xz_m
            middle_m = np.array([x, self.ground.height_m, z])
            away_m = float(np.linalg.norm(middle_m - self.camera.eye_m)) + self.ground.radius_m
            reach_m = max(reach_m, away_m)
        return reach_m * self.units_per_m
