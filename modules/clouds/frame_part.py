"""The clouds' part of the frame: the layers, and their shadows on surfaces below."""

from itertools import zip_longest

import numpy as np

from clouds.drawing.block import CLOUDS
from clouds.drawing.cloud_pass import MARCHED, CloudPass
from clouds.drawing.cloud_shadow import SAMPLER, CloudShadowMap
from clouds.drawing.layer_textures import BLOCK, SHADERS, CloudsOnGpu, CloudSurroundings
from clouds.drawing.light_volume import SAMPLER as LIGHT_SAMPLER
from clouds.model.cloud_layers import clear_light, lights_on, sun_transmittance_of
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.frame_part import FramePart, Heard, PartFrame, PartGl, PartTarget, latest
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.clouds import CloudLayer, CloudsChanged
from vrut_lite.numeric_types import Vector

# Light that changes by more from one picture to the next shows in all of the next.
_LARGEST_CHANGE = 0.01


class CloudsPart(FramePart):
    """Draws the layers of clouds.

    The counters count "clouds" drawn, and skips: the copy of depths where no mesh reaches up to
    them, and marches of a still's further pictures.
    """

    hears = (CloudsChanged,)
    blocks = {BLOCK: CLOUDS}  # noqa: RUF012  (the base class says that it is the class's)
    samplers = (SAMPLER, LIGHT_SAMPLER)
    sun_factor = SHADERS / "sun_factor.glsl"

    def __init__(self, gl: PartGl):
        super().__init__(gl)
        self._counters = gl.counters
        # Made with the first layers: a frame without clouds compiles nothing of them.
        self._made: list[CloudsOnGpu] = []
        # Each layer has its own: a moving picture takes clouds over from the one before.
        self._passes: list[CloudPass] = []
        self._shadow: CloudShadowMap | None = None
        self._casts = False
        # Light of the clear sky on the ground, and how often it has changed at once.
        self._on_ground = np.zeros(3)
        self._changes = 0

    @classmethod
    def reach_m(cls, heard: Heard, camera: MoveCamera) -> float:
        """Distance from the eye to the last clouds over the horizon."""
        layers = _layers(heard)
        if not layers:
            return 0.0
        heights_m = np.array([camera.eye_m[1], layers[-1].top_m])
        return float(np.sqrt(np.maximum(heights_m, 0.0) * 2.0 * GROUND_RADIUS_M).sum())

    @classmethod
    def sun_share(cls, heard: Heard, point_m: Vector, direction: Vector) -> float:
        """Transmittance of all layers from a point towards the sun."""
        return sun_transmittance_of(_layers(heard), point_m, direction)

    def show(self, heard: Heard) -> None:
        """Draw these layers from the next picture on."""
        layers = _layers(heard)
        if layers and self._shadow is None:
            self._shadow = CloudShadowMap(self.gl)
        while len(self._made) < len(layers):
            self._made.append(CloudsOnGpu(self.gl))
            self._passes.append(CloudPass(self.gl))
        for cloud, layer in zip_longest(self._made, layers):
            cloud.show(layer)

    @property
    def _drawn(self) -> list[CloudsOnGpu]:
        return [cloud for cloud in self._made if cloud.layer is not None]

    @property
    def is_seen(self) -> bool:
        """Whether there are clouds."""
        return bool(self._drawn)

    @property
    def shades_sun(self) -> bool:
        """Whether there is a sun or a moon that they shade."""
        return self._casts

    def prepare(self, frame: PartFrame) -> None:
        """Bind the clouds of this picture and their shadow."""
        view = frame.view
        around = CloudSurroundings(
            eye_m=view.eye_m,
            ground_level_m=frame.ground_level_m,
            pixel_rad=2.0 / (float(view.projection[1, 1]) * frame.size_px[1]),
        )
        assert self._shadow is not None
        clear_sky = frame.clear_sky
        clear = clear_light(
            frame.key_light, clear_sky.irradiance_sh_rgb.values, clear_sky.lamps_rgb
        )
        change = np.abs(clear.on_ground - self._on_ground)
        self._changes += bool(np.any(change > _LARGEST_CHANGE * clear.on_ground))
        self._on_ground = clear.on_ground
        beneath = evaluate_irradiance(frame.whole_sky.irradiance_sh_rgb.values, (0.0, 1.0, 0.0))
        drawn = self._drawn
        layers = tuple(cloud.layer for cloud in drawn if cloud.layer is not None)
        self._casts = self._shadow.bind(drawn, lights_on(layers, clear), beneath, around)

    def draw_over_solid(self, frame: PartFrame, target: PartTarget, sample: int) -> None:
        """Layers over the sky, and over surfaces that stand behind them."""
        assert self._shadow is not None
        view, drawn = frame.view, self._drawn
        light = None if frame.is_still else self._shadow.lights + self._changes
        eye_m = float(view.eye_m[1])
        # Farther layers first, so that nearer ones are blended over them.
        far_first = sorted(
            zip(drawn, self._passes, strict=False),
            key=lambda pair: pair[0].distance_m(eye_m),
            reverse=True,
        )
        for cloud, drawing in far_first:
            before_meshes = max(frame.highest_m, eye_m) > cloud.base_m
            if not before_meshes:
                self._counters.skip("clouds: before meshes, all below them")
            if sample not in MARCHED:
                self._counters.skip("clouds: those of the picture before")
                drawing.draw_again(before_meshes)
                continue
            cloud.bind_again()
            self._shadow.bind_light(drawn.index(cloud))
            drawing.draw(cloud, target, view, frame.air, before_meshes, light, sample)
            self._counters.did("clouds")
        # The shadow map lies at the lowest base; surfaces drawn next look it up.
        drawn[0].bind_again()

    def release(self) -> None:
        """Free the GL objects."""
        for thing in (*self._made, *self._passes, self._shadow):
            if thing is not None:
                thing.release()


def _layers(heard: Heard) -> tuple[CloudLayer, ...]:
    """The layers from low to high."""
    message = latest(heard, CloudsChanged)
    return () if message is None else message.layers
