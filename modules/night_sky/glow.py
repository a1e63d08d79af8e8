"""The glow of the moonless sky: Milky Way, zodiacal light, airglow and the lamps of towns.

Radiance in linear sRGB, W m^-2 sr^-1, on arrays of directions in world axes.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import astronomy
import numpy as np

from night_sky.data_files import night_data, table
from night_sky.lamp_sky import lamp_share
from night_sky.night_air import SENT_DOWN, NightAir
from night_sky.sky_axes import Watch, body_km, ecliptic_of_j2000, unit
from night_sky.stars import colour_of, planck_colour
from vrut_lite.atmosphere.planet import EARTH_RADIUS_M
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.haze import SetHaze
from vrut_lite.numeric_types import FloatArray

# Luminance (cd m^-2) of one star of V = 10 per square degree.
S10 = 8.65e-7
# Noll et al. (2012, A&A 543, A92): airglow by the sun's flux at 10.7 cm, at the zenith.
_AIRGLOW_S10, _AIRGLOW_AT_0, _AIRGLOW_PER_SFU = 200.0, 0.2, 0.00614
_AIRGLOW_M = 90_000.0
# Luminance of 1e-8 W m^-2 sr^-1 um^-1 at 500 nm, the unit of table 17.
_ZODIACAL_CD = 7.0e-7
# Stars too faint for points: a layer of 20 S10 across, seen slantwise to five times that, and the
# clouds of the Milky Way, of which the brightest level of the map has so much. With the points'
# 32 S10 the mean is 105 S10, as Leinert (1998) has it.
_LAYER_S10, _LEAST_SINE, _BRIGHTEST_S10 = 20.0, 0.2, 400.0
# Right ascension and declination of the galactic pole.
_GALACTIC_POLE_DEG = 192.85948, 27.12825
_MILKY_WAY_B_MINUS_V, _SUN_B_MINUS_V = 0.75, 0.65
# Magnitude per square arc second of a zenith without lamps; colour temperature of lamps.
NATURAL_MAGNITUDE, _LAMP_K = 22.0, 3000.0
_ZENITH_CD = 1.12e5


class GlowSources(NamedTuple):
    """Parameters of the glow: the sun's radio flux, and the zenith's magnitude by lamps."""

    solar_flux_sfu: float = 130.0
    zenith_magnitude: float = NATURAL_MAGNITUDE


def glow(direction: FloatArray, at: Watch, air: NightAir, sources: GlowSources) -> FloatArray:
    """Radiance (..., 3) of the sky behind the air, above the horizon; without points and moon."""
    flat = np.asarray(direction, dtype=float).reshape(-1, 3)
    above = outside(flat, at, sources)
    sine = np.maximum(flat[:, 1], 0.0)
    through = air.through(sine)
    lit = through * above + SENT_DOWN * (1.0 - through) * mean_outside(at, air, sources)
    lit += lamp_glow(sine, air, sources)
    return lit.reshape(direction.shape)


def outside(direction: FloatArray, at: Watch, sources: GlowSources) -> FloatArray:
    """Radiance (n, 3) above the air."""
    airglow = airglow_cd(np.maximum(direction[:, 1], 0.0), sources.solar_flux_sfu)
    j2000 = direction @ at.world
    stars = milky_way_cd(j2000)[:, None] * colour_of(np.array(_MILKY_WAY_B_MINUS_V))
    dust = zodiacal_cd(j2000, at)[:, None] * colour_of(np.array(_SUN_B_MINUS_V))
    # Its lines, green above all, make no white; what they lack in blue the continuum has not.
    return (airglow[:, None] * np.ones(3) + stars + dust) / LUMENS_PER_WATT


def mean_outside(at: Watch, air: NightAir, sources: GlowSources) -> FloatArray:
    """Radiance (3,) above the air in the mean over the sky, weighted by what the air lets in."""
    direction, weight = _sky_nodes()
    through = air.through(direction[:, 1]) * weight[:, None]
    light = (outside(direction, at, sources) * through).sum(axis=0)
    return np.asarray(light / through.sum(axis=0))


def airglow_cd(sine: FloatArray, solar_flux_sfu: float) -> FloatArray:
    """Luminance (n,) of the airglow's layer, by van Rhijn's path through it."""
    zenith = S10 * _AIRGLOW_S10 * (_AIRGLOW_AT_0 + _AIRGLOW_PER_SFU * solar_flux_sfu)
    ratio = EARTH_RADIUS_M / (EARTH_RADIUS_M + _AIRGLOW_M)
    return np.asarray(zenith / np.sqrt(1.0 - ratio**2 * (1.0 - sine**2)))


def milky_way_cd(j2000: FloatArray) -> FloatArray:
    """Luminance (n,) of the stars that are not drawn as points."""
    share = _milky_way()
    rows, columns = share.shape
    dec = np.arcsin(np.clip(j2000[:, 2], -1.0, 1.0))
    row = np.clip((0.5 - dec / np.pi) * rows - 0.5, 0.0, rows - 1.0)
    column = np.mod(np.arctan2(j2000[:, 1], j2000[:, 0]) / (2.0 * np.pi), 1.0) * columns - 0.5
    r, c = np.minimum(row.astype(int), rows - 2), np.floor(column).astype(int)
    v, u = row - r, column - c
    near, far = c % columns, (c + 1) % columns
    upper = share[r, near] * (1.0 - u) + share[r, far] * u
    lower = share[r + 1, near] * (1.0 - u) + share[r + 1, far] * u
    found = upper * (1.0 - v) + lower * v
    slant = np.maximum(np.abs(j2000 @ unit(*_GALACTIC_POLE_DEG)), _LEAST_SINE)
    return np.asarray(S10 * (_LAYER_S10 / slant + _BRIGHTEST_S10 * found))


def zodiacal_cd(j2000: FloatArray, at: Watch) -> FloatArray:
    """Luminance (n,) of sunlight on dust between the planets."""
    turn = ecliptic_of_j2000()
    sun = turn @ body_km(astronomy.Body.Sun, at)
    own = j2000 @ turn.T
    away = np.arctan2(own[:, 1], own[:, 0]) - np.arctan2(sun[1], sun[0])
    longitude = np.degrees(np.abs(np.mod(away + np.pi, 2.0 * np.pi) - np.pi))
    latitude = np.degrees(np.abs(np.arcsin(np.clip(own[:, 2], -1.0, 1.0))))
    return _ZODIACAL_CD * np.exp(_zodiacal()(np.stack([longitude, latitude], axis=-1)))


def lamp_glow(sine: FloatArray, air: NightAir, sources: GlowSources) -> FloatArray:
    """Radiance (n, 3) of air over ground that shines evenly, of the zenith asked for."""
    ground = lamps_from_above(air.haze, sources)
    return lamp_share(air.haze, sine) * ground if ground.any() else np.zeros(3)


def lamps_from_above(haze: SetHaze, sources: GlowSources) -> FloatArray:
    """Radiance (3,) of ground that shines evenly, under a zenith as bright as asked for."""
    extra = 10.0 ** (-0.4 * sources.zenith_magnitude) - 10.0 ** (-0.4 * NATURAL_MAGNITUDE)
    if extra <= 0.0:
        return np.zeros(3)
    colour = planck_colour(np.array(_LAMP_K))
    at_zenith = lamp_share(haze, np.ones(1))[0] * colour
    return np.asarray(_ZENITH_CD * extra / LUMENS_PER_WATT / float(luminance(at_zenith)) * colour)


@lru_cache(maxsize=1)
def _milky_way() -> FloatArray:
    """Its clouds by declination and right ascension, the brightest 1."""
    return np.asarray(night_data()["milky_way"] / 255.0)


@lru_cache(maxsize=1)
def _sky_nodes() -> tuple[FloatArray, FloatArray]:
    """Directions (n, 3) above the horizon and their shares of the solid angle (n,)."""
    sine = (np.arange(8) + 0.5) / 8.0
    azimuth = 2.0 * np.pi * np.arange(16) / 16.0
    height, turn = (part.ravel() for part in np.meshgrid(sine, azimuth))
    level = np.sqrt(1.0 - height**2)
    direction = np.stack([level * np.sin(turn), height, -level * np.cos(turn)], axis=-1)
    return direction, np.full(height.size, 1.0 / height.size)


@lru_cache(maxsize=1)
def _zodiacal() -> Callable[[FloatArray], FloatArray]:
    # Imported when used: whoever lists modules needs none of it.
    from scipy.interpolate import RegularGridInterpolator

    found = table("zodiacal_leinert1998.csv")
    values = found[1:, 1:].copy()
    # Near the sun, where nothing is tabulated, the nearest value of the row holds: twilight is
    # brighter there.
    for row in values:
        known = np.flatnonzero(np.isfinite(row))
        row[: known[0]] = row[known[0]]
    rows = RegularGridInterpolator((found[1:, 0], found[0, 1:]), np.log(values))
    return lambda places: np.asarray(rows(places))
