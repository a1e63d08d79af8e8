"""The cloud shadow map: the layer's optical depth towards the sun for places around the eye.

Texels lie at its base and grow away from the middle: x = near u / (1 - growth |u|), u in [-1, 1]
along each axis. The wind shifts the map; it is drawn again when sun or layer change, or the eye has
left its middle.
"""

from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.cloud_grid import GROWTH, LEAST_SINE, NEAR_M
from vrut_lite.daylight.cloud_light import ClearLight
from vrut_lite.daylight.clouds import CloudLayer
from vrut_lite.kernel.ledger import Ledger
from vrut_lite.numeric_types import Vector
from vrut_lite.render.clouds.layer_textures import CloudsOnGpu, CloudSurroundings, ShadowPlane
from vrut_lite.render.clouds.light_volume import CloudLightVolume
from vrut_lite.render.passes.full_screen import FullScreen

UNIT = 14
_SIZE = 512
# Distance of the eye from the middle at which near texels become too wide.
_OFF_CENTRE_M = 1_500.0
# At the zenith it moves shadows of a base at 1.5 km by a texel.
_SUN_STEP_RAD = 0.01


class CloudShadowMap:
    """A texture of optical depths; made and used on the GL thread only.

    The ledger counts "cloud shadow map" done, and skipped: without sun, or where it still holds.
    """

    def __init__(self, context: Any, ledger: Ledger):
        self._context = context
        self._ledger = ledger
        self._screen = FullScreen(context, "cloud_shadow.frag")
        self._texture = context.texture((_SIZE, _SIZE), 1, dtype="f4")
        self._texture.filter = (context.LINEAR, context.LINEAR)
        self._texture.repeat_x = self._texture.repeat_y = False
        self._buffer = context.framebuffer([self._texture])
        self._volume = CloudLightVolume(context)
        self._is_cast = False
        # How often the light has been computed anew.
        self.lights = 0
        self._layer: CloudLayer | None = None
        self._sun: Vector = (0.0, 0.0, 0.0)
        self._centre_m = np.zeros(2)

    def bind(
        self,
        clouds: CloudsOnGpu,
        light: ClearLight,
        sky_irradiance: NDArray[np.float64],
        around: CloudSurroundings,
    ) -> bool:
        """Bind clouds and shadows of this frame; whether there is a sun that casts any.

        `sky_irradiance` (3,): of level ground by sky and clouds.
        """
        layer, eye_m = clouds.layer, around.eye_m[[0, 2]]
        assert layer is not None
        blown_m = np.zeros(2) if self._layer is None else _difference(layer, self._layer)
        holds = self._holds(layer, light.sun_direction, eye_m - blown_m)
        if holds:
            clouds.bind(light, sky_irradiance, around, _plane(self._centre_m + blown_m))
        else:
            clouds.bind(light, sky_irradiance, around, _plane(eye_m))
            self._volume.draw(clouds)
            self.lights += 1
            self._ledger.did("cloud light volume")
            self._layer, self._sun, self._centre_m = layer, light.sun_direction, eye_m
            self._is_cast = False
        if not any(light.sun_irradiance):
            self._ledger.skip("cloud shadow map: no sun to cast one")
            return False
        if self._is_cast:
            self._ledger.skip("cloud shadow map: it still holds")
        else:
            self._draw(clouds)
            self._is_cast = True
        self._texture.use(location=UNIT)
        # Another unit is the active one now: a texture that is made before the meshes are drawn
        # would take the map's place.
        self._texture.use(location=0)
        return True

    def bind_light(self) -> None:
        """Set the inputs of the light in clouds."""
        self._volume.bind()

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        for thing in (self._buffer, self._texture, self._screen, self._volume):
            thing.release()

    def _holds(self, layer: CloudLayer, sun: Vector, eye_m: NDArray) -> bool:
        """Whether the map serves this eye, after the shift by the wind since then."""
        if self._layer is None or not _is_blown(layer, self._layer):
            return False
        # A low sun's shadows move farther.
        step_rad = _SUN_STEP_RAD * max(sun[1], LEAST_SINE)
        moved = float(np.linalg.norm(np.subtract(sun, self._sun)))
        away_m = float(np.abs(eye_m - self._centre_m).max())
        return moved <= step_rad and away_m <= _OFF_CENTRE_M

    def _draw(self, clouds: CloudsOnGpu) -> None:
        self._buffer.use()
        clouds.bind_noises()
        context = self._context
        context.disable(context.DEPTH_TEST | context.BLEND | context.CULL_FACE)
        self._screen.draw()
        self._ledger.did("cloud shadow map")


def _plane(centre_m: NDArray[np.float64]) -> ShadowPlane:
    return ShadowPlane(centre_m, NEAR_M, GROWTH, LEAST_SINE, _SIZE)


def _difference(layer: CloudLayer, before: CloudLayer) -> NDArray[np.float64]:
    return np.subtract(layer.drift_m, before.drift_m)


def _is_blown(layer: CloudLayer, before: CloudLayer) -> bool:
    """Whether two layers differ by the wind's drift alone."""
    same = layer.shape.values is before.shape.values
    return same and msgspec.structs.replace(layer, drift_m=before.drift_m) == before
