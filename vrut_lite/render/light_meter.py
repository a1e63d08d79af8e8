"""A light meter: lux at points of the scene, from the same light as the picture's."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.lamps import MOST_DRAWN, SceneLamps
from vrut_lite.messages.sky import AmbientChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.numeric_types import Vector
from vrut_lite.render.rays import SceneRays
from vrut_lite.render.surface_look_up import LitScene, reached_irradiance


class Illuminance(NamedTuple):
    """Lux on a plane, straight by the sun and by lamps, and by all else: sky and surfaces."""

    sun_lux: float
    sky_lux: float
    lamp_lux: float = 0.0

    @property
    def lux(self) -> float:
        """All of it."""
        return self.sun_lux + self.sky_lux + self.lamp_lux


def illuminance(
    rays: SceneRays,
    sun: KeyLightChanged,
    ambient: AmbientChanged,
    point_m: ArrayLike,
    normal: ArrayLike,
    sun_share: Callable[[Vector, Vector], float] = lambda point_m, direction: 1.0,
    lit: LitScene | None = None,
    lamps: SceneLamps | None = None,
) -> Illuminance:
    """Lux on a plane with this normal (3,) at a point (3,), world axes.

    The scene (with a sharp edge) and frame parts shade the sun. All other light is as in the
    picture: the light map's on its surfaces, else that of the whole sky with its layers.

    Args:
        sun: before any layer.
        ambient: of the sky with its layers.
        sun_share: share of the sun in a direction that parts let reach a point.
        lamps: of the scene; those that the frame draws shine here too.
    """
    n = np.asarray(normal, dtype=float)
    n = n / np.linalg.norm(n)
    direction = np.asarray(sun.direction)
    cosine = max(0.0, float(n @ direction))
    sunlit = cosine > 0.0 and rays.is_free(point_m, n, direction)
    through = float(sunlit)
    if sunlit:
        x, y, z = np.asarray(point_m, float).tolist()
        through = sun_share((x, y, z), sun.direction)
    sky = evaluate_irradiance(ambient.irradiance_sh_rgb.values, n)
    hit = None if lit is None else rays.surface_at(point_m, n)
    if lit is not None and hit is not None:
        reached = reached_irradiance(lit, hit)
        sky = sky if reached is None else reached
    return Illuminance(
        sun_lux=through * cosine * float(luminance(sun.irradiance_rgb)) * LUMENS_PER_WATT,
        sky_lux=float(luminance(sky)) * LUMENS_PER_WATT,
        lamp_lux=0.0 if lamps is None else _lamp_lux(rays, lamps, np.asarray(point_m, float), n),
    )


def _lamp_lux(
    rays: SceneRays, lamps: SceneLamps, point_m: NDArray[np.float64], n: NDArray[np.float64]
) -> float:
    lux = 0.0
    for lamp in range(min(lamps.count, MOST_DRAWN)):
        away = lamps.position_m.values[lamp] - point_m
        reach_m = float(np.linalg.norm(away))
        if reach_m > 0.0 and n @ away > 0.0 and rays.is_free(point_m, n, away / reach_m, reach_m):
            lux += float(luminance(lamps.irradiance_at(lamp, point_m, n))) * LUMENS_PER_WATT
    return lux
