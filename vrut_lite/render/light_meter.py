"""A light meter: illuminance at points of the scene, from the same light as the picture's."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.frame_part import Hit, IsFree
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.sky import AmbientChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.render.rays import SceneRays

ExtraIrradiance = Callable[[FloatArray, FloatArray, IsFree], FloatArray]


class Illuminance(NamedTuple):
    """Illuminance (lx) of a plane: direct by sun and lamps, and all other by sky and surfaces."""

    sun_lux: float
    sky_lux: float
    lamp_lux: float = 0.0

    @property
    def lux(self) -> float:
        """Total illuminance."""
        return self.sun_lux + self.sky_lux + self.lamp_lux


def illuminance(
    rays: SceneRays,
    sun: KeyLightChanged,
    ambient: AmbientChanged,
    point_m: ArrayLike,
    normal: ArrayLike,
    sun_share: Callable[[Vector, Vector], float] = lambda point_m, direction: 1.0,
    extra: ExtraIrradiance = lambda point_m, normal, is_free: np.zeros(3),
    irradiance_at: Callable[[Hit], FloatArray | None] = lambda hit: None,
) -> Illuminance:
    """Illuminance (lx) of a plane with this normal (3,) at a point (3,), world axes.

    The scene (with a sharp edge) and frame parts shade the sun. All other light is as in the
    picture: a frame part's on surfaces, else that of the whole sky with its layers.

    Args:
        sun: the key light, unattenuated by layers.
        ambient: irradiance of the sky with its layers.
        sun_share: share of the sun in a direction that parts let reach a point.
        extra: irradiance (3,) of parts' lights, where rays from the point are free.
        irradiance_at: irradiance (3,) that a part gives a point of a surface, or None.
    """
    n = np.asarray(normal, dtype=float)
    n = n / np.linalg.norm(n)
    direction = np.asarray(sun.direction)
    cosine = max(0.0, float(n @ direction))
    point = np.asarray(point_m, dtype=float)
    sunlit = cosine > 0.0 and rays.is_free(point_m, n, direction)
    through = float(sunlit)
    if sunlit:
        x, y, z = point.tolist()
        through = sun_share((x, y, z), sun.direction)
    by_lamps = extra(point, n, partial(rays.is_free, point, n))
    sky = evaluate_irradiance(ambient.irradiance_sh_rgb.values, n)
    hit = rays.surface_at(point_m, n)
    reached = None if hit is None else irradiance_at(hit)
    sky = sky if reached is None else reached
    return Illuminance(
        sun_lux=through * cosine * float(luminance(sun.irradiance_rgb)) * LUMENS_PER_WATT,
        sky_lux=float(luminance(sky)) * LUMENS_PER_WATT,
        lamp_lux=float(luminance(by_lamps)) * LUMENS_PER_WATT,
    )
