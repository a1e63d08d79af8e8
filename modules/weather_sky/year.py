"""A whole year of weather on a plane: 8,760 irradiances, by the same sky as the pictures."""

import numpy as np

from vrut_lite.atmosphere.sky_distribution import Distribution
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.haze import DEFAULT_HAZE
from vrut_lite.messages.weather import SetWeather
from vrut_lite.numeric_types import FloatArray, Vector
from vrut_lite.sky.clear_sun import sun_irradiance_rgb
from vrut_lite.sky.suns import suns_of_year
from weather_sky.colour import TWILIGHT_K, clear_share, rgb_of_daylight, sky_rgb
from weather_sky.hemisphere import HemisphereNodes, horizontal, nodes
from weather_sky.perez import all_weather, precipitable_water_cm
from weather_sky.twilight import twilight_alone, twilight_lux

UP: Vector = (0.0, 0.0, 1.0)
# Edge of the grid of directions, and hours that are in memory at a time.
_NODES, _AT_A_TIME = 32, 512


def irradiance_of_year(weather: SetWeather, normal: Vector = UP) -> tuple[FloatArray, FloatArray]:
    """Irradiance (hours, 3) by the sun and (hours, 3) by the sky, on an open plane.

    Linear sRGB in W m^-2: times 683, its luminance is in lux. `normal` is a unit vector east,
    north, up; light from the ground is not in it.
    """
    suns = suns_of_year(weather)
    direct, diffuse = (
        np.array(values) for values in (weather.direct_normal_w_m2, weather.diffuse_horizontal_w_m2)
    )
    water = precipitable_water_cm(np.array(weather.dew_point_c))
    days = np.arange(direct.size) // 24 + 1
    zenith = 0.5 * np.pi - suns.apparent_elevation_rad
    state = all_weather(direct, np.maximum(diffuse, 1e-3), zenith, days)
    dark_hours = twilight_alone(suns.apparent_elevation_rad, direct, diffuse)
    lux = np.where(dark_hours, 0.0, direct * state.direct_efficacy(water))
    facing = np.maximum(suns.east_north_up @ np.array(normal), 0.0)
    sun = _tints(suns.apparent_elevation_rad) * (lux * facing / LUMENS_PER_WATT)[:, None]
    day = ~dark_hours
    at = nodes(_NODES)
    dark = twilight_lux(suns.apparent_elevation_rad) * (0.5 + 0.5 * normal[2])
    sky = (dark / LUMENS_PER_WATT)[:, None] * rgb_of_daylight(TWILIGHT_K)
    of_sky = diffuse * state.diffuse_efficacy(water)
    for some in np.array_split(np.flatnonzero(day), max(1, int(day.sum()) // _AT_A_TIME)):
        terms = (np.asarray(term)[some] for term in state.distribution()[:5])
        spread, suns_zenith = Distribution(*terms), state.zenith_rad[some]
        scale = of_sky[some] / horizontal(spread, suns_zenith, _NODES)
        columns = Distribution(*(np.asarray(term)[:, None] for term in spread[:5]))
        cosine = at.cos_gamma(suns_zenith)
        shown = scale[:, None] * columns.relative_luminance(at.cos_zenith, cosine)
        rgb = sky_rgb(shown, clear_share(state.clearness[some])[:, None])
        sky[some] = np.einsum("hnc,hn->hc", rgb, _weights(at, suns.azimuth_rad[some], normal))
    return sun, sky


def _weights(at: HemisphereNodes, azimuth_rad: FloatArray, normal: Vector) -> FloatArray:
    """Solid angle times cosine from a normal (hours, n), both sides of the sun's plane together."""
    solid = at.weight / (2.0 * at.cos_zenith)
    sine = np.sqrt(1.0 - at.cos_zenith**2)
    along, aside = sine * at.cos_azimuth, sine * np.sqrt(1.0 - at.cos_azimuth**2)
    east, north, up = normal
    towards = np.sin(azimuth_rad) * east + np.cos(azimuth_rad) * north
    beside = np.cos(azimuth_rad) * east - np.sin(azimuth_rad) * north
    level = towards[:, None] * along + up * at.cos_zenith
    return solid * sum(np.maximum(level + side * beside[:, None] * aside, 0.0) for side in (1, -1))


def _tints(elevation_rad: FloatArray) -> FloatArray:
    """The sun's colour (hours, 3) behind clear air, of luminance 1; by the degree."""
    degrees = np.arange(91.0)
    rgb = np.stack([sun_irradiance_rgb(DEFAULT_HAZE, np.radians(d)) for d in degrees])
    tint = np.maximum(rgb, 0.0) / luminance(np.maximum(rgb, 0.0))[:, None]
    at = np.degrees(elevation_rad)
    return np.stack([np.interp(at, degrees, channel) for channel in tint.T], axis=-1)
