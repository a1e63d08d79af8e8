"""Light on clouds from below: the ground's radiance under a broken or closed layer.

A cloud counts as a plane layer of its mean optical depth (`cloud_transport`). Its light comes from
the base, evenly; the clear sky's comes through the gaps.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from clouds.model.cloud_transport import even_transmittance, layer_transmittance
from vrut_lite.atmosphere.haze_layer import HazeLayer
from vrut_lite.atmosphere.sunlight import sunlight_at_altitude
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.messages.sky import NO_LAMPS
from vrut_lite.numeric_types import FloatArray, Vector

_UP = np.array([0.0, 1.0, 0.0])
_DARKEST_IRRADIANCE = 1e-12


class ClearLight(NamedTuple):
    """The light on a layer: that of a sky without clouds, as in the frame's `Light`, or that of sky
    and layers above (`cloud_layers.py`).

    `sun_passed` is the transmittance of the layers above for sunlight, `haze` the air's,
    `lamps_rgb` the radiance of the lands around by their lamps, at the layer.
    """

    sun_direction: Vector
    sun_irradiance: Vector
    irradiance_sh: NDArray
    sun_passed: float = 1.0
    haze: tuple[HazeLayer, ...] = ()
    lamps_rgb: Vector = NO_LAMPS

    @property
    def by_sun(self) -> FloatArray:
        """Irradiance (3,) of level ground by the sun."""
        return np.asarray(self.sun_irradiance) * max(self.sun_direction[1], 0.0)

    @property
    def by_sky(self) -> FloatArray:
        """Irradiance (3,) of level ground by the sky."""
        return evaluate_irradiance(self.irradiance_sh, _UP)

    @property
    def on_ground(self) -> FloatArray:
        """Irradiance (3,) of level ground, kept above zero for quotients."""
        return np.maximum(self.by_sun + self.by_sky, _DARKEST_IRRADIANCE)


def light_from_below(layer: CloudLayer, light: ClearLight) -> FloatArray:
    """Radiance (3,) of the ground as clouds see it, in the mean, W m^-2 sr^-1."""
    covered, sine = layer.coverage, light.sun_direction[1]
    clear = evaluate_irradiance(light.irradiance_sh, -_UP) / np.pi
    depth = layer.optical_depth
    aloft = sunlight_at_altitude(layer.top_m, sine, light.haze) * max(sine, 0.0) * light.sun_passed
    even = even_transmittance(depth)
    albedo = np.minimum(np.pi * clear / light.on_ground, 1.0)
    # The ground's light comes back from the clouds, and so on.
    again = 1.0 / (1.0 - albedo * covered * (1.0 - even))
    from_clouds = aloft * layer_transmittance(depth, sine) + light.by_sky * even
    lit = (1.0 - covered) * (light.by_sun + light.by_sky) + covered * from_clouds
    return np.asarray((clear * (lit / light.on_ground) + np.asarray(light.lamps_rgb)) * again)
