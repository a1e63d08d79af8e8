"""A light meter: lux at points of the scene, from the same light as the picture's."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.daylight.cloud_density import sun_transmittance
from vrut_lite.daylight.clouds import CloudLayer
from vrut_lite.daylight.sky import AmbientChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.numeric_types import FloatArray
from vrut_lite.render.cloud_light import ClearLight, under_clouds
from vrut_lite.render.rays import Hit, SceneRays
from vrut_lite.scene.camera import look_at


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

    The scene shades the sun, with a sharp edge, and clouds do; the sky is the whole one, as in
    the picture.
    """
    n = np.asarray(normal, dtype=float)
    n = n / np.linalg.norm(n)
    direction = np.asarray(sun.direction)
    cosine = max(0.0, float(n @ direction))
    lit = cosine > 0.0 and rays.is_free(point_m, n, direction)
    harmonics = ambient.irradiance_sh_rgb.values
    through = float(lit)
    if clouds is not None:
        clear = ClearLight(sun.direction, sun.irradiance_rgb, harmonics)
        harmonics = under_clouds(clouds, clear)
        through = sun_transmittance(clouds, point_m, direction) if lit else 0.0
    sky = evaluate_irradiance(harmonics, n)
    return Illuminance(
        sun_lux=through * cosine * float(luminance(sun.irradiance_rgb)) * LUMENS_PER_WATT,
        sky_lux=float(luminance(sky)) * LUMENS_PER_WATT,
    )


def surface_at(
    rays: SceneRays, camera: MoveCamera, size: tuple[int, int], x: int, y: int
) -> Hit | None:
    """What the middle of a pixel shows, None if it is the sky; y counts from the top."""
    return rays.first_hit(camera.eye_m, pixel_direction(camera, size, x, y))


def pixel_direction(
    camera: MoveCamera, size: tuple[int, int], x: ArrayLike, y: ArrayLike
) -> FloatArray:
    """Unit world directions (..., 3) through the middles of pixels x, y, counted from the top."""
    width, height = size
    tangent = np.tan(0.5 * camera.vertical_field_of_view_rad)
    right = (2.0 * (np.asarray(x) + 0.5) / width - 1.0) * tangent * width / height
    up = (1.0 - 2.0 * (np.asarray(y) + 0.5) / height) * tangent
    local = np.stack(np.broadcast_arrays(right, up, -1.0), axis=-1)
    # Of the view alone: far from the origin an eye would cost digits.
    directions = local @ look_at(np.zeros(3), np.subtract(camera.target_m, camera.eye_m))[:3, :3]
    return np.asarray(directions / np.linalg.norm(directions, axis=-1, keepdims=True))
