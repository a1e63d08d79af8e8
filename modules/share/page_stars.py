"""The brightest stars as a page needs them: fixed on the sky, above the air.

The module that draws stars posts them where an eye sees them, refracted and dimmed. Seen again in
other months, at other heights, the same stars tell how much the air dims them, and planets give
themselves away: they have moved.
"""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from vrut_lite.atmosphere.refraction import refraction_of_true_rad
from vrut_lite.numeric_types import FloatArray

# The sky turns so often a day, in the mean.
TURNS_A_DAY = 1.002_737_909_35
MOST = 2000
# Sightings below this elevation are left out: refraction is less certain there.
_LOWEST_RAD = math.radians(20.0)
# Distance (radians) within which two sightings are of one star; aberration moves it by 1e-4.
_SAME_RAD = 4e-4
_DAY_S = 86_400.0


class Sighting(NamedTuple):
    """Stars as seen from the place at an instant.

    `seconds` since 1970, `direction` (n, 3) apparent, world axes, `irradiance_rgb` (n, 3) behind
    the air, linear sRGB, W m^-2; brightest first.
    """

    seconds: float
    direction: FloatArray
    irradiance_rgb: FloatArray


class PageStars(NamedTuple):
    """Stars fixed on the sky.

    Attributes:
        direction: (N, 3) unit vectors whose third axis is the pole and whose longitude is that of
            the meridian at `seconds`: it grows eastwards.
        irradiance_rgb: (N, 3) above the air, linear sRGB, W m^-2, brightest first.
        seconds: since 1970, when longitude 0 is on the meridian.
        extinction: (3,) optical depth of the air towards the zenith.
    """

    direction: FloatArray
    irradiance_rgb: FloatArray
    seconds: float
    extinction: FloatArray


def air_mass(elevation_rad: FloatArray) -> FloatArray:
    """Relative optical air mass of apparent elevations (Kasten and Young 1989)."""
    degrees = np.degrees(elevation_rad)
    return np.asarray(1.0 / (np.sin(elevation_rad) + 0.50572 * (degrees + 6.07995) ** -1.6364))


def fixed_stars(
    sightings: Iterable[Sighting], latitude_rad: float, north_offset_rad: float, pressure_pa: float
) -> PageStars | None:
    """The stars of some nights; None where fewer than two sightings show any."""
    seen = [sighting for sighting in sightings if len(sighting.direction)]
    if len(seen) < 2:
        return None
    begins = seen[0].seconds
    found = [
        _on_sky(each, turn_rad(each.seconds - begins), latitude_rad, north_offset_rad, pressure_pa)
        for each in seen
    ]
    direction, light, mass = (np.concatenate(parts) for parts in zip(*found, strict=True))
    star, count = _same(direction)
    again = count[star] > 1
    # A planet has moved by then.
    direction, light, mass, star = direction[again], light[again], mass[again], star[again]
    _, star = np.unique(star, return_inverse=True)
    if not len(star):
        return None
    logs = np.log(light)
    less_log, less_mass = logs - _means(logs, star)[star], mass - _means(mass, star)[star]
    squares = float(np.sum(less_mass**2))
    extinction = -(less_mass[:, None] * less_log).sum(axis=0) / max(squares, 1e-12)
    above = np.exp(_means(logs + mass[:, None] * extinction, star))
    place = _means(direction, star)
    place /= np.linalg.norm(place, axis=1, keepdims=True)
    order = np.argsort(-above[:, 1], kind="stable")[:MOST]
    return PageStars(place[order], above[order], begins, np.maximum(extinction, 0.0))


def turn_rad(seconds: float) -> float:
    """The angle by which the sky turns in so many seconds."""
    return 2.0 * math.pi * TURNS_A_DAY * seconds / _DAY_S


def world_from_sky(turned: float, latitude_rad: float, north_offset_rad: float) -> FloatArray:
    """The matrix (3, 3) from the axes of `PageStars` to the world's, the sky `turned` (radians)
    since its instant: the twin of `page/src/stars.js`."""
    # The hour angle is `turned` less the longitude; see `sun_places.horizontal`.
    sine, cosine = math.sin(latitude_rad), math.cos(latitude_rad)
    east = np.array([-math.sin(turned), math.cos(turned), 0.0])
    meridian = np.array([math.cos(turned), math.sin(turned), 0.0])
    pole = np.array([0.0, 0.0, 1.0])
    north, up = cosine * pole - sine * meridian, sine * pole + cosine * meridian
    along, across = math.cos(north_offset_rad), math.sin(north_offset_rad)
    # World +X is east turned by the offset, -Z is north turned by it.
    return np.stack([along * east - across * north, up, -(along * north + across * east)])


def _on_sky(
    seen: Sighting,
    turned: float,
    latitude_rad: float,
    north_offset_rad: float,
    pressure_pa: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Directions, light and air mass of the brightest high stars of a sighting."""
    apparent = np.arcsin(np.clip(seen.direction[:, 1].astype(float), -1.0, 1.0))
    high = np.flatnonzero(apparent > _LOWEST_RAD)[: 2 * MOST]
    apparent, direction = apparent[high], seen.direction[high].astype(float)
    true = apparent.copy()
    for _ in range(3):
        true = apparent - refraction_of_true_rad(true, pressure_pa)
    level = np.cos(true) / np.maximum(np.cos(apparent), 1e-9)
    lowered = direction * [1.0, 0.0, 1.0] * level[:, None]
    lowered[:, 1] = np.sin(true)
    matrix = world_from_sky(turned, latitude_rad, north_offset_rad)
    return lowered @ matrix, seen.irradiance_rgb[high].astype(float), air_mass(apparent)


def _same(direction: FloatArray) -> tuple[np.ndarray, np.ndarray]:
    """Number of the star of each direction (n,), and how often each star was seen."""
    first = np.arange(len(direction))
    for one, other in cKDTree(direction).query_pairs(_SAME_RAD, output_type="ndarray"):
        first[other] = min(first[other], first[one])
    return first, np.bincount(first, minlength=len(direction))


def _means(values: FloatArray, star: np.ndarray) -> FloatArray:
    """Means (stars, ...) of values (n, ...) by star."""
    total = np.zeros((int(star.max()) + 1, *values.shape[1:]))
    np.add.at(total, star, values)
    count = np.bincount(star).reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray(total / count)
