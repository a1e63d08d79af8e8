"""A light meter: lux at points of the scene, from the same light as the picture's."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.daylight.cloud_density import sun_transmittance
from vrut_lite.daylight.clouds import CloudLayer
from vrut_lite.daylight.sky import AmbientChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.render.rays import SceneRays


class Illuminance(NamedTuple):
    """Lux on a plane, by the sun and by sky and ground together."""

    sun_lux: float
    sky_lux: float

    @property
    def lux(self) -> float:
        """Both."""
        return self.sun_lux + self.sky_lux


def illuminance(
    rays: SceneRays,
    sun: KeyLightChanged,
    ambient: AmbientChanged,
    point_m: ArrayLike,
    normal: ArrayLike,
    clouds: CloudLayer | None = None,
) -> Illuminance:
    """Lux on a plane with this normal (3,) at a point (3,), world axes.

    The scene shades the sun, with a sharp edge, and clouds do; the sky is the whole one with the
    clouds in it, as in the picture.

    Args:
        sun: before clouds.
        ambient: of sky and clouds together.
    """
    n = np.asarray(normal, dtype=float)
    n = n / np.linalg.norm(n)
    direction = np.asarray(sun.direction)
    cosine = max(0.0, float(n @ direction))
    lit = cosine > 0.0 and rays.is_free(point_m, n, direction)
    through = float(lit)
    if lit and clouds is not None:
        through = sun_transmittance(clouds, point_m, direction)
    sky = evaluate_irradiance(ambient.irradiance_sh_rgb.values, n)
    return Illuminance(
        sun_lux=through * cosine * float(luminance(sun.irradiance_rgb)) * LUMENS_PER_WATT,
        sky_lux=float(luminance(sky)) * LUMENS_PER_WATT,
    )
