"""The cloud shadow map: the layers' optical depth towards the sun for places around the eye.

Texels lie at the lowest base and grow away from the middle: x = near u / (1 - growth |u|), u in
[-1, 1] along each axis. The lowest wind shifts the map; it is redrawn when sun or layers
change, when the eye has left its middle, or when layers have been blown apart.
"""

from collections.abc import Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from clouds.drawing.layer_textures import (
    SHADERS,
    CloudsOnGpu,
    CloudSurroundings,
    ShadowPlane,
)
from clouds.drawing.light_volume import CloudLightVolume
from clouds.model.cloud_grid import LEAST_SINE, NEAR_M, growth_of
from clouds.model.cloud_layers import mean_sun_share
from clouds.model.cloud_light import ClearLight
from vrut_lite.frame_part import PartGl
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.numeric_types import Vector

SAMPLER = "cloud_shadow_map"
_SIZE = 512
# Distance of the eye from the middle at which near texels become too wide.
_OFF_CENTRE_M = 1_500.0
# Layers that have been blown apart by less than this still cast the same shadow: the sun's disc
# blurs that of an upper layer as far.
_APART_M = 100.0
# At the zenith it moves shadows of a base at 1.5 km by a texel.
_SUN_STEP_RAD = 0.01


class CloudShadowMap:
    """A texture of optical depths; made and used on the GL thread only.

    The counters count "cloud shadow map" done, and skipped: without sun, or where it still holds.
    """

    def __init__(self, gl: PartGl):
        self._gl = gl
        context = self._context = gl.context
        self._counters, self._unit = gl.counters, gl.unit(SAMPLER)
        self._screen = gl.screen(SHADERS / "cloud_shadow.frag")
        self._texture = context.texture((_SIZE, _SIZE), 1, dtype="f4")
        self._texture.filter = (context.LINEAR, context.LINEAR)
        self._texture.repeat_x = self._texture.repeat_y = False
        self._buffer = context.framebuffer([self._texture])
        # One for each layer, from low to high.
        self._volumes: list[CloudLightVolume] = []
        self._is_cast = False
        # Number of computations of the light.
        self.lights = 0
        self._layers: tuple[CloudLayer, ...] = ()
        self._sun: Vector = (0.0, 0.0, 0.0)
        self._centre_m = np.zeros(2)

    def bind(
        self,
        clouds: Sequence[CloudsOnGpu],
        lights: Sequence[ClearLight],
        sky_irradiance: NDArray[np.float64],
        around: CloudSurroundings,
    ) -> bool:
        """Bind clouds and shadows of this frame; whether there is a sun that casts any.

        Args:
            clouds: the layers from low to high.
            lights: on each; the last is that of the clear sky.
            sky_irradiance: (3,), of level ground by sky and clouds.
        """
        layers, eye_m = tuple(c.layer for c in clouds if c.layer), around.eye_m[[0, 2]]
        sun = lights[-1].sun_direction
        blown_m = _blown(layers, self._layers)[0] if self._layers else np.zeros(2)
        holds = self._holds(layers, sun, eye_m - blown_m)
        centre_m = self._centre_m + blown_m if holds else eye_m
        covered = 1.0 - mean_sun_share(layers, float(sun[1]))
        for cloud, light in zip(clouds, lights, strict=True):
            cloud.bind(light, sky_irradiance, around, _plane(centre_m), covered)
        if not holds:
            self._fill_volumes(layers, sun, eye_m)
            self.lights += 1
            self._layers, self._sun, self._centre_m = layers, sun, eye_m
            self._is_cast = False
        casts = any(lights[-1].sun_irradiance)
        if not casts:
            self._counters.skip("cloud shadow map: no sun to cast one")
        elif self._is_cast:
            self._counters.skip("cloud shadow map: it still holds")
        else:
            self._draw(clouds)
            self._is_cast = True
        clouds[0].bind_again()
        if casts:
            self._texture.use(location=self._unit)
            # Another unit is the active one now: a texture that is made before the meshes are
            # drawn would take the map's place.
            self._texture.use(location=0)
        return casts

    def bind_light(self, number: int) -> None:
        """Set the inputs of the light in a layer, by its number from low to high."""
        self._volumes[number].bind()

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        for thing in (self._buffer, self._texture, *self._volumes):
            thing.release()

    def _holds(self, layers: tuple[CloudLayer, ...], sun: Vector, eye_m: NDArray) -> bool:
        """Whether the map serves this eye, after the shift by the wind since then."""
        if not _are_blown(layers, self._layers):
            return False
        # A low sun's shadows move farther.
        step_rad = _SUN_STEP_RAD * max(sun[1], LEAST_SINE)
        moved = float(np.linalg.norm(np.subtract(sun, self._sun)))
        away_m = float(np.abs(eye_m - self._centre_m).max())
        return moved <= step_rad and away_m <= _OFF_CENTRE_M

    def _fill_volumes(
        self, layers: tuple[CloudLayer, ...], sun: Vector, centre_m: NDArray[np.float64]
    ) -> None:
        while len(self._volumes) < len(layers):
            self._volumes.append(CloudLightVolume(self._gl))
        for layer, volume in zip(layers, self._volumes, strict=False):
            volume.fill(layer, sun, centre_m)
            self._counters.did("cloud light volume")

    def _draw(self, clouds: Sequence[CloudsOnGpu]) -> None:
        self._buffer.use()
        context = self._context
        context.disable(context.DEPTH_TEST | context.BLEND | context.CULL_FACE)
        context.blend_func = context.ONE, context.ONE
        lowest_m = clouds[0].base_m
        for cloud in clouds:
            cloud.bind_again()
            cloud.bind_noises()
            self._screen.set("rise_m", cloud.base_m - lowest_m)
            self._screen.draw()
            # Optical depths of layers add up.
            context.enable(context.BLEND)
        context.disable(context.BLEND)
        self._counters.did("cloud shadow map")


def _plane(centre_m: NDArray[np.float64]) -> ShadowPlane:
    return ShadowPlane(centre_m, NEAR_M, growth_of(NEAR_M), LEAST_SINE, _SIZE)


def _blown(layers: tuple[CloudLayer, ...], before: tuple[CloudLayer, ...]) -> NDArray[np.float64]:
    """How far (n, 2) the wind has carried layers that both have."""
    return np.array(
        [np.subtract(now.drift_m, was.drift_m) for now, was in zip(layers, before, strict=False)]
    )


def _are_blown(layers: tuple[CloudLayer, ...], before: tuple[CloudLayer, ...]) -> bool:
    """Whether layers differ by the wind's drift alone, and have drifted together."""
    if not before or len(layers) != len(before):
        return False
    blown_m = _blown(layers, before)
    return bool(np.abs(blown_m - blown_m[0]).max() < _APART_M) and all(
        now.shape.values is was.shape.values
        and msgspec.structs.replace(now, drift_m=was.drift_m) == was
        for now, was in zip(layers, before, strict=True)
    )
