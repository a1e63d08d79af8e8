"""The subject of the tracer: the scene's state, and lengths in the tracer's units."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import BackgroundChanged, SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.scene_engine import SceneState

# The scene's own radius in units of the tracer, whose ray offsets are made for such sizes:
# a watch and a city are traced alike.
_SCENE_UNITS = 100.0
_SMALLEST_RADIUS_M = 1e-6


@dataclass(frozen=True, eq=False)
class Subject:
    """A state that lacks nothing (`check_drawable`); world axes, metres."""

    state: SceneState

    @property
    def scene(self) -> SceneOpened:
        """Its geometry and materials."""
        assert self.state.scene is not None
        return self.state.scene

    @property
    def background(self) -> BackgroundChanged:
        """Its sky, with the layers before it."""
        return self._sky_light.background

    @property
    def light(self) -> BackgroundChanged | SkyRadianceChanged:
        """The sky that lights it: as the ground sees it, however high the camera is."""
        return self._sky_light.lighting

    @property
    def sun(self) -> KeyLightChanged:
        """Its key light, behind the layers."""
        return self._sky_light.key_light

    @property
    def _sky_light(self) -> SkyLightChanged:
        assert self.state.sky_light is not None
        return self.state.sky_light

    @property
    def camera(self) -> MoveCamera:
        """Its camera."""
        assert self.state.camera is not None
        return self.state.camera

    @property
    def radius_m(self) -> float:
        """Half the diagonal of the scene's bounds."""
        diagonal_m = float(np.linalg.norm(np.subtract(self.scene.upper_m, self.scene.lower_m)))
        return max(0.5 * diagonal_m, _SMALLEST_RADIUS_M)

    @property
    def units_per_m(self) -> float:
        """Length of a metre in the tracer."""
        return _SCENE_UNITS / self.radius_m

    def units_from_world(self) -> NDArray[np.float64]:
        """Matrix (4, 4) from world axes to the tracer's units, counted from the eye.

        In double precision: coordinates left for the tracer's single precision are small near the
        eye, wherever the scene lies.
        """
        matrix = np.eye(4) * self.units_per_m
        matrix[:3, 3] = -self.units_per_m * np.asarray(self.camera.eye_m, dtype=float)
        matrix[3, 3] = 1.0
        return matrix

    def reach_units(self) -> float:
        """Distance from the eye to the farthest there is, the ground's rim included."""
        centre_m = 0.5 * np.add(self.scene.lower_m, self.scene.upper_m)
        reach_m = float(np.linalg.norm(centre_m - self.camera.eye_m)) + self.radius_m
        ground = self.scene.ground
        if ground is not None:
            x, z = ground.centre_xz_m
            middle_m = np.array([x, ground.height_m, z])
            away_m = float(np.linalg.norm(middle_m - self.camera.eye_m)) + ground.radius_m
            reach_m = max(reach_m, away_m)
        return reach_m * self.units_per_m
