"""The clouds as a layer before the sky."""

import msgspec
import numpy as np

from clouds.sky_under_clouds import light_under_clouds
from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.sky.sky_layer import SkyLayer, Viewpoint

# Clouds that have drifted by less than this share of their distance look the same.
_UNSEEN_SHARE = 0.02
_LEAST_DISTANCE_M = 50.0


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
