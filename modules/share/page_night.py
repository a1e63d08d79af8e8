"""What turns with a page's night sky beside the stars: the Milky Way, and the planets' colours.

The module of the night posts a glow as the eye sees it, and planets among the stars. Glows of many
nights tell apart what stands over the horizon (airglow, lamps) from what turns with the stars.
"""

from collections.abc import Iterable
from datetime import UTC, datetime
from typing import NamedTuple

import astronomy
import numpy as np
from scipy.ndimage import uniform_filter1d

from share.page_stars import Sighting, air_mass, turn_rad, world_from_sky
from vrut_lite.numeric_types import FloatArray
from vrut_lite.sky.night_glow import map_directions

# The page's script computes their places.
PLANETS = ("Mercury", "Venus", "Mars", "Jupiter", "Saturn", "Uranus")
_ROUNDS = 40
# Share of the map that is darker than what counts as the Milky Way.
_DARK = 0.05
# Added to the sums of squared transmittance by which a texel's light is divided: what is seen
# near the horizon alone stays dark.
_RIDGE = 0.2
# Distance (radians) within which a point is the planet that is computed there; refraction is in it.
_NEAR_RAD = np.radians(0.1)
# Sine of the elevation below which refraction and air are less certain.
_LOWEST_SINE = 0.34
_J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)


class Glow(NamedTuple):
    """The glow (rows, columns, 3) at `seconds` since 1970, as `NightLightChanged.glow_rgb`."""

    seconds: float
    radiance_rgb: FloatArray


class PageGlow(NamedTuple):
    """Radiance of a dark sky: `standing`, plus what the air leaves of `turning`.

    Attributes:
        standing: (rows, columns, 3) over the horizon, as `NightLightChanged.glow_rgb`.
        turning: (rows, columns, 3) above the air; rows from the south pole, columns by the
            longitude of `page_stars.PageStars`, from 0 eastwards.
    """

    standing: FloatArray
    turning: FloatArray


def split_glow(
    glows: list[Glow],
    extinction: FloatArray,
    begins: float,
    latitude_rad: float,
    north_offset_rad: float,
) -> PageGlow:
    """Standing and turning light, by alternating least squares; `begins` is the stars' instant."""
    rows, columns = glows[0].radiance_rgb.shape[:2]
    world = map_directions(rows, columns).reshape(-1, 3)
    left = np.exp(-extinction * air_mass(np.arcsin(world[:, 1]))[:, None])
    nodes = []
    for glow in glows:
        matrix = world_from_sky(turn_rad(glow.seconds - begins), latitude_rad, north_offset_rad)
        nodes.append(_corners(world @ matrix, rows, columns))
    seen = [glow.radiance_rgb.reshape(-1, 3).astype(float) for glow in glows]
    turning = np.zeros((rows * columns, 3))
    for _ in range(_ROUNDS):
        standing = np.mean(
            [g - left * _at(turning, *n) for g, n in zip(seen, nodes, strict=True)], axis=0
        )
        over, under = np.zeros_like(turning), np.full_like(turning, _RIDGE)
        for values, (index, weight) in zip(seen, nodes, strict=True):
            # Each texel moves by the mean of what is missing around it.
            missing = left * (values - standing - left * _at(turning, index, weight))
            for corner in range(4):
                share = weight[:, corner, None]
                np.add.at(over, index[:, corner], share * missing)
                np.add.at(under, index[:, corner], share * left**2)
        turning = _smooth((turning + over / under).reshape(rows, columns, 3)).reshape(-1, 3)
        known = np.clip(under[:, 1:2] / (2.0 * _RIDGE) - 1.0, 0.0, 1.0)
        darkest = np.quantile(turning[known[:, 0] > 0.0], _DARK, axis=0)
        turning = known * np.maximum(turning - darkest, 0.0)
    # One colour, for that of places near the horizon is uncertain.
    colour = turning.sum(axis=0)
    turning = turning[:, 1:2] * colour / max(float(colour[1]), 1e-30)
    standing = np.mean(
        [g - left * _at(turning, *n) for g, n in zip(seen, nodes, strict=True)], axis=0
    )
    shape = rows, columns, 3
    return PageGlow(np.maximum(standing, 0.0).reshape(shape), turning.reshape(shape))


def planet_light(
    sightings: Iterable[Sighting],
    extinction: FloatArray,
    place: tuple[float, float, float],
    north_offset_rad: float,
) -> FloatArray | None:
    """Irradiance (planets, 3) above the air at magnitude 0, linear sRGB, W m^-2; None without any.

    `place` is latitude and longitude (degrees) and altitude (m). A planet that no sighting shows
    has the mean colour of the others.
    """
    observer = astronomy.Observer(*place)
    found: list[list[FloatArray]] = [[] for _ in PLANETS]
    for seen in sightings:
        time = astronomy.Time(
            (datetime.fromtimestamp(seen.seconds, UTC) - _J2000).total_seconds() / 86_400.0
        )
        for number, name in enumerate(PLANETS):
            body = astronomy.Body[name]
            where = astronomy.Equator(body, time, observer, True, True)
            level = astronomy.Horizon(
                time, observer, where.ra, where.dec, astronomy.Refraction.Normal
            )
            height, turn = np.radians([level.altitude, level.azimuth])
            turn -= north_offset_rad
            d = np.array(
                [np.cos(height) * np.sin(turn), np.sin(height), -np.cos(height) * np.cos(turn)]
            )
            apart = np.linalg.norm(seen.direction - d, axis=1)
            nearest = int(np.argmin(apart))
            if d[1] < _LOWEST_SINE or apart[nearest] > _NEAR_RAD:
                continue
            lost = np.exp(extinction * air_mass(np.array(height)))
            magnitude = astronomy.Illumination(body, time).mag
            found[number].append(seen.irradiance_rgb[nearest] * lost * 10.0 ** (0.4 * magnitude))
    known = [np.median(lights, axis=0) for lights in found if lights]
    if not known:
        return None
    mean = np.mean(known, axis=0)
    return np.array([np.median(lights, axis=0) if lights else mean for lights in found])


def _corners(sky: FloatArray, height: int, width: int) -> tuple[np.ndarray, FloatArray]:
    """Texels (n, 4) around directions (n, 3) fixed on the sky, and their weights."""
    row = (np.arcsin(np.clip(sky[:, 2], -1.0, 1.0)) / np.pi + 0.5) * height - 0.5
    column = np.mod(np.arctan2(sky[:, 1], sky[:, 0]) / (2.0 * np.pi), 1.0) * width - 0.5
    r, c = np.floor(row), np.floor(column)
    v, u = row - r, column - c
    rows = np.clip([r, r, r + 1, r + 1], 0, height - 1).astype(int)
    columns = np.mod([c, c + 1, c, c + 1], width).astype(int)
    weight = np.stack([(1 - v) * (1 - u), (1 - v) * u, v * (1 - u), v * u], axis=1)
    return (rows * width + columns).T, weight


def _smooth(texels: FloatArray) -> FloatArray:
    """Rows near the poles, whose texels are narrower than the glow's, over equal widths."""
    north = (np.arange(len(texels)) + 0.5) / len(texels) * np.pi
    widths = np.minimum(np.rint(1.0 / np.sin(north)), texels.shape[1]).astype(int)
    return np.stack(
        [
            uniform_filter1d(row, width, axis=0, mode="wrap")
            for row, width in zip(texels, widths, strict=True)
        ]
    )


def _at(texels: FloatArray, index: np.ndarray, weight: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("nk,nkc->nc", weight, texels[index]))
