"""The clouds as a layer before the sky."""

import msgspec
import numpy as np

from clouds.card_cube import clouds_on_card
from clouds.model.cloud_view import transmittances
from clouds.sky_under_clouds import NEAR_GROUND, light_under_clouds
from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.messages.gpu_job import GpuPass
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.sky_layer import SkyLayer, Viewpoint

# Clouds that have drifted by less than this share of their distance look the same.
_UNSEEN_SHARE = 0.02
_LEAST_DISTANCE_M = 50.0
# Work of a texel of one layer on a card, in trial pixels: timed on llvmpipe, 105 to 160.
_LAYER_TRIALS = 160.0


class CloudsBeforeSky(SkyLayer):
    """All layers of clouds, from low to high."""

    hears = CloudsChanged

    def is_there(self, message: CloudsChanged) -> bool:
        """Whether there is a cloud."""
        return bool(message.layers)

    def levels_m(self, message: CloudsChanged) -> tuple[float, ...]:
        """Bases and tops."""
        return tuple(level for each in message.layers for level in (each.base_m, each.top_m))

    def looks_same(self, now: CloudsChanged, before: CloudsChanged, height_m: float) -> bool:
        """Whether only a little wind separates them."""
        if len(now.layers) != len(before.layers):
            return False
        for layer, was in zip(now.layers, before.layers, strict=True):
            drifted_m = float(np.hypot(*np.subtract(layer.drift_m, was.drift_m)))
            distance_m = max(layer.base_m - height_m, _LEAST_DISTANCE_M)
            if drifted_m >= _UNSEEN_SHARE * distance_m:
                return False
            if msgspec.structs.replace(layer, drift_m=was.drift_m) != was:
                return False
        return True

    def light_under(
        self,
        message: CloudsChanged,
        clear: SkyLightChanged,
        view: Viewpoint,
        size: int,
        source: str,
    ) -> SkyLightChanged:
        """The sum of the sky and the clouds before it."""
        return light_under_clouds(message.layers, clear, view, size, source)

    def transmittance(
        self, message: CloudsChanged, directions: FloatArray, eye_m: Vector
    ) -> FloatArray:
        """The product of the layers'."""
        layers = [transmittances(layer, eye_m, directions) for layer in message.layers]
        return np.asarray(np.prod(layers, axis=0))

    def card_trials(self, message: CloudsChanged, eye_height_m: float) -> float | None:
        """Each layer is marched; an eye high below the base sees other clouds than the ground."""
        near_ground = eye_height_m <= NEAR_GROUND * message.layers[0].base_m
        return _LAYER_TRIALS * len(message.layers) if near_ground else None

    def card_passes(
        self,
        message: CloudsChanged,
        clear: SkyLightChanged,
        view: Viewpoint,
        size: int,
        scale: float,
    ) -> tuple[GpuPass, ...]:
        """A program for each layer."""
        return clouds_on_card(message.layers, clear, view.middle_m, size, scale)
