"""The moon's disc as it is drawn: a sphere of maria and highlands, lit by sun and Earth."""

from functools import lru_cache

import numpy as np

from night_sky.moon import Moon
from night_sky.moon_light import earthshine_radiance_rgb, irradiance_rgb
from night_sky.night_air import NightAir
from night_sky.sky_axes import unit
from vrut_lite.array import Array
from vrut_lite.atmosphere.planet import MOON_RADIUS_KM
from vrut_lite.atmosphere.refraction import apparent_elevation, dip_rad
from vrut_lite.messages.night import THROUGH_PLACES, MoonDiscChanged
from vrut_lite.numeric_types import vector

# Selenographic longitude and latitude (deg) and diameter (km) of the maria (IAU gazetteer), and how
# much longer than wide along the longitude.
_MARIA = (
    (-57.4, 18.4, 2000.0, 0.75),  # Oceanus Procellarum
    (-15.6, 32.8, 1145.0, 1.0),  # Imbrium
    (17.5, 28.0, 707.0, 1.0),  # Serenitatis
    (31.4, 8.5, 873.0, 1.0),  # Tranquillitatis
    (59.1, 17.0, 556.0, 1.3),  # Crisium
    (51.3, -7.8, 840.0, 0.8),  # Fecunditatis
    (35.5, -15.2, 340.0, 1.0),  # Nectaris
    (-16.6, -21.3, 715.0, 1.0),  # Nubium
    (-38.6, -24.4, 420.0, 1.0),  # Humorum
    (-23.1, -10.0, 350.0, 1.0),  # Cognitum
    (-30.9, 7.5, 512.0, 1.0),  # Insularum
    (3.6, 13.3, 245.0, 1.0),  # Vaporum
    (1.4, 56.0, 1400.0, 3.5),  # Frigoris
    (86.1, 13.3, 420.0, 1.0),  # Marginis
    (87.5, -2.3, 373.0, 1.0),  # Smythii
    (-92.8, -19.4, 300.0, 1.0),  # Orientale
)
_MARE_ALBEDO = 0.53
_SOFT = 0.12
_ROWS, _COLUMNS = 90, 180
# Samples across the disc that its radiance is normalised by.
_ACROSS = 64


@lru_cache(maxsize=1)
def albedo_map() -> Array:
    """Albedo (rows, columns) relative to the highlands', from north, from longitude -180 deg."""
    latitude = 90.0 - (np.arange(_ROWS) + 0.5) * 180.0 / _ROWS
    longitude = (np.arange(_COLUMNS) + 0.5) * 360.0 / _COLUMNS - 180.0
    place = unit(*np.meshgrid(longitude, latitude))
    dark = np.zeros(place.shape[:2])
    for east, north, diameter_km, aspect in _MARIA:
        middle = unit(east, north)
        along = np.array([-middle[1], middle[0], 0.0]) / np.hypot(middle[0], middle[1])
        across = np.cross(middle, along)
        radius = 0.5 * diameter_km / MOON_RADIUS_KM / np.sqrt(aspect)
        reach = np.hypot(place @ along / aspect, place @ across) / radius
        near = place @ middle > 0.0
        dark = np.maximum(dark, near * np.clip((1.0 + _SOFT - reach) / (2.0 * _SOFT), 0.0, 1.0))
    return Array((1.0 - (1.0 - _MARE_ALBEDO) * dark).astype(np.float32))


def disc_of(moon: Moon, air: NightAir, source: str, eye_height_m: float = 0.0) -> MoonDiscChanged:
    """The disc behind the air before an eye; above it its light is the moon's irradiance."""
    lit = irradiance_rgb(moon.phase) / _lit_integral(moon)
    dark = earthshine_radiance_rgb(moon.phase)
    flattening = _flattening(moon, eye_height_m)
    across = flattening * moon.angular_radius_rad * np.linspace(-1.0, 1.0, THROUGH_PLACES)
    through = air.through(np.sin(np.arcsin(moon.direction[1]) + across))
    return MoonDiscChanged(
        direction=vector(moon.direction),
        angular_radius_rad=moon.angular_radius_rad,
        flattening=flattening,
        to_sun=vector(moon.to_sun),
        axes=tuple(float(value) for value in moon.axes.ravel()),
        lit_rgb=vector(np.maximum(lit, 0.0)),
        dark_rgb=vector(dark),
        albedo=albedo_map(),
        source=source,
        horizon_rad=-dip_rad(eye_height_m),
        through_rgb=tuple(map(float, through.ravel())),
    )


def _lit_integral(moon: Moon) -> float:
    """Integral over the disc's solid angle of albedo mu0 / (mu0 + mu), sr."""
    view = -moon.true_direction
    right = np.cross(view, [0.0, 1.0, 0.0] if abs(view[1]) < 0.9 else [1.0, 0.0, 0.0])
    right /= np.linalg.norm(right)
    steps = (np.arange(_ACROSS) + 0.5) / _ACROSS * 2.0 - 1.0
    x, y = np.meshgrid(steps, steps)
    inside = x * x + y * y < 1.0
    x, y = x[inside], y[inside]
    mu = np.sqrt(1.0 - x * x - y * y)
    normal = x[:, None] * right + y[:, None] * np.cross(view, right) + mu[:, None] * view
    mu0 = np.maximum(normal @ moon.to_sun, 0.0)
    own = normal @ moon.axes.T
    row = np.clip((0.5 - np.arcsin(np.clip(own[:, 2], -1, 1)) / np.pi) * _ROWS, 0, _ROWS - 1)
    column = (np.arctan2(own[:, 1], own[:, 0]) / (2.0 * np.pi) + 0.5) * _COLUMNS
    albedo = albedo_map().values[row.astype(int), column.astype(int) % _COLUMNS]
    mean = float(np.mean(albedo * mu0 / np.maximum(mu0 + mu, 1e-9)))
    # At new moon there is next to nothing to share.
    return max(mean, 1e-5) * np.pi * moon.angular_radius_rad**2


def _flattening(moon: Moon, eye_height_m: float) -> float:
    """Height over width of the refracted disc."""
    true = float(np.arcsin(np.clip(moon.true_direction[1], -1.0, 1.0)))
    edges = true + moon.angular_radius_rad * np.array([-1.0, 1.0])
    low, high = apparent_elevation(edges, eye_height_m)
    return float(np.clip((high - low) / (edges[1] - edges[0]), 0.1, 1.0))
