"""Compares a year of weather with the sun of its place, and its columns with each other.

The light's upper envelope by month and hour of the day hardly knows clouds. Where it fits the clear
sky of another time zone, longitude or latitude far better than that of the file's own, the file's
head or hours are wrong. Meinel's clear sky (1976) serves, with one scale for the year.
"""

from typing import NamedTuple

import numpy as np

from vrut_lite.atmosphere.planet import EARTH_RADIUS_M
from vrut_lite.messages.weather import SetWeather
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.suns import Suns, hour_edges_s, suns_at

_HOURS_A_MONTH = 730.5
_SHIFTS_H = 0.5 * np.arange(-23, 25)
# Largest rms difference of an envelope from the clear sky's, over its own rms, that needs no
# explanation (0.04 to 0.11 in files of TMY2, TMY3 and pvlib's clear sky; half an hour makes it 0.14
# to 0.17); the share of it that another reading of the file must leave to be said; and how much
# worse than the best the likelier reading may be.
_FITS, _MUCH_BETTER, _AS_GOOD = 0.12, 0.72, 1.05
# Global light is compared with its parts above this elevation; the share of such hours that may
# differ by more than 15 % and 50 W/m^2, for means of an hour have no one sun.
_CLOSURE_RAD, _MAY_DIFFER = float(np.radians(10.0)), 0.1
_DIFFERS_BY, _DIFFERS_W_M2 = 0.15, 50.0
# The sun rises six minutes apart over this distance at 50 degrees.
_FAR_M = 100_000.0
# Share of sunlit hours whose diffuse light may exceed the global by more than 5 % and 10 W/m^2.
_MAY_EXCEED = 0.01


class _Reading(NamedTuple):
    """Another reading of a file: its sentence, longitude and latitude factors, and a shift."""

    says: str
    longitude: float = 1.0
    latitude: float = 1.0
    shift_h: float = 0.0


def contradictions(weather: SetWeather, global_w_m2: FloatArray) -> tuple[str, ...]:
    """One sentence for each thing in a file that cannot be as it says.

    Args:
        weather: the year.
        global_w_m2: (hours,) on level ground, NaN where the file has none.
    """
    direct = np.array(weather.direct_normal_w_m2)
    diffuse = np.array(weather.diffuse_horizontal_w_m2)
    if not direct.any() and not diffuse.any():
        return ("no hour of the year has any light: the file's irradiances are all 0",)
    moved = _against_sun(weather, direct, diffuse)
    exceeded = _excess_diffuse(diffuse, global_w_m2)
    # Neither adds up: one fault, one sentence.
    sums = () if moved or exceeded else _unequal_sums(weather, direct, diffuse, global_w_m2)
    return (*moved, *exceeded, *sums)


def far_from(weather: SetWeather, latitude_deg: float, longitude_deg: float) -> tuple[str, ...]:
    """A sentence where a file is of another place than the one whose sun shines on it."""
    latitudes = np.radians([weather.latitude_deg, latitude_deg])
    apart = np.radians(longitude_deg - weather.longitude_deg)
    sines, cosines = np.sin(latitudes).prod(), np.cos(latitudes).prod()
    away_m = EARTH_RADIUS_M * float(np.arccos(np.clip(sines + cosines * np.cos(apart), -1.0, 1.0)))
    if away_m <= _FAR_M:
        return ()
    return (
        f"the weather is that of a place {away_m / 1000.0:,.0f} km away, at "
        f"{weather.latitude_deg:g},{weather.longitude_deg:g}: its light does not follow this sun",
    )


def _against_sun(weather: SetWeather, direct: FloatArray, diffuse: FloatArray) -> tuple[str, ...]:
    as_said = _suns(weather, _Reading(""))
    light = direct + diffuse
    error = _misfit(light, as_said)
    if error <= _FITS:
        return ()
    readings = _readings(weather)
    errors = np.array([_misfit(light, _suns(weather, one)) for one in readings])
    if errors.min() > _MUCH_BETTER * error:
        return ()
    best = readings[int(np.argmax(errors <= _AS_GOOD * errors.min()))]
    return (f"the light does not follow the sun of this place: it fits with {best.says}",)


def _readings(weather: SetWeather) -> list[_Reading]:
    """Faults that files have, the likelier first."""
    latitude, longitude = weather.latitude_deg, weather.longitude_deg
    zone = weather.utc_offset_h
    across = f"longitude {-longitude:g} ({'east' if longitude < 0 else 'west'})"
    along = f"latitude {-latitude:g} ({'north' if latitude < 0 else 'south'})"
    shifted = [
        _Reading(
            f"hours {abs(shift):g} h {'earlier' if shift < 0 else 'later'} "
            f"(time zone {zone - shift:g} instead of {zone:g})",
            shift_h=float(shift),
        )
        for shift in sorted(_SHIFTS_H, key=abs)
        if shift
    ]
    return [
        _Reading(f"{across} instead of {longitude:g}", longitude=-1.0),
        _Reading(f"{along} instead of {latitude:g}", latitude=-1.0),
        *shifted,
        _Reading(f"{along} and {across}, both of the other sign", longitude=-1.0, latitude=-1.0),
    ]


def _suns(weather: SetWeather, reading: _Reading) -> Suns:
    """The suns (hours,) of the middle of each hour."""
    edges_s = hour_edges_s(len(weather.direct_normal_w_m2), weather.utc_offset_h)
    middle = edges_s[:-1] + 3600.0 * (0.5 + reading.shift_h)
    return suns_at(
        middle, reading.latitude * weather.latitude_deg, reading.longitude * weather.longitude_deg
    )


def _misfit(light: FloatArray, suns: Suns) -> float:
    """Rms difference of the light's envelope from the clear sky's, over the envelope's rms."""
    measured, clear = _envelope(light), _envelope(_clear_light(suns))
    scale = float((measured * clear).sum() / max(float((clear * clear).sum()), 1e-9))
    rms = max(float(np.linalg.norm(measured)), 1e-9)
    return float(np.linalg.norm(measured - scale * clear)) / rms


def _envelope(light: FloatArray) -> FloatArray:
    """The most light (12, 24) of each month and hour of the day."""
    days = light.reshape(-1, 24)
    month = np.minimum(np.arange(len(days)) * 24 / _HOURS_A_MONTH, 11.9).astype(int)
    return np.stack([days[month == n].max(axis=0) for n in range(12)])


def _clear_light(suns: Suns) -> FloatArray:
    """Direct normal light (...,) of a clear sky, as a share of that above the air.

    Air mass by Rozenberg (1966).
    """
    sine = np.sin(np.maximum(suns.apparent_elevation_rad, 0.0))
    air_mass = 1.0 / (sine + 0.025 * np.exp(-11.0 * sine))
    return np.where(sine > 0.0, 0.7 ** (air_mass**0.678), 0.0)


def _excess_diffuse(diffuse: FloatArray, global_w_m2: FloatArray) -> tuple[str, ...]:
    lit = np.isfinite(global_w_m2) & (np.maximum(diffuse, global_w_m2) > 0.0)
    above = lit & (diffuse > 1.05 * global_w_m2 + 10.0)
    if above.sum() <= _MAY_EXCEED * max(lit.sum(), 1):
        return ()
    return (
        f"{above.sum():,} hours have more diffuse than global light on level ground, which cannot "
        "be: the diffuse column is used as it stands",
    )


def _unequal_sums(
    weather: SetWeather, direct: FloatArray, diffuse: FloatArray, global_w_m2: FloatArray
) -> tuple[str, ...]:
    elevation = _suns(weather, _Reading("")).apparent_elevation_rad
    high = (elevation > _CLOSURE_RAD) & np.isfinite(global_w_m2)
    summed = direct * np.sin(elevation) + diffuse
    apart = np.abs(summed - global_w_m2)
    differ = (
        high & (apart > _DIFFERS_W_M2) & (apart > _DIFFERS_BY * np.maximum(summed, global_w_m2))
    )
    if differ.sum() <= _MAY_DIFFER * max(high.sum(), 1):
        return ()
    ratio = float(summed[high].sum() / max(float(global_w_m2[high].sum()), 1e-9))
    return (
        f"{differ.sum():,} of {high.sum():,} hours have another global light than direct and "
        f"diffuse make together (over the year {100.0 * ratio:.0f} % of it): direct and diffuse "
        "are used as they stand",
    )
