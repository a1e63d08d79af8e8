"""The Earth's shadow on the moon: where it lies, and the copper that air bends into it.

The umbra is larger than the solid Earth's by a fiftieth, for the air (Chauvenet's rule). Its light
differs from eclipse to eclipse and has no photometry: Danjon's scale (1920) says in words how dark
it looked, from 0, hardly visible, to 4, bright copper. To his words belong the magnitudes and
colours here, from reports of moons between -3.5 and +3.5 magnitudes: a choice, not a measurement.
"""

from math import asin

import astronomy
import numpy as np

from night_sky.moon import Moon
from night_sky.sky_axes import AU_KM, Watch, refracted
from vrut_lite.messages.night import EarthShadow
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.moon_disc import shadow_share

_EARTH_KM, _SUN_KM, _ENLARGED = 6378.14, 696_000.0, 1.02
# By the number: magnitudes below the full moon in the middle of the umbra; colours, red 1.
_DIMMED = (17.5, 15.5, 13.2, 11.5, 10.2)
_COLOURS = ((1, 0.8, 0.7), (1, 0.6, 0.4), (1, 0.25, 0.08), (1, 0.32, 0.1), (1, 0.45, 0.2))
_ACROSS = 48


def earth_shadow(
    at: Watch, moon: Moon, danjon: float, eye_height_m: float = 0.0
) -> EarthShadow | None:
    """The shadow as an eye above a place sees it; None where it does not reach the moon."""
    sun = _vector(astronomy.GeoVector(astronomy.Body.Sun, at.time, True))
    centre = _vector(astronomy.GeoVector(astronomy.Body.Moon, at.time, True))
    sun_km, moon_km = float(np.linalg.norm(sun)), float(np.linalg.norm(centre))
    axis = -sun / sun_km * moon_km
    place = _vector(astronomy.ObserverVector(at.time, at.observer, False))
    seen = axis - place
    distance_km = float(np.linalg.norm(seen))
    earth, sun_rad = _ENLARGED * asin(_EARTH_KM / moon_km), asin(_SUN_KM / sun_km)
    nearer = moon_km / distance_km
    umbra, penumbra = (nearer * (earth + _EARTH_KM / sun_km + side * sun_rad) for side in (-1, 1))
    true = at.world @ (seen / distance_km)
    apart = float(np.linalg.norm(np.cross(true, moon.true_direction)))
    if true @ moon.true_direction < 0.0 or apart > penumbra + moon.angular_radius_rad:
        return None
    x, y, z = refracted(true, eye_height_m).tolist()
    return EarthShadow(
        direction=(x, y, z), umbra_rad=umbra, penumbra_rad=penumbra, umbra_rgb=umbra_rgb(danjon)
    )


def umbra_rgb(danjon: float) -> Vector:
    """Share (3,) of sunlight in the middle of the umbra, for a number from 0 to 4."""
    numbers = np.arange(5.0)
    red, green, blue = (np.interp(danjon, numbers, c) for c in np.array(_COLOURS).T)
    share = 10.0 ** (-0.4 * np.interp(danjon, numbers, _DIMMED))
    return float(share * red), float(share * green), float(share * blue)


def light_left(moon: Moon, shadow: EarthShadow | None) -> FloatArray:
    """Share (3,) of the moon's light that is left: the mean over its disc."""
    if shadow is None:
        return np.ones(3)
    steps = (np.arange(_ACROSS) + 0.5) / _ACROSS * 2.0 - 1.0
    x, y = (part.ravel() for part in np.meshgrid(steps, steps))
    inside = x * x + y * y < 1.0
    right = np.cross(moon.direction, [0.0, 1.0, 0.0])
    right /= max(float(np.linalg.norm(right)), 1e-9)
    upper = np.cross(right, moon.direction)
    offset = x[inside, None] * right + y[inside, None] * upper
    place = moon.direction + moon.angular_radius_rad * offset
    return np.asarray(shadow_share(shadow, place).mean(axis=0))


def _vector(found: astronomy.Vector) -> FloatArray:
    return np.array([found.x, found.y, found.z]) * AU_KM
